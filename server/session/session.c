#include "server/session/session.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/session/session_internal.h"

#define SHUTTING_DOWN "the daemon is shutting down: connect to another or try later"

void session_refuse(struct session *session, uint32_t seq, sheen_ErrorCode code, const char *format,
                    ...)
{
    char text[sizeof((sheen_Error *)0)->text];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!session->admitted) {
        session_turn_away(session, text);
        return;
    }
    if (session->end == END_CLIENT)
        session->end = code == sheen_ErrorCode_ERROR_SHUTTING_DOWN ? END_DRAIN : END_PROTOCOL;
    struct reply *reply = session->refused ? NULL : session_expect_reply(session, seq);
    if (!session->refused && code != sheen_ErrorCode_ERROR_SHUTTING_DOWN)
        session_log_disconnect(session, text);
    session->refused = true;
    conn_hold(&session->conn, true);
    if (!reply)
        return;
    reply_mark_last(reply);
    session_reply_error(session, reply, code, text);
}

/* --- messages */

static void handle_hello(struct session *session, uint32_t seq, const uint8_t *body, size_t length)
{
    uint8_t model_id[MODEL_ID_BYTES]; /* for balancers only: the client may name any model later */
    sheen_Hello hello;
    char text[MESSAGE_TEXT_BYTES];
    if (!message_hello_decode(body, length, model_id, &hello)) {
        message_find_fault(MESSAGE_HELLO, body, length, text);
        session_refuse(session, seq, sheen_ErrorCode_ERROR_PROTOCOL, "HELLO: %s", text);
        return;
    }
    if (!message_check_hello(&hello, text)) {
        session_refuse(session, seq, sheen_ErrorCode_ERROR_PROTOCOL, "HELLO: %s", text);
        return;
    }
    if (!session->admitted && !session_admit(session, seq, &hello))
        return;
    const struct renderer_info *info = render_thread_info(session->host->render_thread);
    session->minor = hello.minor < PROTOCOL_MINOR ? hello.minor : PROTOCOL_MINOR;
    session->replies.is_ordered = session->minor == 0;
    session->credits = (uint32_t)session->host->limits.credits;
    sheen_HelloOk ok = {
        .minor = PROTOCOL_MINOR,
        .has_credits = true,
        .credits = session->credits,
        .software = info->software,
        .max_width_px = info->max_width_px,
        .max_height_px = info->max_height_px,
        .max_upload_bytes = session->host->max_upload_bytes,
    };
    snprintf(ok.server, sizeof ok.server, "%s", SHEEN_VERSION);
    snprintf(ok.device, sizeof ok.device, "%s", info->device);
    snprintf(ok.driver, sizeof ok.driver, "%s", info->driver);
    session->greeted = true;
    session_reply_now(session, seq, MESSAGE_HELLO_OK, &ok);
}

static void handle_body(struct session *session, const struct message_header *header,
                        const uint8_t *bytes)
{
    union {
        sheen_UploadBegin upload_begin;
        sheen_ModelQuery model_query;
        sheen_Render render;
        union compute_asked asked;
    } body;
    if (!message_decode(header->type, bytes, header->length, &body)) {
        char text[MESSAGE_TEXT_BYTES];
        message_find_fault(header->type, bytes, header->length, text);
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL, "%s: %s",
                       message_type_name(header->type), text);
        return;
    }
    if (session->host->draining) {
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_SHUTTING_DOWN, SHUTTING_DOWN);
        return;
    }
    if (header->type == MESSAGE_UPLOAD_BEGIN)
        session_upload_begin(session, header->seq, &body.upload_begin);
    else if (header->type == MESSAGE_MODEL_QUERY)
        session_query(session, header->seq, &body.model_query);
    else if (header->type == MESSAGE_RENDER)
        session_render(session, header->seq, &body.render);
    else
        session_compute(session, header->seq, header->type, &body.asked);
}

/* Reads further input only while there is room for another request and for its reply. */
static void update_hold(struct session *session)
{
    bool clogged = conn_unsent_bytes(&session->conn) > SESSION_MAX_UNSENT_BYTES;
    bool full = session->minor == 0 && session->replies.n >= PROTOCOL_MAX_IN_FLIGHT;
    struct schedule_flow *flow = session->requests.queue.flow;
    flow[CLASS_INTERACTIVE].held = session_is_sending(session);
    flow[CLASS_STILL].held = flow[CLASS_BATCH].held = clogged;
    conn_hold(&session->conn, clogged || full || session->refused);
}

static bool is_over_credit(const struct session *session, const struct message_header *header)
{
    bool asks = header->type != MESSAGE_HELLO && header->type != MESSAGE_CANCEL &&
                header->type != MESSAGE_UPLOAD_CHUNK;
    return asks && session->minor > 0 && session->replies.n >= session->credits;
}

static void on_message(void *owner, const struct message_header *header, const uint8_t *body)
{
    struct session *session = owner;
    const char *disorder = session_find_disorder(session, header);
    if (disorder) {
        session_refuse_disorder(session, header, disorder);
        return;
    }
    if (is_over_credit(session, header)) {
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL,
                       "%s: more requests unanswered than HELLO_OK's credits allow",
                       message_type_name(header->type));
        /* Requests of a client that floods are not served. */
        request_cancel_all(&session->requests);
        return;
    }
    switch (header->type) {
    case MESSAGE_HELLO:
        handle_hello(session, header->seq, body, header->length);
        break;
    case MESSAGE_UPLOAD_CHUNK:
        session_upload_chunk(session, header->seq, body, header->length);
        break;
    case MESSAGE_STATS_QUERY:
        session_reply_stats(session, header->seq);
        break;
    case MESSAGE_CANCEL:
        request_cancel(&session->requests, header->seq);
        break;
    case MESSAGE_UPLOAD_BEGIN:
    case MESSAGE_MODEL_QUERY:
    case MESSAGE_RENDER:
    case MESSAGE_FIND_BREAKS:
    case MESSAGE_COMPARE:
    case MESSAGE_TRACE_LINES:
        handle_body(session, header, body);
        break;
    default:
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL,
                       "%s is a message that only servers send", message_type_name(header->type));
    }
    update_hold(session);
}

static void on_malformed(void *owner, const struct message_header *header, enum header_error error)
{
    struct session *session = owner;
    if (error == HEADER_TOO_LONG)
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL,
                       "%s of %u bytes is longer than its type allows (%u)",
                       message_type_name(header->type), header->length,
                       message_max_length(header->type));
    else
        session_refuse(session, header->seq,
                       error == HEADER_BAD_MAJOR ? sheen_ErrorCode_ERROR_VERSION
                                                 : sheen_ErrorCode_ERROR_PROTOCOL,
                       "%s", header_error_text(error));
}

/* --- its life */

struct session *session_create(struct session_host *host, int fd,
                               const struct session_client *client, struct session_seat seat,
                               struct error *error)
{
    static const struct conn_handler handler = {on_message, on_malformed, session_make_room};
    struct session *session = calloc(1, sizeof *session);
    if (!session) {
        close(fd);
        session_leave_seat(&seat);
        error_set(error, ERROR_SERVER, "no memory for another session");
        return NULL;
    }
    if (!conn_init(&session->conn, host->loop, fd, &handler, session, &host->stats.sent_bytes,
                   error) ||
        (client->kind == CLIENT_TLS && !access_start_tls(host->access, &session->conn, error))) {
        conn_finish(&session->conn);
        session_leave_seat(&seat);
        free(session);
        return NULL;
    }
    session->host = host;
    session->conn.block_cache = host->block_cache;
    reply_list_init(&session->replies, host->block_cache);
    session->client = *client;
    session->requests = (struct request_client){
        .host = host->requests,
        .events = &session_request_events,
        .owner = session,
        .identity = session->client.identity.owner,
        .assets_of = host->share_models ? STORE_SHARED : session->client.identity.owner,
    };
    session->admitted = client->kind != CLIENT_TLS;
    if (session->admitted)
        session_sit_down(session, &seat);
    if (!session->admitted)
        session_be_stranger(session);
    session->output_class = CLASS_STILL;
    session->start_us = clock_now_us();
    host->n_sessions++;
    host->stats.sessions++;
    session->id = ++host->last_session_id;
    log_event(LOG_INFO, "session opened", log_number("session", session->id),
              log_text("peer", client->peer), log_text("identity", client->identity.name));
    return session;
}

void session_destroy(struct session *session)
{
    struct session_host *host = session->host;
    if (session->end == END_CLIENT && !session->admitted)
        session_turn_away(session,
                          *session->conn.reason ? session->conn.reason : "it left before HELLO");
    if (session->end == END_CLIENT && !session->conn.peer_ended)
        session->end = END_LOST;
    host->stats.ended[session->end]++;
    log_event(LOG_INFO, "session closed", log_number("session", session->id),
              log_text("reason", stats_end_name(session->end)),
              log_number("answers", session->n_replies),
              log_number("duration_us", clock_now_us() - session->start_us));
    request_client_finish(&session->requests);
    reply_list_finish(&session->replies);
    upload_destroy(session->upload);
    conn_finish(&session->conn);
    session_release_input(session);
    session_end_stranger(session, STRANGER_GONE);
    session_leave_seat(&session->seat);
    host->n_sessions--;
    free(session);
}

bool session_settle(struct session *session)
{
    struct conn *conn = &session->conn;
    if (conn->state == CONN_OPEN && !session_is_sending(session)) {
        request_send_held(&session->requests);
        reply_send_due(&session->replies, conn);
    }
    update_hold(session);
    bool is_done = session->replies.n == 0 && conn_unsent_bytes(conn) == 0 && !conn->intake.asks;
    if (conn->state == CONN_OPEN && is_done) {
        if (conn->peer_ended)
            conn_close_after_flush(conn);
        else if (session->host->draining)
            session_refuse(session, 0, sheen_ErrorCode_ERROR_SHUTTING_DOWN, SHUTTING_DOWN);
    }
    return conn->state != CONN_CLOSED;
}

void session_tick(struct session *session, uint64_t now_us)
{
    if (session->client.identity.expires_s)
        session_check_access(session, false);
    session_check_limits(session, now_us);
    if (session->conn.state != CONN_OPEN)
        return;
    if (now_us - session->conn.last_in_us > SESSION_TRIM_US)
        session_trim_input(session);
    if (session->host->overdue_ticks > 0)
        request_shut_down_all(&session->requests, session->host->limits.drain_s);
    request_end_late(&session->requests, now_us);
    request_report_progress(&session->requests);
}
