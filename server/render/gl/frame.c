#include "server/render/gl/frame.h"

#include "server/base/fault.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/stage_clock.h"
#include "server/render/gl/shade.h"
#include "server/render/gl/edges.h"
#include "server/render/gl/evaluate.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/visibility.h"
#include "server/render/gl/kept.h"
#include "server/render/gl/frame_state.h"
#include "server/render/gl/paused_tiles.h"
#include "server/render/gl/polygon_slices.h"
#include "server/render/gl/polygon_meshes.h"
#include "server/render/gl/light_image.h"
#include "server/render/gl/model.h"
#include "server/render/gl/readback.h"

/* Runs stages 1 and 2, unless the target already holds their planes. Margins are evaluated too;
 * later stages leave out the margins that are not shaded. */
static bool draw_surface(struct gl_renderer *r, const struct gl_model *model,
                         const struct frame_request *request, const struct view *view,
                         struct frame *frame, struct error *error)
{
    const struct tile *drawn = &r->drawing.drawn, *shaded = &r->drawing.shaded;
    const struct tile at = tile_within(drawn, &r->drawing.place);
    const struct tile cut = tile_within(shaded, &r->drawing.place);
    if (kept_view_serves(&r->kept, model->serial, request))
        return true;
    if (!patch_grids_choose(&r->grids, model->base.tables, &model->clusters, view, drawn, error))
        return false;
    patch_grids_move_blocks(&r->grids, at.x / COVER_BLOCK_PX, at.y / COVER_BLOCK_PX);
    const struct table_programs found =
        gl_model_find_programs(r, model, request->planes & PLANE_PTEX);
    const struct table_programs *programs = &found;
    stage_clock_start(r);
    stage_visibility(r, model, programs);
    stage_gather(r);
    if (!stage_clock_end(r, &frame->times.visibility_us))
        return false;
    stage_clock_start(r);
    stage_evaluate(r, model, programs);
    if (!stage_gaps(r, model, programs, view, error))
        return false;
    if (request_has_coverage(request)) {
        stage_edges(r, &cut);
        stage_ends(r, model, programs);
        stage_edges_recheck(r);
        stage_rounded(r, model, programs);
    }
    if (!tile_is_same(drawn, shaded)) {
        patch_grids_cut_blocks(&r->grids, &cut);
        stage_gather(r);
    }
    return stage_clock_end(r, &frame->times.evaluate_us);
}

/* Runs the three stages of the exact surface. */
static bool draw_exact(struct gl_renderer *r, const struct gl_model *model,
                       const struct frame_request *request, const struct view *view,
                       struct frame *frame, struct error *error)
{
    if (!draw_surface(r, model, request, view, frame, error))
        return false;
    stage_clock_start(r);
    return stage_shade(r, request, error) && stage_clock_end(r, &frame->times.shade_us) &&
           stage_clock_read(r);
}

static bool is_of_polygons(const struct frame_request *request)
{
    return request->surface.kind != SURFACE_EXACT;
}

/* *is_whole: set when the frame holds the finished tile. */
static bool render_tile(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                        const struct view *view, const struct tile *tile, struct frame *frame,
                        bool *is_whole, struct error *error)
{
    const struct frame_request *request = own->work->request;
    const struct tile *place = &r->drawing.place;
    struct view_block block;
    view_block_fill(&block, view, place);
    glNamedBufferSubData(r->view_buffer, 0, sizeof block, &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, r->view_buffer);
    r->inside = tile_within(tile, place);
    stage_clock_begin(r);
    *is_whole = true;
    bool ok = is_of_polygons(request)
                  ? draw_polygons(r, model, own, view, place, frame, is_whole, error)
                  : draw_exact(r, model, request, view, frame, error);
    if (!ok || !*is_whole)
        return ok;
    if (!readback(r, request, view, place, tile, frame, error))
        return false;
    bool any_seen = gather_found_any(r);
    frame->shows_surface = frame->shows_surface || any_seen;
    shade_read_share(r, request, any_seen, frame);
    return stage_clock_wait(r, &frame->times.readback_us);
}

static void cut_frame(struct gl_frame *own)
{
    const struct frame_request *request = own->work->request;
    own->tile =
        tiles_cut(request->width_px, request->height_px, own->work->tile_px, own->work->in_place);
}

/* A frame in several tiles in place has a target for all of them beside the lists of a tile. */
uint64_t gl_frame_bytes(const struct renderer_frame_size *size)
{
    const struct tile_size tile =
        tiles_cut(size->width_px, size->height_px, size->tile_px, size->in_place);
    if (tile.width == size->width_px && tile.height == size->height_px)
        return target_bytes(tile.width, tile.height);
    const struct tile_size drawn = tile_size_with_margin(&tile, size->width_px, size->height_px);
    return target_bytes(drawn.width, drawn.height) +
           (size->in_place ? target_bytes(size->width_px, size->height_px) : 0);
}

uint64_t gl_paused_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px)
{
    const struct tile_size tile = tiles_cut(width_px, height_px, tile_px, false);
    const struct tile_size drawn = tile_size_with_margin(&tile, width_px, height_px);
    return target_bytes(drawn.width, drawn.height);
}

static bool is_single(const struct gl_frame *own)
{
    return own->tile.width == own->work->request->width_px &&
           own->tile.height == own->work->request->height_px;
}

/* Returns the next tile of the picture, in the chosen planes, and which part of it must be drawn. If the tiles
 * before it are in the same planes, they are its margin; the part that those evaluated as their own
 * margin is evaluated again. */
static struct tile place_tile(struct gl_renderer *r, const struct gl_frame *own)
{
    const struct frame_request *request = own->work->request;
    const struct view_part part = view_part_of(request);
    const struct tile whole = {0, 0, part.picture.width, part.picture.height};
    const struct tile of_frame =
        tile_at(own->x, own->y, &own->tile, request->width_px, request->height_px);
    const struct tile tile = view_tile(&part, &of_frame);
    bool in_place = r->in_use == PLANES_TILED, goes_on = in_place && r->collecting.frame;
    const struct tile drawn = tile_with_margin(&tile, !goes_on, whole.width, whole.height);
    r->drawing = (struct drawing){in_place ? whole : drawn, drawn, in_place ? tile : drawn};
    return tile;
}

/* Makes sure that the device has memory for the tile. */
static bool reserve(struct gl_renderer *r, const struct gl_frame *own, struct error *error)
{
    const struct tile *place = &r->drawing.place, *drawn = &r->drawing.drawn;
    struct target *lists = &r->resting[PLANES_APART].target;
    if (place->width > r->target.width || place->height > r->target.height)
        r->kept.model_serial = 0;
    if (!target_reserve(&r->target, place->width, place->height, error) ||
        (own->work->request->n_lights > 1 && !target_reserve_lights(&r->target, error)))
        return false;
    if (is_of_polygons(own->work->request))
        return true;
    return target_reserve_rounded(&r->target, error) &&
           (r->in_use != PLANES_TILED || is_single(own) ||
            (target_reserve(lists, drawn->width, drawn->height, error) &&
             target_reserve_rounded(lists, error)));
}

/* Draws one of several tiles that share the target. Each tile has its own lists of pixels. */
static bool render_in_place(struct gl_renderer *r, const struct gl_model *model,
                            struct gl_frame *own, const struct view *view, const struct tile *tile,
                            struct frame *frame, struct error *error)
{
    const struct frame_request *request = own->work->request;
    struct target *lists = &r->resting[PLANES_APART].target;
    bool is_whole, is_last = tile->x + tile->width == request->width_px &&
                             tile->y + tile->height == request->height_px;
    target_swap_lists(&r->target, lists);
    bool ok = render_tile(r, model, own, view, tile, frame, &is_whole, error);
    target_swap_lists(&r->target, lists);
    if (ok)
        collect_tile(r, request_has_coverage(request));
    if (ok && is_last)
        collect_end(r, model, request);
    return ok;
}

static void destroy_state(struct frame_state *state)
{
    struct gl_frame *own = (struct gl_frame *)(void *)state;
    tile_give_back(own);
    program_hold_end(&own->hold);
    block_cache_give(own->block_cache, own);
}

bool gl_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_frame *own = block_cache_take(r->base.options.block_cache, sizeof *own);
    if (!own)
        return error_set(error, ERROR_SERVER, "out of memory for a frame");
    *own = (struct gl_frame){.base.destroy = destroy_state,
                             .block_cache = r->base.options.block_cache,
                             .work = work,
                             .serial = ++r->n_begun};
    work->state = &own->base;
    work->in_place = work->in_place && target_can_hold(&r->base.info, work->request);
    cut_frame(own);
    return true;
}

/* Uploads the model and the images that are not on the device, because they are new or the device
 * was lost. */
static bool upload_all(struct gl_renderer *r, struct gl_model *model,
                       const struct frame_request *request, struct error *error)
{
    bool ok = gl_model_upload(r, model, error);
    for (uint32_t i = 0; ok && i < request->n_lights; i++) {
        struct gl_image *image = gl_image_of(request->lights[i].pattern.image);
        ok = !image || gl_image_upload(r, image, error);
    }
    return ok;
}

/* Holds the programs that the frame needs. */
static enum hold_state hold_programs(struct gl_renderer *r, const struct gl_model *model,
                                     struct gl_frame *own, struct error *error)
{
    const struct frame_request *request = own->work->request;
    struct program_id ids[MAX_FRAME_PROGRAMS];
    int n = 0;
    if (is_of_polygons(request)) {
        ids[n++] = (struct program_id){.set = SET_SINGLE, .which = PROGRAM_POLYGONS};
        ids[n++] = (struct program_id){.set = SET_SINGLE, .which = PROGRAM_WIREFRAME};
    } else {
        gl_model_programs(r, model, request->planes & PLANE_PTEX, ids);
        n = TABLE_PROGRAMS;
    }
    n += stage_shade_programs(request, ids + n);
    for (;;) {
        enum hold_state state =
            kept_programs_hold(r->programs, &own->hold, ids, n, own->work->asker, error);
        if (state != HOLD_WAITS || r->base.options.woken)
            return state;
        kept_programs_wait(r->programs);
    }
}

/* *has_drawn: false if the step only ran a program for the first time.
 * *is_whole: the frame now holds the tile. */
static bool step(struct gl_renderer *r, struct gl_model *model, struct gl_frame *own,
                 struct frame *frame, bool *has_drawn, bool *is_whole, struct error *error)
{
    const struct frame_work *work = own->work;
    const struct frame_request *request = work->request;
    struct view view;
    if (own->x == 0 && own->y == 0)
        cut_frame(own);
    planes_choose(r, model, own);
    bool in_place = r->in_use == PLANES_TILED && !is_single(own);
    if (in_place)
        collect_begin(r, own);
    const struct tile tile = place_tile(r, own);
    if (is_of_polygons(request))
        tile_resume(r, own);
    r->watch = work->watch;
    r->made = work->polygons;
    view_init(&view, &request->camera, request->width_px, request->height_px,
              model->base.tables->hull_min, model->base.tables->hull_max);
    bool ok = frame_watch_check(&work->watch, error) && reserve(r, own, error);
    if (ok)
        stage_shade_first_run(r, request, has_drawn);
    if (ok && !*has_drawn)
        return !own->paused || tile_pause(r, model, own, error);
    *is_whole = true;
    ok = ok && (in_place ? render_in_place(r, model, own, &view, &tile, frame, error)
                         : render_tile(r, model, own, &view, &tile, frame, is_whole, error));
    if (ok && *is_whole && is_single(own))
        planes_keep(r, model, request);
    else if (!ok || !in_place)
        r->kept.model_serial = 0;
    if (ok && !*is_whole)
        return tile_pause(r, model, own, error);
    tile_give_back(own);
    return ok;
}

enum frame_step gl_frame_step(struct renderer *renderer, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_model *shown = gl_model_of(model);
    struct gl_frame *own = gl_frame_of(work);
    bool ready = !r->context.is_lost;
    own->work = work;
    if (ready && is_of_polygons(work->request) && !work->polygons &&
        (fault_at("gpu.polygons") ||
         !polygons_have(&r->meshes, shown->serial, work->request->surface.level)))
        return FRAME_POLYGONS;
    bool is_whole = false;
    enum hold_state held = HOLD_FAILED;
    if (ready && upload_all(r, shown, work->request, error))
        held = hold_programs(r, shown, own, error);
    if (held == HOLD_WAITS)
        return FRAME_PROGRAMS;
    if (held == HOLD_FAILED || !step(r, shown, own, frame, &work->has_drawn, &is_whole, error)) {
        /* If the device is lost, that is the error to report, whatever else failed. */
        if (context_check_lost(&r->context))
            error_set(error, ERROR_GPU_LOST,
                      "the GPU was lost while it drew this frame: ask again");
        return FRAME_FAILED;
    }
    if (work->has_drawn)
        program_hold_end(&own->hold);
    if (!is_whole)
        return FRAME_MORE;
    own->x += own->tile.width;
    if (own->x >= work->request->width_px) {
        own->x = 0;
        own->y += own->tile.height;
    }
    return own->y < work->request->height_px ? FRAME_MORE : FRAME_DONE;
}
