#include <stdio.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/session/session_internal.h"

static void after_fill(struct session *session, bool ok)
{
    if (ok)
        answer_send_due(&session->answers, &session->conn);
    else
        conn_close(&session->conn);
}

static void count_answer(struct session *session, const struct answer *answer, uint8_t type,
                         sheen_ErrorCode code)
{
    session->n_answers++;
    stats_answer(&session->host->stats, type, code, clock_now_us());
    if (type != MESSAGE_ERROR)
        log_event(LOG_DEBUG, "request answered", log_number("session", session->id),
                  log_number("request", answer_seq(answer)),
                  log_text("answer", message_type_name(type)));
}

void session_answer(struct session *session, struct answer *answer, uint8_t type, const void *body)
{
    count_answer(session, answer, type, sheen_ErrorCode_ERROR_NONE);
    after_fill(session, answer_fill(answer, type, body));
}

void session_answer_error(struct session *session, struct answer *answer, sheen_ErrorCode code,
                          const char *text)
{
    sheen_Error error = {.code = code};
    snprintf(error.text, sizeof error.text, "%s", text);
    message_make_text(error.text, false);
    count_answer(session, answer, MESSAGE_ERROR, code);
    log_event(LOG_INFO, "request refused", log_number("session", session->id),
              log_number("request", answer_seq(answer)), log_text("code", stats_error_name(code)),
              log_text("text", error.text));
    after_fill(session, answer_fill(answer, MESSAGE_ERROR, &error));
}

void session_answer_frame(struct session *session, struct answer *answer,
                          enum request_class request_class, const sheen_Frame *frame,
                          struct encoded *encoded)
{
    session->output_class = request_class;
    count_answer(session, answer, MESSAGE_FRAME, sheen_ErrorCode_ERROR_NONE);
    bool filled = answer_fill_frame(answer, frame, encoded);
    if (session_may_send(session))
        after_fill(session, filled);
}

void session_report_progress(struct session *session, const struct answer *answer, uint32_t seq,
                             const sheen_Progress *progress)
{
    uint8_t buffer[MESSAGE_HEADER_BYTES + PROTOCOL_MAX_LARGE_BODY_BYTES];
    size_t length;
    bool in_turn = answer == session->answers.head || !session->answers.is_ordered;
    if (!in_turn || conn_unsent_bytes(&session->conn) > 0 ||
        !message_encode(MESSAGE_PROGRESS, seq, progress, buffer, sizeof buffer, &length))
        return;
    conn_send(&session->conn, buffer, length);
    conn_flush(&session->conn);
}

struct answer *session_expect_answer(struct session *session, uint32_t seq,
                                     enum request_class request_class)
{
    struct answer *answer = answer_expect(&session->answers, seq, request_class);
    if (!answer)
        conn_close(&session->conn);
    return answer;
}

void session_reply(struct session *session, uint32_t seq, uint8_t type, const void *body)
{
    struct answer *answer = session_expect_answer(session, seq, CLASS_STILL);
    if (answer)
        session_answer(session, answer, type, body);
}

void session_reply_error(struct session *session, uint32_t seq, sheen_ErrorCode code,
                         const char *text)
{
    struct answer *answer = session_expect_answer(session, seq, CLASS_STILL);
    if (answer)
        session_answer_error(session, answer, code, text);
}
