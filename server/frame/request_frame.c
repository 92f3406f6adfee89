/* How a frame gets its assets, memory and turn, and is drawn and painted. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/frame/compute.h"
#include "server/frame/cut.h"
#include "server/frame/request.h"
#include "server/frame/request_internal.h"
#include "server/scene/scene_convert.h"

static struct cut cut_for(const struct request_host *host, const sheen_Render *render)
{
    const struct renderer_info *info = render_thread_info(host->render_thread);
    const struct cut_device device = {info->software, info->n_threads};
    return cut_frame(render, &device);
}

uint64_t request_paused_bytes(const struct request_host *host, const sheen_Render *render)
{
    return render->surface == sheen_SurfaceKind_SURFACE_EXACT
               ? 0
               : renderer_paused_bytes(render_thread_device(host->render_thread), render->width_px,
                                       render->height_px, cut_for(host, render).tile_px);
}

uint64_t request_device_bytes(const struct request_host *host, const sheen_Render *render)
{
    const struct cut cut = cut_for(host, render);
    const uint32_t measured = PLANE_LIGHT | PLANE_CURVATURE | PLANE_LIGHT_CHANGE;
    const struct renderer_frame_size size = {.width_px = render->width_px,
                                             .height_px = render->height_px,
                                             .is_part = render->has_window,
                                             .tile_px = cut.tile_px,
                                             .in_place = cut.in_place,
                                             .several_lights = render->lights_count > 1,
                                             .measures = message_render_planes(render) & measured};
    return renderer_frame_bytes(render_thread_device(host->render_thread), &size);
}

/* --- into the queue */

static bool is_abandoned(void *owner)
{
    const struct request *request = owner;
    return atomic_load(&request->abandoned);
}

static uint64_t next_tile_px(const struct request *request)
{
    const struct frame_request *asked = &request->frame_request;
    uint64_t px = (uint64_t)asked->width_px * asked->height_px, tile = request->frame_work.tile_px;
    return tile > 0 && tile < px ? tile : px;
}

/* Frames with the same key cost about the same per pixel. */
static uint64_t cost_key(const struct request *request)
{
    const struct frame_request *asked = &request->frame_request;
    uint64_t key = 0;
    for (int i = 0; i < MODEL_ID_BYTES; i += 8) {
        uint64_t part;
        memcpy(&part, request->render.model_sha256 + i, sizeof part);
        key = costs_key(key, part);
    }
    key = costs_key(key, asked->planes | (uint64_t)asked->n_lights << 32);
    key = costs_key(key, (uint64_t)asked->surface.kind << 8 | asked->surface.level);
    return costs_key(key, next_tile_px(request) >> 16); /* small tiles cost more per pixel */
}

/* --- polygons: the store makes them, and several frames may share them */

static bool has_begun(const struct request *request)
{
    return request->frame.width_px > 0;
}

/* Releases the polygons, or stops waiting for them. */
static void drop_polygons(struct request *request)
{
    struct needed *needed = &request->polygons;
    request->frame_work.polygons = NULL;
    if (needed->asset && !store_stop_waiting(&needed->waiter))
        store_unuse(needed->asset);
    needed->asset = NULL;
}

static void join_queue(struct request *request)
{
    request->frame_work.polygons = request->polygons.asset->polygons;
    request_state_move(&request->state, REQUEST_QUEUED);
    if (has_begun(request))
        scheduler_resume(&request->entry);
    else
        scheduler_ready(&request->entry);
}

static void polygons_ready(struct asset_waiter *waiter, const struct error *failure)
{
    struct request *request = waiter->owner;
    if (!failure) {
        join_queue(request);
        return;
    }
    request->polygons.asset = NULL;
    request_fail(request, failure);
}

/* Asks the store for the polygons, because the device never had them or has lost them. */
static void start_polygons(struct request *request)
{
    struct needed *needed = &request->polygons;
    const uint32_t level = request->frame_request.surface.level;
    drop_polygons(request); /* the device had these, and has lost them */
    needed->asset = store_find_polygons(request->model.asset, level, &request->failure);
    needed->waiter = (struct asset_waiter){.ready = polygons_ready, .owner = request};
    request_state_move(&request->state, REQUEST_POLYGONS);
    switch (needed->asset
                ? store_acquire(needed->asset, request->asker, &needed->waiter, &request->failure)
                : ACQUIRE_FAILED) {
    case ACQUIRE_WAIT:
        break;
    case ACQUIRE_READY:
        join_queue(request);
        break;
    case ACQUIRE_FAILED:
        needed->asset = NULL;
        request_fail(request, &request->failure);
        break;
    }
}

static bool needs_polygons(const struct request *request)
{
    const struct surface *surface = &request->frame_request.surface;
    const struct asset *asset = request->model.asset;
    bool has = asset->drawn_on == request->host->gpu_generation &&
               asset->drawn_levels & 1u << surface->level;
    return surface->kind != SURFACE_EXACT && !has;
}

static bool shows_lines(const sheen_Render *render)
{
    return render->show.kind == sheen_ShowKind_SHOW_LINES &&
           render->surface != sheen_SurfaceKind_SURFACE_WIREFRAME;
}

void request_queue_frame(struct request *request)
{
    struct frame_request *asked = &request->frame_request;
    const sheen_Render *render = &request->render;
    const struct scene_subject subject = model_subject(request->model.asset->model);
    scene_read_request(render, &subject, asked);
    asked->count_light = shows_lines(render);
    request->up_source = scene_model_up(render, &subject, request->up);
    for (int i = 0; i < MAX_LIGHTS; i++)
        if (request->images[i].asset)
            asked->lights[i].pattern.image = request->images[i].asset->image->gpu;
    codec_layout_init(&request->layout, render->width_px, render->height_px, render->planes);
    const struct cut cut = cut_for(request->host, render);
    request->frame_work = (struct frame_work){.request = asked,
                                              .tile_px = cut.tile_px,
                                              .in_place = cut.in_place,
                                              .asker = (uintptr_t)request->party,
                                              .watch = {is_abandoned, request}};
    request->cost_key = cost_key(request);
    request->entry.estimate_us =
        costs_estimate(&request->host->costs, request->cost_key, next_tile_px(request));
    if (needs_polygons(request)) {
        start_polygons(request);
        return;
    }
    request_state_move(&request->state, REQUEST_QUEUED);
    scheduler_ready(&request->entry);
}

void request_drop_frame(struct request *request)
{
    drop_polygons(request);
    frame_work_finish(&request->frame_work);
    frame_finish(&request->frame);
    encoded_destroy(request->held);
    request->held = NULL;
    memory_charge_release(request->charge);
    request->charge = NULL;
}

/* --- drawing and painting */

static void paint_run(struct task *task, void *context)
{
    (void)context;
    struct request *request = task->owner;
    struct frame *frame = &request->frame;
    const struct limit_tables *tables = &request->model.asset->model->tables;
    if (atomic_load(&request->abandoned))
        return;
    double size = 0;
    for (int i = 0; i < 3; i++)
        size = hypot(size, tables->box_max[i] - tables->box_min[i]);
    false_colour_paint(frame, &request->render.show, size, request->frame_request.miss,
                       request->frame_request.empty, &request->extremes);
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++)
        if (!(request->layout.planes & 1u << plane)) {
            block_cache_give(frame->block_cache, frame->plane[plane]);
            frame->plane[plane] = NULL;
        }
}

static void paint_done(struct task *task)
{
    struct request *request = task->owner;
    if (request->state == REQUEST_ABANDONED)
        request_end(request);
    else
        request_start_encoding(request);
}

static void frame_drawn(struct request *request)
{
    const struct frame_times *times = &request->frame.times;
    request->times.visibility_us = times->visibility_us;
    request->times.evaluate_us = times->evaluate_us;
    request->times.shade_us = times->shade_us;
    request->times.readback_us = times->readback_us;
    request->is_blank = !request->frame.shows_surface;
    request->has_light_share = request->frame.seen_px > 0;
    if (request->has_light_share)
        request->light_share = (double)request->frame.met_px / (double)request->frame.seen_px;
    request->encode_start_us = clock_now_us();
    if (request->render.show.kind == sheen_ShowKind_SHOW_LINES) {
        request_start_encoding(request);
        return;
    }
    request_state_move(&request->state, REQUEST_PAINTING);
    request->task = (struct task){paint_run, paint_done, request, {NULL}};
    pool_submit(request->host->pool, &request->task, request_urgency(request));
}

static void step_run(struct task *task, void *context)
{
    struct request *request = task->owner;
    uint64_t start_us = clock_now_us();
    request->step = FRAME_FAILED;
    request->wakes = render_thread_wakes(request->host->render_thread);
    if (has_begun(request) ||
        renderer_begin(context, &request->frame_work, &request->frame, &request->failure))
        request->step = renderer_step(context, request->model.asset->model->gpu,
                                      &request->frame_work, &request->frame, &request->failure);
    request->step_us = clock_now_us() - start_us;
    request->held_by_device = renderer_held(context);
}

/* Records that the device has the polygons of this frame. */
static void note_polygons(const struct request *request)
{
    const struct surface *surface = &request->frame_request.surface;
    struct asset *asset = request->model.asset;
    if (surface->kind == SURFACE_EXACT)
        return;
    if (asset->drawn_on != request->host->gpu_generation)
        asset->drawn_levels = 0;
    asset->drawn_on = request->host->gpu_generation;
    asset->drawn_levels |= 1u << surface->level;
}

/* --- programs: the device makes them */

static void continue_drawing(struct request *request)
{
    request_state_move(&request->state, REQUEST_QUEUED);
    scheduler_resume(&request->entry);
}

static void wait_for_programs(struct request *request)
{
    struct request_host *host = request->host;
    request_state_move(&request->state, REQUEST_PROGRAMS);
    LIST_INSERT_HEAD(&host->preparing, request, parked_link);
    /* The frame may have been told to continue before the loop knew that it waits. */
    if (request->wakes != render_thread_wakes(host->render_thread)) {
        LIST_REMOVE(request, parked_link);
        continue_drawing(request);
    }
}

static void wake_preparing(struct request_host *host)
{
    uint32_t wakes = render_thread_wakes(host->render_thread);
    if (wakes == host->wakes)
        return;
    host->wakes = wakes;
    while (!LIST_EMPTY(&host->preparing)) {
        struct request *request = LIST_FIRST(&host->preparing);
        LIST_REMOVE(request, parked_link);
        continue_drawing(request);
    }
}

static void step_done(struct task *task)
{
    struct request *request = task->owner;
    struct request_host *host = request->host;
    scheduler_stepped(&host->scheduler, &request->entry, request->step_us,
                      request->step == FRAME_MORE);
    memory_set_held(host->memory, &request->held_by_device);
    /* The device has the planes of an exact frame after its first tile. */
    if (request->step != FRAME_PROGRAMS &&
        (request->step != FRAME_MORE || request->frame_request.surface.kind == SURFACE_EXACT))
        memory_charge_drawn(request->charge);
    if (request->frame_work.has_drawn && request->step != FRAME_FAILED) {
        note_polygons(request);
        costs_learn(&host->costs, request->cost_key, next_tile_px(request), request->step_us);
        request->entry.estimate_us =
            costs_estimate(&host->costs, request->cost_key, next_tile_px(request));
    }
    if (request->state == REQUEST_ABANDONED)
        request_end(request);
    else if (request->step == FRAME_FAILED)
        request_fail(request, &request->failure);
    else if (request->step == FRAME_POLYGONS)
        start_polygons(request);
    else if (request->step == FRAME_PROGRAMS)
        wait_for_programs(request);
    else if (request->step == FRAME_DONE)
        frame_drawn(request);
    else
        request_state_move(&request->state, REQUEST_QUEUED);
}

/* --- starting */

static enum account_class account_class(const struct request *request)
{
    return request->entry.request_class == CLASS_INTERACTIVE ? ACCOUNT_INTERACTIVE
                                                             : ACCOUNT_PATIENT;
}

/* Charges the memory of a frame that is about to begin. False if it has to wait or has failed. */
static bool take_memory(struct request *request)
{
    struct request_host *host = request->host;
    if (request->charge)
        return true;
    const struct memory_frame frame = {request->frame_bytes,
                                       request_device_bytes(host, &request->render), "a frame"};
    switch (memory_charge_frame(host->memory, request->client->quota, request->asker,
                                account_class(request), &frame, &request->charge,
                                &request->failure)) {
    case MEMORY_CHARGED:
        return true;
    case MEMORY_LATER:
        scheduler_put_back(&host->scheduler, &request->entry);
        request_state_move(&request->state, REQUEST_PARKED);
        LIST_INSERT_HEAD(&host->parked, request, parked_link);
        break;
    case MEMORY_FAILED:
        scheduler_put_back(&host->scheduler, &request->entry);
        request_fail(request, &request->failure);
        break;
    }
    return false;
}

static void wake_parked(struct request_host *host)
{
    while (!LIST_EMPTY(&host->parked)) {
        struct request *request = LIST_FIRST(&host->parked);
        LIST_REMOVE(request, parked_link);
        request_state_move(&request->state, REQUEST_QUEUED);
        request->failure = (struct error){0};
        scheduler_ready(&request->entry);
    }
}

void request_start_next(struct request_host *host)
{
    wake_parked(host);
    wake_preparing(host);
    for (struct schedule_entry *entry; (entry = scheduler_next(&host->scheduler));) {
        struct request *request = entry->owner;
        if (request_is_late(request, clock_now_us())) {
            scheduler_put_back(&host->scheduler, entry);
            request_reply_late(request);
        } else if (take_memory(request)) {
            request_state_move(&request->state, REQUEST_DRAWING);
            request->task = (struct task){step_run, step_done, request, {NULL}};
            render_thread_submit(host->render_thread, &request->task);
        }
    }
    compute_start_next(host);
}
