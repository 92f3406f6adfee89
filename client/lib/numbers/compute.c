#include "client/lib/numbers/compute.h"

#include <stdlib.h>

#include "client/lib/data.h"
#include "client/lib/scene_convert.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"

enum { MINOR_OF_COMPUTATIONS = 5 };

enum sheen_status compute_scene(struct sheen_session *session, const struct sheen_request *request,
                                const char *what, sheen_Render *scene, struct sheen_error *error)
{
    struct sheen_request whole = SHEEN_REQUEST_DEFAULTS;
    enum sheen_status status = session_check(session, error);
    if (!status)
        status = sized_take(&whole, sizeof(whole), request, "request", error);
    if (status)
        return status;
    if (session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT, "to %s needs that no request is in flight",
                          what);
    if (whole.n_lights < 1 || whole.n_lights > SHEEN_MAX_LIGHTS)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u lights; there must be 1 to %d",
                          whole.n_lights, SHEEN_MAX_LIGHTS);
    if (session->hello.minor < MINOR_OF_COMPUTATIONS)
        return session_too_old(error, what);
    scene_to_message(scene, &whole);
    return SHEEN_OK;
}

enum sheen_status compute_run(struct sheen_session *session, uint8_t type, const void *body,
                              uint8_t answer_type, void *answer, const uint64_t *data_bytes,
                              const struct sheen_progress *progress, uint8_t **data,
                              struct sheen_error *error)
{
    struct session_data received = {NULL, 0, 0};
    uint32_t seq;
    *data = NULL;
    enum sheen_status status = session_send(session, type, body, &seq, error);
    if (!status)
        status = session_receive(session, seq, answer_type, progress, answer, error);
    if (!status)
        status = data_read(session, seq, (size_t)*data_bytes, &received, error);
    if (status)
        free(received.bytes);
    else
        *data = received.bytes;
    return status;
}
