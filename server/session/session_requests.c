#include <stdio.h>

#include "server/session/session_internal.h"
#include "server/frame/error_code.h"

static void reply_upload_state(struct session *session, uint32_t seq, bool complete,
                               uint64_t received_bytes)
{
    const sheen_UploadState state = {.complete = complete, .received_bytes = received_bytes};
    session_reply_now(session, seq, MESSAGE_UPLOAD_STATE, &state);
}

void session_upload_begin(struct session *session, uint32_t seq, const sheen_UploadBegin *begin)
{
    struct session_host *host = session->host;
    char text[MESSAGE_TEXT_BYTES];
    struct error error = {0};
    session->upload_seq = seq;
    if (begin->size_bytes > host->max_upload_bytes) {
        snprintf(text, sizeof text, "a file of %llu bytes; this daemon takes at most %llu",
                 (unsigned long long)begin->size_bytes, (unsigned long long)host->max_upload_bytes);
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_TOO_BIG, text);
        return;
    }
    if (!message_check_upload_begin(begin, text)) {
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    enum asset_kind kind = begin->kind == sheen_UploadKind_UPLOAD_MODEL ? ASSET_MODEL : ASSET_IMAGE;
    struct asset *known = store_find(host->store, session->requests.assets_of,
                                     session->client.identity.owner, kind, begin->sha256);
    if (known && store_is_known_as(known, begin->name)) {
        if (begin->share)
            store_share(known);
        session->upload_seq = 0; /* no more chunks are allowed */
        reply_upload_state(session, seq, true, begin->size_bytes);
        return;
    }
    if (kind == ASSET_IMAGE)
        workers_expect_images(host->workers);
    session->upload =
        upload_create(host->memory, session->requests.quota, session->requests.assets_of,
                      session->client.identity.owner, begin, &error);
    if (session->upload)
        reply_upload_state(session, seq, false, 0);
    else
        session_reply_error_now(session, seq, error_code_of(error.kind), error.text);
}

void session_upload_chunk(struct session *session, uint32_t seq, const uint8_t *body, size_t length)
{
    if (length == 0) {
        session_refuse(session, seq, sheen_ErrorCode_ERROR_PROTOCOL,
                       "UPLOAD_CHUNK: it comes without a byte");
        return;
    }
    if (!session->upload)
        return; /* the client sent it before it read that the upload failed */
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
        session_reply_error_now(session, seq, error_code_of(error.kind), error.text);
    }
}

/* An upper bound of a frame's memory in bytes: planes, encoded bytes, and what drawing polygons
 * keeps. */
static uint64_t frame_bytes(const struct session *session, const sheen_Render *render)
{
    struct codec_layout all, sent;
    codec_layout_init(&all, render->width_px, render->height_px, message_render_planes(render));
    codec_layout_init(&sent, render->width_px, render->height_px, render->planes);
    const struct encode_format format = encode_format_of(render);
    return all.raw_bytes + encode_bytes(&sent, &format) +
           request_paused_bytes(session->host->requests, render);
}

/* Refuses a frame that can never be made here: answers and returns false. A private daemon leaves
 * this to the charge of memory, which can say how much the budget lacks, because the model's size
 * is known by then. */
static bool frame_fits(struct session *session, uint32_t seq, const sheen_Render *render)
{
    const struct session_limits *limits = &session->host->limits;
    const struct asset_limits *memory = session->host->asset_limits;
    struct codec_layout all;
    codec_layout_init(&all, render->width_px, render->height_px, message_render_planes(render));
    uint64_t bytes = frame_bytes(session, render);
    /* With what the device draws on, beside the daemon itself. */
    uint64_t everything = bytes + request_device_bytes(session->host->requests, render) +
                          memory->memory_budget - store_account(session->host->store)->limit;
    const char *all_of_it = render->surface == sheen_SurfaceKind_SURFACE_EXACT
                                ? "planes and their encoding"
                                : "planes, their encoding and what polygons are drawn on";
    const struct {
        const char *what, *name;
        uint64_t needed, limit;
    } checks[] = {
        {"planes", "max-frame", all.raw_bytes, limits->max_frame},
        {"planes, their encoding, what they are drawn on and the daemon itself", "memory-budget",
         everything, memory->memory_budget},
        {all_of_it, "peer-memory", bytes, memory->peer_memory},
    };
    bool is_private = session->host->is_private;
    size_t n_checks = is_private ? 1 : sizeof checks / sizeof *checks;
    for (size_t i = 0; i < n_checks; i++) {
        char text[MESSAGE_TEXT_BYTES];
        if (checks[i].needed <= checks[i].limit)
            continue;
        snprintf(text, sizeof text,
                 "%ux%u px: %s take %llu bytes, over %s daemon's --%s of %llu: ask for a smaller "
                 "frame or fewer planes%s",
                 render->width_px, render->height_px, checks[i].what,
                 (unsigned long long)checks[i].needed, is_private ? "a private" : "this",
                 checks[i].name, (unsigned long long)checks[i].limit,
                 is_private ? ", or start sheend with a larger one and name it by --server" : "");
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_TOO_BIG, text);
        return false;
    }
    return true;
}

/* Removes fields that do not exist in the client's minor version. */
static void drop_newer_fields(const struct session *session, sheen_Render *render)
{
    if (session->minor < 2)
        render->has_jpeg_quality = render->has_jpeg_subsampling = false;
    if (session->minor > 0)
        return;
    render->has_view = render->has_deadline_ms = false;
    render->request_class = sheen_RequestClass_CLASS_STILL;
}

void session_render(struct session *session, uint32_t seq, sheen_Render *render)
{
    char text[MESSAGE_TEXT_BYTES];
    const struct renderer_info *info = render_thread_info(session->host->render_thread);
    drop_newer_fields(session, render);
    if (!message_check_render(render, info->max_width_px, info->max_height_px, text)) {
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    if (!frame_fits(session, seq, render))
        return;
    struct reply *reply =
        session_expect_frame(session, seq, request_class_of(render->request_class));
    if (reply)
        request_render(&session->requests, reply, seq, render, frame_bytes(session, render));
}

void session_query(struct session *session, uint32_t seq, const sheen_ModelQuery *query)
{
    char text[MESSAGE_TEXT_BYTES];
    if (!message_check_model_query(query, text)) {
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    struct reply *reply = session_expect_reply(session, seq);
    if (reply)
        request_query(&session->requests, reply, seq, query);
}

static bool check_asked(uint8_t type, const union compute_asked *asked,
                        char text[static MESSAGE_TEXT_BYTES])
{
    if (type == MESSAGE_COMPARE)
        return message_check_compare(&asked->compare, text);
    return type == MESSAGE_TRACE_LINES ? message_check_trace_lines(&asked->trace_lines, text)
                                       : message_check_find_breaks(&asked->find_breaks, text);
}

void session_compute(struct session *session, uint32_t seq, uint8_t type,
                     const union compute_asked *asked)
{
    char text[MESSAGE_TEXT_BYTES];
    if (!check_asked(type, asked, text)) {
        session_reply_error_now(session, seq, sheen_ErrorCode_ERROR_REQUEST, text);
        return;
    }
    struct reply *reply = session_expect_reply(session, seq);
    if (reply)
        request_compute(&session->requests, reply, seq, type, asked);
}
