/* The steps of a frame: each draws one tile. */
#include "server/base/clock.h"
#include "server/base/fault.h"
#include "server/render/native/frame/state.h"
#include "server/render/native/frame/kept.h"
#include "server/render/native/polygons/planes.h"
#include "server/render/native/frame/readback.h"
#include "server/render/native/stages.h"

/* A step draws this many triangles, which takes about as long as a tile of the exact surface. */
static const size_t TRIANGLES_A_STEP = (size_t)1 << 18;

static void destroy_state(struct frame_state *state)
{
    struct native_frame_state *own = (struct native_frame_state *)(void *)state;
    polygons_release(own->polygons);
    native_seen_finish(&own->seen);
    block_cache_give(own->block_cache, own);
}

bool native_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error)
{
    const struct frame_request *request = work->request;
    struct block_cache *block_cache = renderer->options.block_cache;
    struct native_frame_state *own = block_cache_take(block_cache, sizeof *own);
    if (!own)
        return error_set(error, ERROR_SERVER, "out of memory for a frame");
    *own = (struct native_frame_state){
        .base.destroy = destroy_state,
        .block_cache = block_cache,
        .serial = ++native_renderer_of(renderer)->n_begun,
        .tile = tiles_cut(request->width_px, request->height_px, work->tile_px, work->in_place)};
    work->state = &own->base;
    return true;
}

/* Adds the time of both stages, and the processors' time in each, from two clocks. */
static void add_times(struct frame_times *times, const struct native_times *parts, uint64_t all_us)
{
    uint64_t first = parts->choose_us + parts->quads_us + parts->raster_us + parts->sort_us;
    uint64_t both = first + parts->evaluate_us + parts->retry_us + parts->copy_us + parts->gaps_us;
    uint64_t visibility_us = both ? all_us * first / both : 0;
    times->visibility_us += visibility_us + 1; /* 0 means that the planes were there already */
    times->evaluate_us += all_us - visibility_us + 1;
}

/* Runs stages 1 and 2. */
static bool draw_surface(struct native_renderer *r, const struct native_drawing *d,
                         const struct view *view, struct frame *frame, struct error *error)
{
    struct native_times parts;
    uint64_t begin_us = clock_now_us();
    if (!native_target_reserve(d->target, d->place.width, d->place.height, error) ||
        !native_draw(r->device, d->shown->model, view, &d->place, &d->target->planes, &parts,
                     error))
        return false;
    add_times(&frame->times, &parts, clock_now_us() - begin_us);
    begin_us = clock_now_us();
    native_find_groups(d);
    bool ok = !request_has_coverage(d->request) || native_edges(d, error);
    frame->times.evaluate_us += clock_now_us() - begin_us;
    return ok;
}

static bool is_of_polygons(const struct frame_request *request)
{
    return request->surface.kind != SURFACE_EXACT;
}

/* Finds the frame's polygons, which the frame holds from now on. False if the device has none. */
static bool find_polygons(struct native_renderer *r, struct native_frame_state *own,
                          const struct native_shown *shown, const struct frame_work *work)
{
    uint32_t level = work->request->surface.level;
    if (own->polygons || (!work->polygons && fault_at("gpu.polygons")))
        return own->polygons;
    own->polygons = native_meshes_find(&r->meshes, shown->serial, level);
    if (!own->polygons && work->polygons) {
        native_meshes_keep(&r->meshes, shown->serial, level, work->polygons);
        own->polygons = native_meshes_find(&r->meshes, shown->serial, level);
    }
    return own->polygons;
}

/* Runs stages 1 and 2 of polygons as far as one step may draw. *is_whole: the whole tile is drawn. If drawing took
 * several steps, the planes take one more. */
static bool draw_polygons(struct native_renderer *r, struct native_frame_state *own,
                          const struct native_drawing *d, const struct view *view,
                          struct frame *frame, bool *is_whole, struct error *error)
{
    const struct mesh *mesh = &own->polygons->mesh;
    uint64_t begin_us = clock_now_us();
    bool is_first = own->part == 0, is_drawn = own->part == mesh->n_parts && !is_first;
    size_t most = r->base.options.slice ? r->base.options.slice : TRIANGLES_A_STEP;
    if (!is_drawn && !native_polygons_fill(&r->polygons, r->device, mesh, view, &d->place,
                                           &own->seen, &own->part, most, error))
        return false;
    *is_whole = is_drawn || (is_first && own->part == mesh->n_parts);
    if (*is_whole) {
        own->part = 0;
        if (!native_target_reserve(d->target, d->place.width, d->place.height, error))
            return false;
        native_polygon_planes(d, view, mesh, &own->seen);
    }
    frame->times.visibility_us += clock_now_us() - begin_us;
    return true;
}

/* *is_whole: the frame holds the finished tile; otherwise more of it remains to be drawn. */
static bool draw_tile(struct native_renderer *r, struct native_frame_state *own,
                      const struct native_drawing *d, const struct view *view,
                      const struct frame_watch *watch, bool is_kept_view, struct frame *frame,
                      bool *is_whole, struct error *error)
{
    const struct frame_request *request = d->request;
    *is_whole = true;
    if (!is_kept_view &&
        !(is_of_polygons(request) ? draw_polygons(r, own, d, view, frame, is_whole, error)
                                  : draw_surface(r, d, view, frame, error)))
        return false;
    if (!*is_whole)
        return true;
    uint64_t begin_us = clock_now_us();
    if (!native_target_reserve_shading(d->target, request, error) ||
        !native_shade(d, watch, frame, error))
        return false;
    if (request->surface.kind == SURFACE_WIREFRAME)
        native_polygon_edges(d, view, &own->polygons->mesh);
    uint64_t shaded_us = clock_now_us();
    frame->times.shade_us += shaded_us - begin_us;
    frame->shows_surface = frame->shows_surface || native_any_seen(d->target);
    native_readback(d, view, frame);
    frame->times.readback_us += clock_now_us() - shaded_us;
    return true;
}

enum frame_step native_frame_step(struct renderer *renderer, struct renderer_model *model,
                                  struct frame_work *work, struct frame *frame, struct error *error)
{
    struct native_renderer *r = native_renderer_of(renderer);
    struct native_frame_state *own = (struct native_frame_state *)(void *)work->state;
    const struct native_shown *shown = (const struct native_shown *)(const void *)model;
    const struct frame_request *request = work->request;
    if (is_of_polygons(request) && !find_polygons(r, own, shown, work))
        return FRAME_POLYGONS;
    bool is_kept_view, is_whole;
    struct native_view_planes *planes = native_planes_choose(r, own, shown, work, &is_kept_view);
    const struct view_part part = view_part_of(request);
    const struct tile of_frame =
        tile_at(own->x, own->y, &own->tile, request->width_px, request->height_px);
    const struct tile tile = view_tile(&part, &of_frame);
    struct native_drawing drawing = {
        .device = r->device, .target = &planes->target, .shown = shown, .request = request};
    drawing.place = tile_with_margin(&tile, true, part.picture.width, part.picture.height);
    drawing.inside = tile_within(&tile, &drawing.place);
    struct view view;
    view_init(&view, &request->camera, request->width_px, request->height_px,
              model->tables->hull_min, model->tables->hull_max);
    drawing.exact_view = &view;
    view_block_fill(&drawing.view, &view, &drawing.place);
    if (!is_kept_view)
        planes->kept.model_serial = 0;
    work->has_drawn = true;
    if (!frame_watch_check(&work->watch, error) ||
        !draw_tile(r, own, &drawing, &view, &work->watch, is_kept_view, frame, &is_whole, error))
        return FRAME_FAILED;
    if (!is_whole)
        return FRAME_MORE;
    if (!is_kept_view && !native_planes_keep(r, own, planes, &drawing, work, error))
        return FRAME_FAILED;
    own->x += own->tile.width;
    if (own->x >= request->width_px) {
        own->x = 0;
        own->y += own->tile.height;
    }
    return own->y < request->height_px ? FRAME_MORE : FRAME_DONE;
}
