/* What requests of computed numbers have in common.
 * Thread: as the session. */
#ifndef SHEEN_CLIENT_COMPUTE_H
#define SHEEN_CLIENT_COMPUTE_H

#include "client/lib/session.h"

/* Checks the session, and makes the scene of such a request from the program's struct. SHEEN_BAD_ARGUMENT while
 * requests are in flight, and if the daemon is too old to do `what` ("find breaks"). */
enum sheen_status compute_scene(struct sheen_session *session, const struct sheen_request *request,
                                const char *what, sheen_Render *scene, struct sheen_error *error);

/* Sends the request, whose body is of type `type`, and waits for its answer, which is of type `answer_type` and goes
 * into *answer. *data_bytes is that member of the answer. *data gets the DATA, malloc'd; NULL if there is none. */
enum sheen_status compute_run(struct sheen_session *session, uint8_t type, const void *body,
                              uint8_t answer_type, void *answer, const uint64_t *data_bytes,
                              const struct sheen_progress *progress, uint8_t **data,
                              struct sheen_error *error);

#endif
