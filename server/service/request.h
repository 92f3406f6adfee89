/* A request that takes time: a model's description or a frame. It waits for what it needs from the
 * store, for its turn, for the GL thread and for the encoder, and then answers its session.
 *
 * A request owns itself: it ends after its answer, or, when its session has gone, as soon as no
 * other thread works for it. Thread: the loop's. */
#ifndef SHEEN_SERVICE_REQUEST_H
#define SHEEN_SERVICE_REQUEST_H

#include "server/service/session.h"

struct request;

/* Both fill `answer` in the end, unless the session goes; they may have ended when they return. */
void request_query(struct session *session, struct answer *answer, uint32_t seq,
                   const sheen_ModelQuery *query);
/* `render` has passed message_check_render(). */
void request_render(struct session *session, struct answer *answer, uint32_t seq,
                    const sheen_Render *render);

/* Starts what the scheduler says is next, until it says nothing. */
void request_start_next(struct session_host *host);

/* The session goes away: takes its queue out of the scheduler and lets go of all its requests. */
void request_abandon_all(struct session *session);

/* Sends PROGRESS if the next answer that is due waits for a build. */
void request_report_progress(struct session *session);

#endif
