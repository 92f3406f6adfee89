/* Sends requests. */
#include "client/lib/scene_convert.h"
#include "client/lib/session.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"

_Static_assert((int)SHEEN_MAX_IN_FLIGHT == (int)PROTOCOL_MAX_CREDITS, "what a daemon may grant");

enum sheen_status session_too_old(struct sheen_error *error, const char *what)
{
    return status_set(error, SHEEN_BAD_ARGUMENT,
                      "the daemon is too old to %s: install sheen %s there", what, SHEEN_VERSION);
}

enum sheen_status sheen_send(struct sheen_session *session, const struct sheen_request *request,
                             struct sheen_error *error)
{
    char text[MESSAGE_TEXT_BYTES];
    struct sheen_request whole = SHEEN_REQUEST_DEFAULTS;
    enum sheen_status status = session_check(session, error);
    if (!status)
        status = sized_take(&whole, sizeof(whole), request, "request", error);
    if (status)
        return status;
    if (session->n_pending == session->hello.credits)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u request%s in flight: receive one",
                          session->hello.credits, session->hello.credits == 1 ? " is" : "s are");
    if (whole.n_lights < 1 || whole.n_lights > SHEEN_MAX_LIGHTS)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%u lights; there must be 1 to %d",
                          whole.n_lights, SHEEN_MAX_LIGHTS);
    struct session_pending *pending = &session->pending[session->n_pending];
    pending->n_retries = 0;
    pending->undecoded = whole.undecoded;
    scene_to_message(&pending->render, &whole);
    if (!message_check_render(&pending->render, session->hello.max_width_px,
                              session->hello.max_height_px, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    if (session->hello.minor < 2 &&
        (pending->render.has_jpeg_quality || pending->render.has_jpeg_subsampling))
        return session_too_old(error, "choose the quality of JPEG files");
    if (session->hello.minor < 4 && pending->render.aliased)
        return session_too_old(error, "draw frames without antialiasing");
    if (session->hello.minor < 5 && pending->render.has_window)
        return session_too_old(error, "draw a part of a picture");
    status = session_send(session, MESSAGE_RENDER, &pending->render, &pending->seq, error);
    session->last_sent = pending->seq;
    if (!status)
        session->n_pending++;
    return status;
}

uint32_t sheen_last_number(const struct sheen_session *session)
{
    return session ? session->last_sent : 0;
}

enum sheen_status sheen_cancel(struct sheen_session *session, uint32_t number,
                               struct sheen_error *error)
{
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (session_find_pending(session, number) == session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT, "no request %u is in flight", number);
    if (session->hello.minor < 1)
        return session_too_old(error, "take requests back");
    return session_send_raw(session, MESSAGE_CANCEL, number, NULL, 0, error);
}
