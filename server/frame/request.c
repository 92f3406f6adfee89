#include "server/frame/request.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/assets/model_file.h"
#include "server/base/clock.h"
#include "server/base/hex.h"
#include "server/frame/error_code.h"
#include "server/frame/request_internal.h"
#include "server/scene/scene_convert.h"

enum request_class request_class_of(sheen_RequestClass request_class)
{
    return request_class == sheen_RequestClass_CLASS_INTERACTIVE ? CLASS_INTERACTIVE
           : request_class == sheen_RequestClass_CLASS_BATCH     ? CLASS_BATCH
                                                                 : CLASS_STILL;
}

static struct request *request_create(struct session *session, struct reply *reply, uint32_t seq)
{
    struct request *request = block_cache_take(session->host->block_cache, sizeof *request);
    if (!request) {
        session_reply_error(session, reply, sheen_ErrorCode_ERROR_OVERLOADED,
                            "no memory for another request: try again later");
        return NULL;
    }
    *request = (struct request){.host = session->host};
    request->session = session;
    request->reply = reply;
    request->seq = seq;
    memcpy(request->owner, session_owner(session), sizeof request->owner);
    memcpy(request->asker, session->client.identity.owner, sizeof request->asker);
    request->start_us = clock_now_us();
    atomic_init(&request->abandoned, false);
    request->next = session->requests;
    if (request->next)
        request->next->previous = request;
    session->requests = request;
    return request;
}

static void leave_session(struct request *request)
{
    struct session *session = request->session;
    if (!session)
        return;
    *(request->previous ? &request->previous->next : &session->requests) = request->next;
    if (request->next)
        request->next->previous = request->previous;
    request->session = NULL;
}

static void unpark(struct request *request)
{
    struct request **link = &request->host->parked;
    while (request->is_parked && *link != request)
        link = &(*link)->next_parked;
    if (request->is_parked)
        *link = request->next_parked;
    request->is_parked = false;
}

void request_end(struct request *request)
{
    leave_session(request);
    unpark(request);
    scheduler_finished(&request->host->scheduler, &request->entry);
    request_drop_frame(request);
    if (request->model.asset)
        store_unuse(request->model.asset);
    for (int i = 0; i < MAX_LIGHTS; i++)
        if (request->images[i].asset)
            store_unuse(request->images[i].asset);
    block_cache_give(request->host->block_cache, request);
}

void request_fail(struct request *request, const struct error *error)
{
    if (request->session)
        session_reply_error(request->session, request->reply, error_code_of(error->kind),
                            error->text);
    request_end(request);
}

static void stop_waiting(struct request *request, struct needed *needed)
{
    if (!store_stop_waiting(&needed->waiter))
        return;
    needed->asset = NULL;
    request->n_awaited--;
}

/* The request goes on without a session, if it must: nobody waits for what it makes. Not for a
 * build, which may take minutes: others would come meanwhile without end, and be taken back. */
static void let_go_of_session(struct request *request)
{
    atomic_store(&request->abandoned, true);
    leave_session(request);
    stop_waiting(request, &request->model);
    for (int i = 0; i < MAX_LIGHTS; i++)
        stop_waiting(request, &request->images[i]);
    scheduler_leave(&request->host->scheduler, &request->entry);
    if (request->n_awaited == 0 && !request->is_busy)
        request_end(request);
}

/* --- answers before their time */

void request_reply_superseded(struct request *request, uint32_t by_seq)
{
    const sheen_Superseded superseded = {.by = by_seq};
    request->host->stats.superseded++;
    session_reply(request->session, request->reply, MESSAGE_SUPERSEDED, &superseded);
    let_go_of_session(request);
}

static void reply_error_early(struct request *request, sheen_ErrorCode code, const char *text)
{
    session_reply_error(request->session, request->reply, code, text);
    let_go_of_session(request);
}

static void cancel(struct request *request, const char *why)
{
    request->host->stats.cancelled++;
    reply_error_early(request, sheen_ErrorCode_ERROR_CANCELLED, why);
}

void request_cancel(struct session *session, uint32_t seq)
{
    struct request *request = session->requests;
    while (request && request->seq != seq)
        request = request->next;
    if (request) /* else it has been answered */
        cancel(request, "the request was taken back");
}

void request_cancel_all(struct session *session)
{
    while (session->requests)
        cancel(session->requests, "the connection ends: it has asked for more than its credits");
}

void request_shut_down_all(struct session *session)
{
    char text[MESSAGE_TEXT_BYTES];
    snprintf(text, sizeof text,
             "not done within the %llu s (drain-timeout) that the daemon takes to shut down: ask "
             "another or the next",
             (unsigned long long)session->host->limits.drain_s);
    while (session->requests)
        reply_error_early(session->requests, sheen_ErrorCode_ERROR_SHUTTING_DOWN, text);
}

bool request_is_late(const struct request *request, uint64_t now_us)
{
    return request->deadline_us > 0 && now_us > request->deadline_us;
}

void request_reply_late(struct request *request)
{
    char text[MESSAGE_TEXT_BYTES];
    snprintf(text, sizeof text, "not drawn within its deadline_ms of %u",
             request->render.deadline_ms);
    request->host->stats.late++;
    reply_error_early(request, sheen_ErrorCode_ERROR_DEADLINE, text);
}

/* Frames that are drawn already are sent all the same. */
void request_end_late(struct session *session, uint64_t now_us)
{
    for (struct request *request = session->requests, *next; request; request = next) {
        next = request->next;
        if (request->entry.state < SCHEDULE_DRAWING && request_is_late(request, now_us))
            request_reply_late(request);
    }
}

/* --- what it needs from the store */

static void assets_ready(struct request *request);

static void let_go(struct request *request)
{
    if (--request->n_awaited == 0)
        assets_ready(request);
}

static void asset_ready(struct asset_waiter *waiter, const struct error *failure)
{
    struct needed *needed = waiter->owner;
    if (failure) {
        needed->asset = NULL;
        needed->request->failure = *failure;
    }
    let_go(needed->request);
}

static void acquire(struct request *request, struct needed *needed, enum asset_kind kind,
                    const uint8_t *sha256)
{
    needed->request = request;
    needed->waiter = (struct asset_waiter){.ready = asset_ready, .owner = needed};
    needed->asset = store_find(request->host->store, request->owner, kind, sha256);
    request->n_awaited++;
    switch (store_acquire(needed->asset, request->asker, &needed->waiter, &request->failure)) {
    case ACQUIRE_WAIT:
        return;
    case ACQUIRE_FAILED:
        needed->asset = NULL;
        break;
    case ACQUIRE_READY:
        break;
    }
    let_go(request);
}

/* Answers and returns false when the daemon lacks the file. */
static bool is_known(struct request *request, enum asset_kind kind, const uint8_t *sha256)
{
    if (store_find(request->host->store, request->owner, kind, sha256))
        return true;
    char hex[2 * MODEL_ID_BYTES + 1], text[160];
    hex_write(sha256, MODEL_ID_BYTES, hex);
    snprintf(text, sizeof text, "no %s with SHA-256 %s here: upload it first",
             kind == ASSET_MODEL ? "model" : "image", hex);
    session_reply_error(request->session, request->reply, sheen_ErrorCode_ERROR_UNKNOWN_MODEL,
                        text);
    request_end(request);
    return false;
}

/* --- model queries */

static void fill_survey(sheen_ModelInfo *info, const struct cage_survey *survey)
{
    _Static_assert(SURVEY_MAX_VALENCES == sizeof info->extraordinary / sizeof *info->extraordinary,
                   "a survey fits the message");
    info->triangles = survey->n_triangles;
    info->quads = survey->n_quads;
    info->ngons = survey->n_ngons;
    info->boundary_edges = survey->n_boundary_edges;
    info->boundary_extraordinary = survey->n_boundary_extraordinary;
    info->sharp_edges = survey->n_sharp_edges;
    info->semisharp_edges = survey->n_semisharp_edges;
    info->sharp_vertices = survey->n_sharp_vertices;
    info->holes = survey->n_holes;
    info->nonmanifold_edges = survey->n_nonmanifold_edges;
    info->nonmanifold_vertices = survey->n_nonmanifold_vertices;
    info->extraordinary_count = (pb_size_t)survey->n_valences;
    for (uint32_t i = 0; i < survey->n_valences; i++)
        info->extraordinary[i] =
            (sheen_ValenceCount){survey->extraordinary[i].valence, survey->extraordinary[i].count};
}

/* The wire numbers the kinds as the cage does. */
static void fill_findings(sheen_ModelInfo *info, const struct model *model)
{
    _Static_assert(N_CAGE_FINDINGS <= sizeof info->findings / sizeof *info->findings,
                   "all kinds fit the message");
    _Static_assert((int)CAGE_FOUND_INSIDE_OUT == (int)sheen_FindingKind_FINDING_INSIDE_OUT,
                   "the last kind here and there");
    info->findings_count = (pb_size_t)model->n_findings;
    for (size_t i = 0; i < model->n_findings; i++) {
        const struct cage_finding *finding = &model->finding[i];
        info->findings[i] = (sheen_Finding){
            .kind = (sheen_FindingKind)finding->kind,
            .count = finding->count,
            .has_line = finding->line != 0,
            .line = finding->line,
            .has_face = finding->face != CAGE_NO_FACE,
            .face = finding->face,
        };
    }
}

static void reply_query(struct request *request)
{
    const struct asset *asset = request->model.asset;
    const struct model *model = asset->model;
    const struct limit_tables *tables = &model->tables;
    const uint64_t node_bytes = sizeof *tables->nodes + sizeof *tables->adjacency;
    sheen_ModelInfo info = {
        .file_bytes = asset->file_bytes,
        .vertices = (uint32_t)model->n_vertices,
        .faces = (uint32_t)model->n_faces,
        .ptex_faces = (uint32_t)tables->n_faces,
        .regular_patches = (uint32_t)tables->n_regular,
        .corner_patches = (uint32_t)tables->n_corner,
        .strip_patches = (uint32_t)tables->n_strip,
        .split_nodes = (uint32_t)tables->n_split,
        .hole_nodes = (uint32_t)tables->n_hole,
        .table_bytes = model->device_bytes,
        .regular_bytes = node_bytes + LIMIT_PATCH_TEXELS * sizeof *tables->texels,
        .corner_bytes = node_bytes + LIMIT_CORNER_TEXELS(LIMIT_MAX_LEVELS) * sizeof *tables->texels,
        .tables_us = model->build_us,
        .box_min = scene_write_vec3(tables->box_min),
        .box_max = scene_write_vec3(tables->box_max),
    };
    memcpy(info.sha256, asset->sha256, sizeof info.sha256);
    snprintf(info.name, sizeof info.name, "%s", asset->name);
    snprintf(info.warnings, sizeof info.warnings, "%s", model->warnings ? model->warnings : "");
    message_make_text(info.warnings, true);
    fill_survey(&info, &model->survey);
    fill_findings(&info, model);
    session_reply(request->session, request->reply, MESSAGE_MODEL_INFO, &info);
    request_end(request);
}

static void file_loaded(void *owner, const uint8_t *sha256, const struct error *error)
{
    struct request *request = owner;
    request->host->n_file_loads--;
    if (sha256)
        acquire(request, &request->model, ASSET_MODEL, sha256);
    else
        request->failure = *error;
    let_go(request);
}

/* The model is a file at the daemon: waits until it has been read. */
static void load_file(struct request *request, const char *name)
{
    struct session_host *host = request->host;
    const struct model_file_order order = {
        .folder_fd = host->models_fd,
        .name = name,
        .max_bytes = host->max_upload_bytes,
        .holder = request->asker,
        .pool = host->pool,
        .store = host->store,
        .loaded = file_loaded,
        .owner = request,
    };
    if (host->models_fd < 0)
        error_set(&request->failure, ERROR_REQUEST,
                  "this daemon has no model files of its own; sheend --models gives it some");
    else if (model_file_load(&order, &request->failure)) {
        request->n_awaited++;
        host->n_file_loads++;
    }
}

void request_query(struct session *session, struct reply *reply, uint32_t seq,
                   const sheen_ModelQuery *query)
{
    struct request *request = request_create(session, reply, seq);
    if (!request || (!query->has_file && !is_known(request, ASSET_MODEL, query->sha256)))
        return;
    request->is_query = true;
    request->n_awaited = 1; /* until all is asked for */
    if (query->has_file)
        load_file(request, query->file);
    else
        acquire(request, &request->model, ASSET_MODEL, query->sha256);
    let_go(request);
}

/* --- renders */

/* From here on a newer request of its view replaces it. */
static void enter_queue(struct request *request)
{
    struct schedule_entry *entry = &request->entry;
    const sheen_Render *render = &request->render;
    entry->owner = request;
    entry->request_class = request_class_of(render->request_class);
    entry->has_view = render->has_view || entry->request_class == CLASS_INTERACTIVE;
    entry->view = render->view;
    struct schedule_entry *replaced =
        scheduler_enter(&request->host->scheduler, &request->session->queue, entry);
    if (replaced)
        request_reply_superseded(replaced->owner, request->seq);
}

/* Does a worker process write it, or has it a legend? */
static bool takes_images(const sheen_Render *render)
{
    return render->encoding == sheen_Encoding_ENCODING_EXR ||
           render->encoding == sheen_Encoding_ENCODING_TIFF ||
           (render->show.kind != sheen_ShowKind_SHOW_LINES &&
            false_colour_has_legend(&render->show));
}

void request_render(struct session *session, struct reply *reply, uint32_t seq,
                    const sheen_Render *render, uint64_t frame_bytes)
{
    struct request *request = request_create(session, reply, seq);
    if (!request)
        return;
    if (!is_known(request, ASSET_MODEL, render->model_sha256))
        return;
    for (pb_size_t i = 0; i < render->lights_count; i++)
        if (render->lights[i].pattern.has_image_sha256 &&
            !is_known(request, ASSET_IMAGE, render->lights[i].pattern.image_sha256))
            return;
    request->render = *render;
    request->frame_bytes = frame_bytes;
    if (takes_images(render))
        workers_expect_images(&request->host->workers);
    if (render->has_deadline_ms)
        request->deadline_us = request->start_us + render->deadline_ms * 1000ull;
    enter_queue(request);
    request->n_awaited = 1; /* until all is asked for */
    acquire(request, &request->model, ASSET_MODEL, render->model_sha256);
    for (pb_size_t i = 0; i < render->lights_count; i++)
        if (render->lights[i].pattern.has_image_sha256)
            acquire(request, &request->images[i], ASSET_IMAGE,
                    render->lights[i].pattern.image_sha256);
    let_go(request);
}

static void assets_ready(struct request *request)
{
    if (request->failure.kind != ERROR_NONE) {
        request_fail(request, &request->failure);
        return;
    }
    if (!request->session) {
        request_end(request);
        return;
    }
    if (request->is_query) {
        reply_query(request);
        return;
    }
    request_queue_frame(request);
}

/* --- when the session goes */

void request_abandon_all(struct session *session)
{
    while (session->requests)
        let_go_of_session(session->requests);
}

void request_report_progress(struct session *session)
{
    for (struct request *request = session->requests; request; request = request->next) {
        const struct asset *asset = request->model.asset;
        if (!asset || asset->state != ASSET_BUILDING)
            continue;
        sheen_Progress progress = {.done = atomic_load(&asset->progress.done),
                                   .total = asset->progress.total};
        snprintf(progress.stage, sizeof progress.stage, "%s", asset->progress.stage);
        session_report_progress(session, request->reply, request->seq, &progress);
    }
}
