#include <stdio.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/session/session_internal.h"

static void after_fill(struct session *session, bool ok)
{
    if (ok)
        reply_send_due(&session->replies, &session->conn);
    else
        conn_close(&session->conn);
}

static void count_reply(struct session *session, const struct reply *reply, uint8_t type,
                        sheen_ErrorCode code)
{
    session->n_replies++;
    stats_reply(&session->host->stats, type, code, clock_now_us());
    if (type != MESSAGE_ERROR)
        log_event(LOG_DEBUG, "request answered", log_number("session", session->id),
                  log_number("request", reply_seq(reply)),
                  log_text("answer", message_type_name(type)));
}

void session_reply(struct session *session, struct reply *reply, uint8_t type, const void *body)
{
    count_reply(session, reply, type, sheen_ErrorCode_ERROR_NONE);
    after_fill(session, reply_fill(reply, type, body));
}

void session_reply_error(struct session *session, struct reply *reply, sheen_ErrorCode code,
                         const char *text)
{
    sheen_Error error = {.code = code};
    snprintf(error.text, sizeof error.text, "%s", text);
    message_make_text(error.text, false);
    count_reply(session, reply, MESSAGE_ERROR, code);
    log_event(LOG_INFO, "request refused", log_number("session", session->id),
              log_number("request", reply_seq(reply)), log_text("code", stats_error_name(code)),
              log_text("text", error.text));
    after_fill(session, reply_fill(reply, MESSAGE_ERROR, &error));
}

static void on_answered(void *owner, struct reply *reply, uint8_t type, const void *body)
{
    session_reply(owner, reply, type, body);
}

static void on_refused(void *owner, struct reply *reply, sheen_ErrorCode code, const char *text)
{
    session_reply_error(owner, reply, code, text);
}

static void on_drawn(void *owner, struct reply *reply, enum request_class request_class,
                     const sheen_Frame *frame, struct encoded *encoded)
{
    struct session *session = owner;
    stats_frame(&session->host->stats, request_class, &frame->times, clock_now_us());
    session->output_class = request_class;
    count_reply(session, reply, MESSAGE_FRAME, sheen_ErrorCode_ERROR_NONE);
    bool filled = reply_fill_frame(reply, frame, encoded);
    if (session_may_send(session))
        after_fill(session, filled);
}

static void on_computed(void *owner, struct reply *reply, uint8_t type, const void *body,
                        struct encoded *records)
{
    struct session *session = owner;
    if (records)
        session->output_class = CLASS_BATCH;
    count_reply(session, reply, type, sheen_ErrorCode_ERROR_NONE);
    bool filled = reply_fill_records(reply, type, body, records);
    if (session_may_send(session))
        after_fill(session, filled);
}

static void on_progressed(void *owner, const struct reply *reply, const sheen_Progress *progress)
{
    struct session *session = owner;
    uint8_t buffer[MESSAGE_HEADER_BYTES + PROTOCOL_MAX_LARGE_BODY_BYTES];
    size_t length;
    bool in_turn = reply == TAILQ_FIRST(&session->replies.replies) || !session->replies.is_ordered;
    if (!in_turn || conn_unsent_bytes(&session->conn) > 0 ||
        !message_encode(MESSAGE_PROGRESS, reply_seq(reply), progress, buffer, sizeof buffer,
                        &length))
        return;
    conn_send(&session->conn, buffer, length);
    conn_flush(&session->conn);
}

bool session_is_sending(const struct session *session)
{
    return session->replies.unsent > 0;
}

static bool on_is_sending(void *owner)
{
    return session_is_sending(owner);
}

const struct request_events session_request_events = {on_answered, on_refused,    on_drawn,
                                                      on_computed, on_progressed, on_is_sending};

static struct reply *or_close(struct session *session, struct reply *reply)
{
    if (!reply)
        conn_close(&session->conn);
    return reply;
}

struct reply *session_expect_reply(struct session *session, uint32_t seq)
{
    return or_close(session, reply_expect(&session->replies, seq));
}

struct reply *session_expect_frame(struct session *session, uint32_t seq,
                                   enum request_class request_class)
{
    return or_close(session, reply_expect_frame(&session->replies, seq, request_class));
}

void session_reply_now(struct session *session, uint32_t seq, uint8_t type, const void *body)
{
    struct reply *reply = session_expect_reply(session, seq);
    if (reply)
        session_reply(session, reply, type, body);
}

void session_reply_error_now(struct session *session, uint32_t seq, sheen_ErrorCode code,
                             const char *text)
{
    struct reply *reply = session_expect_reply(session, seq);
    if (reply)
        session_reply_error(session, reply, code, text);
}
