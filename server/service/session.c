#include "server/service/session_inside.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "server/service/log.h"
#include "server/service/request.h"
#include "server/service/wire.h"

#define SHUTTING_DOWN "the daemon is shutting down: connect to another or try later"

/* --- answers */

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
    stats_answer(&session->host->stats, type, code, loop_now_us());
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
    wire_make_text(error.text, false);
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

/* NULL without memory; the connection is closed then. */
static struct answer *expect_answer(struct session *session, uint32_t seq,
                                    enum request_class request_class)
{
    struct answer *answer = answer_expect(&session->answers, seq, request_class);
    if (!answer)
        conn_close(&session->conn);
    return answer;
}

/* Answers at once what takes no time. */
static void reply(struct session *session, uint32_t seq, uint8_t type, const void *body)
{
    struct answer *answer = expect_answer(session, seq, CLASS_STILL);
    if (answer)
        session_answer(session, answer, type, body);
}

static void reply_error(struct session *session, uint32_t seq, sheen_ErrorCode code,
                        const char *text)
{
    struct answer *answer = expect_answer(session, seq, CLASS_STILL);
    if (answer)
        session_answer_error(session, answer, code, text);
}

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
    struct answer *answer = session->refused ? NULL : expect_answer(session, seq, CLASS_STILL);
    if (!session->refused && code != sheen_ErrorCode_ERROR_SHUTTING_DOWN)
        session_log_disconnect(session, text);
    session->refused = true;
    conn_hold(&session->conn, true);
    if (!answer)
        return;
    answer_mark_last(answer);
    session_answer_error(session, answer, code, text);
}

/* --- messages */

static void handle_hello(struct session *session, uint32_t seq, const uint8_t *body, size_t length)
{
    uint8_t model_id[MODEL_ID_BYTES]; /* for balancers; here any model may be named later */
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
    if (!session->admitted && !session_admit(session, &hello))
        return;
    const struct renderer_info *info = render_thread_info(session->host->render_thread);
    session->minor = hello.minor < PROTOCOL_MINOR ? hello.minor : PROTOCOL_MINOR;
    session->answers.is_ordered = session->minor == 0;
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
    reply(session, seq, MESSAGE_HELLO_OK, &ok);
}

static void reply_upload_state(struct session *session, uint32_t seq, bool complete,
                               uint64_t received_bytes)
{
    const sheen_UploadState state = {.complete = complete, .received_bytes = received_bytes};
    reply(session, seq, MESSAGE_UPLOAD_STATE, &state);
}

static void handle_upload_begin(struct session *session, uint32_t seq,
                                const sheen_UploadBegin *begin)
{
    struct session_host *host = session->host;
    char text[MESSAGE_TEXT_BYTES];
    struct error error = {0};
    session->upload_seq = seq;
    if (begin->size_bytes > host->max_upload_bytes) {
        snprintf(text, sizeof text, "a file of %llu bytes; this daemon takes at most %llu",
                 (unsigned long long)begin->size_bytes, (unsigned long long)host->max_upload_bytes);
        reply_error(session, seq, sheen_ErrorCode_ERROR_TOO_BIG, text);
        return;
    }
    if (!message_check_upload_begin(begin, text)) {
        reply_error(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    enum asset_kind kind = begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ASSET_MODEL : ASSET_IMAGE;
    struct asset *known = store_find(host->store, session_owner(session), kind, begin->sha256);
    if (known) {
        if (begin->share)
            store_share(known);
        session->upload_seq = 0; /* no chunk may follow */
        reply_upload_state(session, seq, true, begin->size_bytes);
        return;
    }
    if (kind == ASSET_IMAGE)
        workers_expect_images(&host->workers);
    session->upload =
        upload_create(&host->memory, session->peer, session_owner(session), begin, &error);
    if (session->upload)
        reply_upload_state(session, seq, false, 0);
    else
        reply_error(session, seq, wire_error_code(error.kind), error.text);
}

static void handle_upload_chunk(struct session *session, uint32_t seq, const uint8_t *body,
                                size_t length)
{
    if (seq != session->upload_seq || length == 0) {
        session_refuse(session, seq, sheen_ErrorCode_ERROR_PROTOCOL, "UPLOAD_CHUNK %s",
                       length == 0 ? "without a byte" : "of no upload under way");
        return;
    }
    if (!session->upload)
        return; /* sent before the client read that the upload has failed */
    struct error error = {0};
    enum upload_state state = upload_add(session->upload, body, length, &error);
    session->host->stats.upload_bytes += length;
    if (state == UPLOAD_MORE)
        return;
    uint64_t received = upload_received_bytes(session->upload);
    upload_destroy(session->upload);
    session->upload = NULL;
    if (state == UPLOAD_STORED) {
        session->upload_seq = 0;
        reply_upload_state(session, seq, true, received);
    } else if (state == UPLOAD_TOO_MUCH) {
        session_refuse(session, seq, sheen_ErrorCode_ERROR_PROTOCOL, "%s", error.text);
    } else {
        reply_error(session, seq, wire_error_code(error.kind), error.text);
    }
}

/* What a frame takes at most: its planes, and what they are encoded to. */
static uint64_t frame_bytes(const sheen_Render *render)
{
    struct codec_layout all, sent;
    codec_layout_init(&all, render->width_px, render->height_px, message_render_planes(render));
    codec_layout_init(&sent, render->width_px, render->height_px, render->planes);
    return all.raw_bytes + (render->encoding == sheen_Encoding_ENCODING_RAW ? 0 : sent.raw_bytes);
}

/* Answers and returns false when the frame could never be made here. */
static bool frame_fits(struct session *session, uint32_t seq, const sheen_Render *render)
{
    const struct limits *limits = &session->host->limits;
    struct codec_layout all;
    codec_layout_init(&all, render->width_px, render->height_px, message_render_planes(render));
    uint64_t bytes = frame_bytes(render);
    const struct {
        const char *what, *name;
        uint64_t needed, limit;
    } checks[] = {
        {"planes", "max-frame", all.raw_bytes, limits->max_frame},
        {"planes and their encoding", "memory-budget", bytes, limits->memory_budget},
        {"planes and their encoding", "peer-memory", bytes, limits->peer_memory},
    };
    for (size_t i = 0; i < sizeof checks / sizeof *checks; i++) {
        char text[MESSAGE_TEXT_BYTES];
        if (checks[i].needed <= checks[i].limit)
            continue;
        snprintf(text, sizeof text,
                 "%ux%u px: %s take %llu bytes, over this daemon's --%s of %llu: ask for a smaller "
                 "frame or fewer planes",
                 render->width_px, render->height_px, checks[i].what,
                 (unsigned long long)checks[i].needed, checks[i].name,
                 (unsigned long long)checks[i].limit);
        reply_error(session, seq, sheen_ErrorCode_ERROR_TOO_BIG, text);
        return false;
    }
    return true;
}

/* What a client of this minor version cannot have meant. */
static void drop_newer_fields(const struct session *session, sheen_Render *render)
{
    if (session->minor > 0)
        return;
    render->has_view = render->has_deadline_ms = false;
    render->request_class = sheen_RequestClass_CLASS_STILL;
}

static void handle_render(struct session *session, uint32_t seq, sheen_Render *render)
{
    char text[MESSAGE_TEXT_BYTES];
    const struct renderer_info *info = render_thread_info(session->host->render_thread);
    drop_newer_fields(session, render);
    if (!message_check_render(render, info->max_width_px, info->max_height_px, text)) {
        reply_error(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    if (!frame_fits(session, seq, render))
        return;
    struct answer *answer = expect_answer(session, seq, wire_request_class(render->request_class));
    if (answer)
        request_render(session, answer, seq, render, frame_bytes(render));
}

static void handle_query(struct session *session, uint32_t seq, const sheen_ModelQuery *query)
{
    char text[MESSAGE_TEXT_BYTES];
    if (!message_check_model_query(query, text)) {
        reply_error(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    struct answer *answer = expect_answer(session, seq, CLASS_STILL);
    if (answer)
        request_query(session, answer, seq, query);
}

/* The last minute: rates, and percentiles of each stage and of each class. */
static void add_recent(sheen_Stats *body, const struct stats *stats)
{
    struct stats_recent recent;
    stats_recent(stats, loop_now_us(), &recent);
    body->has_window_us = body->has_window_requests = body->has_window_frames = true;
    body->window_us = recent.window_us;
    body->window_requests = recent.requests;
    body->window_frames = recent.frames;
    body->has_p50 = body->has_p95 = body->has_p99 = true;
    body->p50 = recent.p50;
    body->p95 = recent.p95;
    body->p99 = recent.p99;
    body->has_window_sent_bytes = true;
    body->window_sent_bytes = recent.sent_bytes;
    body->has_interactive = body->has_still = body->has_batch = true;
    body->interactive = recent.latency[CLASS_INTERACTIVE];
    body->still = recent.latency[CLASS_STILL];
    body->batch = recent.latency[CLASS_BATCH];
}

static void reply_stats(struct session *session, uint32_t seq)
{
    const struct session_host *host = session->host;
    const struct renderer_info *info = render_thread_info(host->render_thread);
    struct store_counts counts = store_count(host->store);
    sheen_Stats stats = {
        .uptime_us = loop_now_us() - host->stats.start_us,
        .sessions = host->n_sessions,
        .frames = host->stats.frames,
        .errors = host->stats.errors,
        .models = counts.models,
        .model_bytes = counts.model_bytes,
        .images = counts.images,
        .uploads_bytes = host->stats.upload_bytes,
        .sent_bytes = host->stats.sent_bytes,
        .software = info->software,
        .mean = stats_mean(&host->stats),
        .queued = host->scheduler.waiting,
        .has_superseded = true,
        .superseded = host->stats.superseded,
        .has_cancelled = true,
        .cancelled = host->stats.cancelled,
        .has_late = true,
        .late = host->stats.late,
        .has_disconnected = true,
        .disconnected = host->stats.disconnected,
        .has_interactive_us = true,
        .interactive_us = host->scheduler.classes[CLASS_INTERACTIVE].spent_us,
        .has_still_us = true,
        .still_us = host->scheduler.classes[CLASS_STILL].spent_us,
        .has_batch_us = true,
        .batch_us = host->scheduler.classes[CLASS_BATCH].spent_us,
        .has_memory_bytes = true,
        .memory_bytes = store_used_bytes(host->store),
    };
    add_recent(&stats, &host->stats);
    snprintf(stats.device, sizeof stats.device, "%s", info->device);
    snprintf(stats.driver, sizeof stats.driver, "%s", info->driver);
    snprintf(stats.server, sizeof stats.server, "%s", SHEEN_VERSION);
    reply(session, seq, MESSAGE_STATS, &stats);
}

static void handle_body(struct session *session, const struct message_header *header,
                        const uint8_t *bytes)
{
    union {
        sheen_UploadBegin upload_begin;
        sheen_ModelQuery model_query;
        sheen_Render render;
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
        handle_upload_begin(session, header->seq, &body.upload_begin);
    else if (header->type == MESSAGE_MODEL_QUERY)
        handle_query(session, header->seq, &body.model_query);
    else
        handle_render(session, header->seq, &body.render);
}

/* Reads on only while there is room for another request and for its answer. */
static void update_hold(struct session *session)
{
    bool clogged = conn_unsent_bytes(&session->conn) > SESSION_MAX_UNSENT_BYTES;
    bool full = session->minor == 0 && session->answers.n >= PROTOCOL_MAX_IN_FLIGHT;
    struct schedule_flow *flow = session->queue.flow;
    flow[CLASS_INTERACTIVE].held = session_is_sending_interactive(session);
    flow[CLASS_STILL].held = flow[CLASS_BATCH].held = clogged;
    conn_hold(&session->conn, clogged || full || session->refused);
}

/* NULL, or what is wrong with a message of this type now. */
static const char *out_of_order(const struct session *session, const struct message_header *header)
{
    if (header->seq == 0)
        return "its number is 0, which is no request's";
    if (!session->greeted)
        return header->type == MESSAGE_HELLO ? NULL : "the first message must be HELLO";
    if (header->type == MESSAGE_HELLO)
        return "a second HELLO";
    if (header->type == MESSAGE_CANCEL)
        return session->minor > 0 ? NULL : "a message of minor version 1";
    if (session->upload && header->type != MESSAGE_UPLOAD_CHUNK)
        return "an upload is under way and not complete";
    return NULL;
}

static bool is_over_credit(const struct session *session, const struct message_header *header)
{
    bool asks = header->type != MESSAGE_HELLO && header->type != MESSAGE_CANCEL &&
                header->type != MESSAGE_UPLOAD_CHUNK;
    return asks && session->minor > 0 && session->answers.n >= session->credits;
}

static void on_message(void *owner, const struct message_header *header, const uint8_t *body)
{
    struct session *session = owner;
    const char *wrong = out_of_order(session, header);
    if (wrong) {
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL, "%s: %s",
                       message_type_name(header->type), wrong);
        return;
    }
    if (is_over_credit(session, header)) {
        session_refuse(session, header->seq, sheen_ErrorCode_ERROR_PROTOCOL,
                       "%s: more requests unanswered than HELLO_OK's credits allow",
                       message_type_name(header->type));
        request_cancel_all(session); /* who floods is not served first */
        return;
    }
    switch (header->type) {
    case MESSAGE_HELLO:
        handle_hello(session, header->seq, body, header->length);
        break;
    case MESSAGE_UPLOAD_CHUNK:
        handle_upload_chunk(session, header->seq, body, header->length);
        break;
    case MESSAGE_STATS_QUERY:
        reply_stats(session, header->seq);
        break;
    case MESSAGE_CANCEL:
        request_cancel(session, header->seq);
        break;
    case MESSAGE_UPLOAD_BEGIN:
    case MESSAGE_MODEL_QUERY:
    case MESSAGE_RENDER:
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
                               const struct session_client *client, struct peer *peer,
                               struct error *error)
{
    static const struct conn_handler handler = {on_message, on_malformed};
    struct session *session = calloc(1, sizeof *session);
    if (!session) {
        close(fd);
        peer_put(&host->memory.peers, peer);
        error_set(error, ERROR_SERVER, "no memory for another session");
        return NULL;
    }
    if (!conn_init(&session->conn, host->loop, fd, &handler, session, &host->stats.sent_bytes,
                   error) ||
        (client->kind == CLIENT_TLS && !access_start_tls(host->access, &session->conn, error))) {
        conn_finish(&session->conn);
        peer_put(&host->memory.peers, peer);
        free(session);
        return NULL;
    }
    session->host = host;
    session->conn.spares = session->answers.spares = host->spares;
    session->peer = peer;
    session->client = *client;
    session->admitted = client->kind != CLIENT_TLS;
    host->n_strangers += !session->admitted;
    session->output_class = CLASS_STILL;
    session->start_us = loop_now_us();
    scheduler_add_queue(&session->queue);
    peer->n_connections++;
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
              log_number("answers", session->n_answers),
              log_number("duration_us", loop_now_us() - session->start_us));
    request_abandon_all(session);
    answer_list_finish(&session->answers);
    upload_destroy(session->upload);
    conn_finish(&session->conn);
    host->n_strangers -= !session->admitted;
    session->peer->n_connections--;
    peer_put(&host->memory.peers, session->peer);
    host->n_sessions--;
    free(session);
}

bool session_settle(struct session *session)
{
    struct conn *conn = &session->conn;
    if (conn->state == CONN_OPEN && !session_is_sending_interactive(session)) {
        request_send_held(session);
        answer_send_due(&session->answers, conn);
    }
    update_hold(session);
    if (conn->state == CONN_OPEN && !conn->held)
        conn_deliver(conn);
    if (conn->state == CONN_OPEN && session->answers.n == 0 && conn_unsent_bytes(conn) == 0) {
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
        conn_trim(&session->conn);
    request_end_late(session, now_us);
    request_report_progress(session);
}
