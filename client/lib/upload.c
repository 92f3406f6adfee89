/* Uploads files, and asks the daemon about models. */
#include <openssl/evp.h>
#include <string.h>

#include "client/lib/session.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"

bool sheen_file_id(const void *bytes, size_t n_bytes, uint8_t id[SHEEN_ID_BYTES])
{
    return EVP_Digest(bytes, n_bytes, id, NULL, EVP_sha256(), NULL) == 1;
}

/* Copies the file's name without folders, cut to 255 bytes of valid text. The end is kept, because
 * it tells the format. */
static void clean_name(char *clean, size_t clean_bytes, const char *name)
{
    const char *slash = strrchr(name, '/');
    const char *base = slash ? slash + 1 : name;
    size_t length = strlen(base);
    if (length >= clean_bytes) {
        base += length - (clean_bytes - 1);
        while (((unsigned char)*base & 0xc0) == 0x80)
            base++; /* do not begin in the middle of a character */
    }
    snprintf(clean, clean_bytes, "%s", base);
    if (message_is_text(clean, false))
        return;
    for (char *c = clean; *c; c++)
        if ((unsigned char)*c < 0x20 || (unsigned char)*c >= 0x7f)
            *c = '?';
}

static enum sheen_status send_chunks(struct sheen_session *session, uint32_t seq,
                                     const uint8_t *bytes, size_t n_bytes, size_t sent,
                                     const struct sheen_progress *progress,
                                     struct sheen_error *error)
{
    while (sent < n_bytes) {
        size_t left = n_bytes - sent;
        uint32_t n = left < PROTOCOL_MAX_CHUNK_BYTES ? (uint32_t)left : PROTOCOL_MAX_CHUNK_BYTES;
        enum sheen_status status =
            session_send_raw(session, MESSAGE_UPLOAD_CHUNK, seq, bytes + sent, n, error);
        if (status)
            return status;
        sent += n;
        if (progress && progress->report)
            progress->report(progress->context, "upload", sent, n_bytes);
    }
    return SHEEN_OK;
}

enum sheen_status sheen_upload(struct sheen_session *session, enum sheen_file_kind kind,
                               const uint8_t id[SHEEN_ID_BYTES], const void *bytes, size_t n_bytes,
                               const char *name, const struct sheen_progress *progress,
                               struct sheen_error *error)
{
    uint32_t seq;
    sheen_UploadState state;
    char text[MESSAGE_TEXT_BYTES];
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (!bytes || !id || !name || session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "an upload needs an id, bytes and a name, and no request in flight");
    if (n_bytes > session->hello.max_upload_bytes)
        return status_set(error, SHEEN_TOO_BIG, "%s: %zu bytes, the server takes %llu at most%s",
                          name, n_bytes, (unsigned long long)session->hello.max_upload_bytes,
                          session->daemon.pid > 0 && n_bytes <= PROTOCOL_MAX_UPLOAD_BYTES
                              ? ": give it a larger --memory-budget"
                              : "");
    sheen_UploadBegin begin = {.kind = kind == SHEEN_FILE_IMAGE ? sheen_UploadKind_UPLOAD_IMAGE
                                                                : sheen_UploadKind_UPLOAD_MODEL,
                               .size_bytes = n_bytes,
                               .has_share = session->share,
                               .share = session->share};
    memcpy(begin.sha256, id, SHEEN_ID_BYTES);
    clean_name(begin.name, sizeof(begin.name), name);
    if (!message_check_upload_begin(&begin, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s: %s", name, text);
    status = session_send(session, MESSAGE_UPLOAD_BEGIN, &begin, &seq, error);
    if (!status)
        status = session_receive(session, seq, MESSAGE_UPLOAD_STATE, progress, &state, error);
    if (status || state.complete)
        return status;
    if (state.received_bytes >= n_bytes)
        goto broken;
    status =
        send_chunks(session, seq, bytes, n_bytes, (size_t)state.received_bytes, progress, error);
    if (!status)
        status = session_receive(session, seq, MESSAGE_UPLOAD_STATE, progress, &state, error);
    if (status || state.complete)
        return status;
broken:
    status_set(error, SHEEN_BAD_PEER, "the server broke the protocol: an upload without an end");
    return session_fail(session, SHEEN_BAD_PEER, error);
}

/* A server may send any 32 bits, and some compilers use a signed type for an enum. */
static enum sheen_finding_kind known_kind(sheen_FindingKind kind)
{
    return (uint32_t)kind < (uint32_t)SHEEN_FINDING_OTHER ? (enum sheen_finding_kind)kind
                                                          : SHEEN_FINDING_OTHER;
}

static void copy_findings(struct sheen_model_info *info, const sheen_ModelInfo *body)
{
    _Static_assert(sizeof(info->findings) / sizeof(*info->findings) ==
                       sizeof(body->findings) / sizeof(*body->findings),
                   "the schema's bound");
    _Static_assert((int)SHEEN_FINDING_OTHER - 1 == (int)_sheen_FindingKind_MAX,
                   "the kinds have the schema's numbers");
    info->n_findings = body->findings_count;
    for (size_t i = 0; i < body->findings_count; i++) {
        const sheen_Finding *from = &body->findings[i];
        info->findings[i] = (struct sheen_finding){
            .kind = known_kind(from->kind),
            .count = from->count,
            .line = from->has_line ? from->line : 0,
            .has_face = from->has_face,
            .face = from->face,
        };
    }
}

static void copy_info(struct sheen_model_info *info, const sheen_ModelInfo *body)
{
    *info = (struct sheen_model_info){
        .file_bytes = body->file_bytes,
        .vertices = body->vertices,
        .faces = body->faces,
        .triangles = body->triangles,
        .quads = body->quads,
        .ngons = body->ngons,
        .ptex_faces = body->ptex_faces,
        .patches = body->patches,
        .boundary_edges = body->boundary_edges,
        .n_valences = body->extraordinary_count,
        .boundary_extraordinary = body->boundary_extraordinary,
        .sharp_edges = body->sharp_edges,
        .semisharp_edges = body->semisharp_edges,
        .sharp_vertices = body->sharp_vertices,
        .holes = body->holes,
        .nonmanifold_edges = body->nonmanifold_edges,
        .nonmanifold_vertices = body->nonmanifold_vertices,
        .regular_patches = body->regular_patches,
        .corner_patches = body->corner_patches,
        .strip_patches = body->strip_patches,
        .split_nodes = body->split_nodes,
        .hole_nodes = body->hole_nodes,
        .table_bytes = body->table_bytes,
        .regular_bytes = body->regular_bytes,
        .corner_bytes = body->corner_bytes,
        .tables_us = body->tables_us,
        .box_min = {body->box_min.x, body->box_min.y, body->box_min.z},
        .box_max = {body->box_max.x, body->box_max.y, body->box_max.z},
    };
    memcpy(info->id, body->sha256, SHEEN_ID_BYTES);
    _Static_assert(sizeof(info->name) == sizeof(body->name), "the schema's bound");
    _Static_assert(sizeof(info->warnings) == sizeof(body->warnings), "the schema's bound");
    memcpy(info->name, body->name, sizeof(info->name));
    memcpy(info->warnings, body->warnings, sizeof(info->warnings));
    copy_findings(info, body);
    for (size_t i = 0; i < body->extraordinary_count; i++) {
        info->extraordinary[i].valence = body->extraordinary[i].valence;
        info->extraordinary[i].count = body->extraordinary[i].count;
    }
}

static enum sheen_status query(struct sheen_session *session, const sheen_ModelQuery *query,
                               const struct sheen_progress *progress, sheen_ModelInfo *info,
                               struct sheen_error *error)
{
    uint32_t seq;
    enum sheen_status status = session_send(session, MESSAGE_MODEL_QUERY, query, &seq, error);
    return status ? status
                  : session_receive(session, seq, MESSAGE_MODEL_INFO, progress, info, error);
}

enum sheen_status sheen_find_model(struct sheen_session *session, const char *name,
                                   const struct sheen_progress *progress,
                                   uint8_t id[SHEEN_ID_BYTES], struct sheen_error *error)
{
    sheen_ModelQuery ask = {.has_file = true};
    sheen_ModelInfo body;
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    if (!name || !id || session->n_pending || strlen(name) >= sizeof(ask.file))
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "a file at the server needs a name of at most %zu bytes, and no request "
                          "in flight",
                          sizeof(ask.file) - 1);
    memcpy(ask.file, name, strlen(name) + 1);
    status = query(session, &ask, progress, &body, error);
    if (!status)
        memcpy(id, body.sha256, SHEEN_ID_BYTES);
    return status;
}

enum sheen_status sheen_query_model(struct sheen_session *session, const uint8_t id[SHEEN_ID_BYTES],
                                    const struct sheen_progress *progress,
                                    struct sheen_model_info *info, struct sheen_error *error)
{
    sheen_ModelQuery ask = {.has_file = false};
    sheen_ModelInfo body;
    enum sheen_status status = session_check(session, error);
    if (status)
        return status;
    status = sized_check(info, "info", error);
    if (status)
        return status;
    if (!id || session->n_pending)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "a model query needs an id, and no request in flight");
    memcpy(ask.sha256, id, SHEEN_ID_BYTES);
    status = query(session, &ask, progress, &body, error);
    if (status)
        return status;
    struct sheen_model_info whole;
    copy_info(&whole, &body);
    sized_give(info, &whole, sizeof(whole));
    return SHEEN_OK;
}
