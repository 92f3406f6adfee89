#include "server/service/request.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/service/label.h"
#include "server/service/show.h"
#include "server/service/wire.h"

/* Something from the store that a request works with. */
struct needed {
    struct request *request;
    struct asset *asset; /* in use, or waited for; NULL: not */
    struct asset_waiter waiter;
};

struct request {
    struct session_host *host;
    struct session *session;         /* NULL once it has gone */
    struct request *next, *previous; /* of the session */
    struct answer *answer;           /* valid while there is a session */
    uint32_t seq;
    bool is_query;
    uint64_t start_us;

    struct needed model, images[MAX_LIGHTS];
    unsigned n_awaited;
    struct error failure; /* kind ERROR_NONE: none yet */

    sheen_Render render;
    struct frame_request frame_request;
    struct codec_layout layout;
    struct schedule_entry entry;
    struct work work;      /* on the GL thread, then on the pool to paint false colour */
    atomic_bool abandoned; /* read by the GL thread and the pool's */
    bool rendered;
    struct frame frame;
    sheen_Times times;
    uint64_t encode_start_us;
    struct label label;
};

static struct request *request_create(struct session *session, struct answer *answer, uint32_t seq)
{
    struct request *request = calloc(1, sizeof *request);
    if (!request) {
        session_answer_error(session, answer, sheen_ErrorCode_ERROR_OVERLOADED,
                             "no memory for another request: try again later");
        return NULL;
    }
    request->host = session->host;
    request->session = session;
    request->answer = answer;
    request->seq = seq;
    request->start_us = loop_now_us();
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

static void request_end(struct request *request)
{
    leave_session(request);
    if (request->model.asset)
        store_unuse(request->model.asset);
    for (int i = 0; i < MAX_LIGHTS; i++)
        if (request->images[i].asset)
            store_unuse(request->images[i].asset);
    free(request);
}

static void request_fail(struct request *request, const struct error *error)
{
    if (request->session)
        session_answer_error(request->session, request->answer, wire_error_code(error->kind),
                             error->text);
    request_end(request);
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
    needed->waiter = (struct asset_waiter){asset_ready, needed, NULL};
    needed->asset = store_find(request->host->store, kind, sha256);
    request->n_awaited++;
    switch (store_acquire(needed->asset, &needed->waiter, &request->failure)) {
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
    if (store_find(request->host->store, kind, sha256))
        return true;
    char hex[2 * MODEL_ID_BYTES + 1], text[160];
    wire_hex(sha256, hex);
    snprintf(text, sizeof text, "no %s with SHA-256 %s here: upload it first",
             kind == ASSET_MODEL ? "model" : "image", hex);
    session_answer_error(request->session, request->answer, sheen_ErrorCode_ERROR_UNKNOWN_MODEL,
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

static void answer_query(struct request *request)
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
        .table_bytes = model->reserved_bytes,
        .regular_bytes = node_bytes + LIMIT_PATCH_TEXELS * sizeof *tables->texels,
        .corner_bytes = node_bytes + LIMIT_CORNER_TEXELS(LIMIT_MAX_LEVELS) * sizeof *tables->texels,
        .tables_us = model->build_us,
        .box_min = wire_from_vec3(tables->box_min),
        .box_max = wire_from_vec3(tables->box_max),
    };
    memcpy(info.sha256, asset->sha256, sizeof info.sha256);
    snprintf(info.name, sizeof info.name, "%s", asset->name);
    snprintf(info.warnings, sizeof info.warnings, "%s", model->warnings ? model->warnings : "");
    wire_make_text(info.warnings, true);
    fill_survey(&info, &model->survey);
    session_answer(request->session, request->answer, MESSAGE_MODEL_INFO, &info);
    request_end(request);
}

void request_query(struct session *session, struct answer *answer, uint32_t seq,
                   const sheen_ModelQuery *query)
{
    struct request *request = request_create(session, answer, seq);
    if (!request || !is_known(request, ASSET_MODEL, query->sha256))
        return;
    request->is_query = true;
    request->n_awaited = 1; /* until all is asked for */
    acquire(request, &request->model, ASSET_MODEL, query->sha256);
    let_go(request);
}

/* --- renders */

void request_render(struct session *session, struct answer *answer, uint32_t seq,
                    const sheen_Render *render)
{
    struct request *request = request_create(session, answer, seq);
    if (!request)
        return;
    if (!is_known(request, ASSET_MODEL, render->model_sha256))
        return;
    for (pb_size_t i = 0; i < render->lights_count; i++)
        if (render->lights[i].pattern.has_image_sha256 &&
            !is_known(request, ASSET_IMAGE, render->lights[i].pattern.image_sha256))
            return;
    request->render = *render;
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
        answer_query(request);
        return;
    }
    const struct limit_tables *tables = &request->model.asset->model->tables;
    wire_to_frame_request(&request->render, tables->box_min, tables->box_max,
                          &request->frame_request);
    for (int i = 0; i < MAX_LIGHTS; i++)
        if (request->images[i].asset)
            request->frame_request.lights[i].pattern.image = request->images[i].asset->image->gpu;
    request->entry.owner = request;
    scheduler_push(&request->host->scheduler, &request->session->queue, &request->entry);
}

static void render_run(struct work *work, void *worker)
{
    struct request *request = work->owner;
    if (!atomic_load(&request->abandoned))
        request->rendered =
            renderer_render(worker, request->model.asset->model->gpu, &request->frame_request,
                            &request->frame, &request->failure);
}

static void fill_frame(const struct request *request, const struct encoded *encoded,
                       sheen_Frame *frame)
{
    const struct frame_request *asked = &request->frame_request;
    const struct renderer_info *info = render_thread_info(request->host->render_thread);
    *frame = (sheen_Frame){
        .width_px = asked->width_px,
        .height_px = asked->height_px,
        .planes = request->render.planes,
        .encoding = request->render.encoding,
        .data_bytes = encoded->size,
        .times = request->times,
        .camera = wire_from_camera(&asked->camera),
        .lights_count = (pb_size_t)asked->n_lights,
        .lines = wire_from_lines(&asked->lines),
        .software = info->software,
        .has_show_range = request->render.show.has_range,
        .show_range = request->render.show.range,
        .has_miss = true,
        .miss = wire_from_colour(asked->miss),
        .has_empty = true,
        .empty = wire_from_colour(asked->empty),
        .has_base = true,
        .base = wire_from_colour(asked->base),
    };
    for (uint32_t i = 0; i < asked->n_lights; i++)
        frame->lights[i] =
            wire_from_light(&asked->lights[i],
                            i < request->render.lights_count ? &request->render.lights[i] : NULL);
    snprintf(frame->device, sizeof frame->device, "%s", info->device);
    snprintf(frame->driver, sizeof frame->driver, "%s", info->driver);
    snprintf(frame->server, sizeof frame->server, "%s", SHEEN_VERSION);
}

static void answer_frame(struct request *request, struct encoded *encoded)
{
    uint64_t now = loop_now_us();
    request->times.encode_us = now - request->encode_start_us;
    request->times.tables_us = request->model.asset->unreported_us;
    request->times.total_us = now - request->start_us;
    request->model.asset->unreported_us = 0;
    stats_frame(&request->host->stats, &request->times);
    sheen_Frame frame;
    fill_frame(request, encoded, &frame);
    session_answer_frame(request->session, request->answer, &frame, encoded);
    request_end(request);
}

static void encode_finished(void *owner, struct encoded *encoded, const struct error *error)
{
    struct request *request = owner;
    scheduler_finished(&request->host->scheduler, &request->entry);
    if (error) {
        request_fail(request, error);
    } else if (!request->session) {
        encoded_destroy(encoded);
        request_end(request);
    } else {
        answer_frame(request, encoded);
    }
}

static void start_encoding(struct request *request)
{
    label_init(&request->label, &request->frame_request, &request->render,
               render_thread_info(request->host->render_thread));
    encode_start(request->host->pool, &request->frame, &request->layout, request->render.encoding,
                 request->label.attributes, LABEL_ATTRIBUTES, encode_finished, request);
}

/* There is no frame, or nobody to take it. */
static void end_unencoded(struct request *request)
{
    if (request->rendered)
        frame_finish(&request->frame);
    scheduler_finished(&request->host->scheduler, &request->entry);
    request_fail(request, &request->failure);
}

static void paint_run(struct work *work, void *worker)
{
    (void)worker;
    struct request *request = work->owner;
    struct frame *frame = &request->frame;
    const struct limit_tables *tables = &request->model.asset->model->tables;
    if (atomic_load(&request->abandoned))
        return;
    double size = 0;
    for (int i = 0; i < 3; i++)
        size = hypot(size, tables->box_max[i] - tables->box_min[i]);
    show_paint(frame, &request->render.show, size, request->frame_request.miss,
               request->frame_request.empty);
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++)
        if (!(request->layout.planes & 1u << plane)) {
            free(frame->plane[plane]);
            frame->plane[plane] = NULL;
        }
}

static void paint_done(struct work *work)
{
    struct request *request = work->owner;
    if (request->session)
        start_encoding(request);
    else
        end_unencoded(request);
}

static void render_done(struct work *work)
{
    struct request *request = work->owner;
    if (!request->rendered || !request->session) {
        end_unencoded(request);
        return;
    }
    const struct frame_times *times = &request->frame.times;
    request->times.visibility_us = times->visibility_us;
    request->times.evaluate_us = times->evaluate_us;
    request->times.shade_us = times->shade_us;
    request->times.readback_us = times->readback_us;
    request->encode_start_us = loop_now_us();
    if (request->render.show.kind == sheen_ShowKind_SHOW_LINES) {
        start_encoding(request);
        return;
    }
    request->work = (struct work){paint_run, paint_done, request, NULL};
    pool_submit(request->host->pool, &request->work, POOL_URGENT);
}

void request_start_next(struct session_host *host)
{
    for (struct schedule_entry *entry; (entry = scheduler_next(&host->scheduler));) {
        struct request *request = entry->owner;
        const sheen_Render *render = &request->render;
        codec_layout_init(&request->layout, render->width_px, render->height_px, render->planes);
        request->work = (struct work){render_run, render_done, request, NULL};
        render_thread_submit(host->render_thread, &request->work);
    }
}

/* --- when the session goes */

static void drop_waiting(struct schedule_entry *entry)
{
    request_end(entry->owner);
}

void request_abandon_all(struct session *session)
{
    scheduler_remove_queue(&session->host->scheduler, &session->queue, drop_waiting);
    while (session->requests) {
        struct request *request = session->requests;
        request->entry.queue = NULL;
        atomic_store(&request->abandoned, true);
        leave_session(request);
    }
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
        session_report_progress(session, request->answer, request->seq, &progress);
    }
}
