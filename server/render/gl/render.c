/* One frame: tiles, and the three stages of each. */
#include "server/render/gl/gpu.h"

#include "server/base/fault.h"
#include "server/scene/request_check.h"

/* Stages 1 and 2, unless the target holds their planes already. Margins are evaluated, and then no
 * more is asked of them where they are not shaded. */
static bool draw_surface(struct renderer *r, const struct renderer_model *model,
                         const struct frame_request *request, const struct view *view,
                         struct frame *frame, struct error *error)
{
    const struct tile *drawn = &r->drawing.drawn, *shaded = &r->drawing.shaded;
    const struct tile at = tile_within(drawn, &r->drawing.place);
    const struct tile cut = tile_within(shaded, &r->drawing.place);
    if (is_kept(&r->kept, model, request))
        return true;
    if (!pieces_choose(&r->pieces, model->tables, &model->clusters, view, drawn, error))
        return false;
    pieces_move_blocks(&r->pieces, at.x / COVER_BLOCK_PX, at.y / COVER_BLOCK_PX);
    const struct table_programs *programs =
        programs_for(r, model, request->planes & PLANE_PTEX, error);
    if (!programs)
        return false;
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
        stage_silhouette(r, model, programs);
        stage_edges_doubt(r);
        stage_rounded(r, model, programs);
    }
    if (!tile_is_same(drawn, shaded)) {
        pieces_cut_blocks(&r->pieces, &cut);
        stage_gather(r);
    }
    return stage_clock_end(r, &frame->times.evaluate_us);
}

/* The three stages of the exact surface. */
static bool draw_exact(struct renderer *r, const struct renderer_model *model,
                       const struct frame_request *request, const struct view *view,
                       struct frame *frame, struct error *error)
{
    if (!draw_surface(r, model, request, view, frame, error))
        return false;
    stage_clock_start(r);
    return stage_shade(r, request, error) && stage_clock_end(r, &frame->times.shade_us) &&
           stage_clock_read(r);
}

static bool is_of_polygons(const struct frame_work *work)
{
    return work->request->surface.kind != SURFACE_EXACT;
}

/* *is_whole: the frame has it. */
static bool render_tile(struct renderer *r, const struct renderer_model *model,
                        struct frame_work *work, const struct view *view, const struct tile *tile,
                        struct frame *frame, bool *is_whole, struct error *error)
{
    const struct frame_request *request = work->request;
    const struct tile *place = &r->drawing.place;
    struct view_block block;
    view_block_fill(&block, view, place);
    glNamedBufferSubData(r->view_buffer, 0, sizeof block, &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, r->view_buffer);
    r->inside = tile_within(tile, place);
    stage_clock_begin(r);
    *is_whole = true;
    bool ok = is_of_polygons(work)
                  ? draw_polygons(r, model, work, view, place, frame, is_whole, error)
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

static void cut_frame(struct frame_work *work)
{
    const struct frame_request *request = work->request;
    const struct tile_size size =
        tiles_cut(request->width_px, request->height_px, work->tile_px, work->in_place);
    work->tile_width = size.width;
    work->tile_height = size.height;
}

uint64_t renderer_canvas_bytes(uint32_t width_px, uint32_t height_px, uint64_t tile_px)
{
    const struct tile_size tile = tiles_cut(width_px, height_px, tile_px, false);
    const struct tile_size drawn = tile_size_with_margin(&tile, width_px, height_px);
    return target_bytes(drawn.width, drawn.height);
}

static bool is_single(const struct frame_work *work)
{
    return work->tile_width == work->request->width_px &&
           work->tile_height == work->request->height_px;
}

/* The next tile, in planes that have been chosen, and what must be drawn for it. Where the tiles
 * before stand in the same planes they are its margin; what they have evaluated of it as their
 * margin is done anew. */
static struct tile place_tile(struct renderer *r, const struct frame_work *work)
{
    const struct frame_request *request = work->request;
    const struct tile_size size = {work->tile_width, work->tile_height};
    const struct tile whole = {0, 0, request->width_px, request->height_px};
    const struct tile tile = tile_at(work->x, work->y, &size, whole.width, whole.height);
    bool in_place = r->in_use == PLANES_TILED, goes_on = in_place && r->collecting.frame;
    const struct tile drawn = tile_with_margin(&tile, !goes_on, whole.width, whole.height);
    r->drawing = (struct drawing){in_place ? whole : drawn, drawn, in_place ? tile : drawn};
    return tile;
}

/* Memory for the tile. */
static bool reserve(struct renderer *r, const struct frame_work *work, struct error *error)
{
    const struct tile *place = &r->drawing.place, *drawn = &r->drawing.drawn;
    struct target *lists = &r->resting[PLANES_APART].target;
    if (place->width > r->target.width || place->height > r->target.height)
        r->kept.model_serial = 0;
    if (!target_reserve(&r->target, place->width, place->height, error) ||
        (work->request->n_lights > 1 && !target_reserve_lights(&r->target, error)))
        return false;
    if (is_of_polygons(work))
        return true;
    return target_reserve_rounded(&r->target, error) &&
           (r->in_use != PLANES_TILED || is_single(work) ||
            (target_reserve(lists, drawn->width, drawn->height, error) &&
             target_reserve_rounded(lists, error)));
}

/* A tile of several that stand in the target together, with lists of its own. */
static bool render_in_place(struct renderer *r, const struct renderer_model *model,
                            struct frame_work *work, const struct view *view,
                            const struct tile *tile, struct frame *frame, struct error *error)
{
    const struct frame_request *request = work->request;
    struct target *lists = &r->resting[PLANES_APART].target;
    bool is_whole, is_last = tile->x + tile->width == request->width_px &&
                             tile->y + tile->height == request->height_px;
    target_swap_lists(&r->target, lists);
    bool ok = render_tile(r, model, work, view, tile, frame, &is_whole, error);
    target_swap_lists(&r->target, lists);
    if (ok)
        collect_tile(r, request_has_coverage(request));
    if (ok && is_last)
        collect_end(r, model, request);
    return ok;
}

bool renderer_begin(struct renderer *r, struct frame_work *work, struct frame *frame,
                    struct error *error)
{
    *frame = (struct frame){0};
    work->x = work->y = work->n_programs = 0;
    work->canvas = NULL;
    if (!request_check(work->request, r->info.max_width_px, r->info.max_height_px, error) ||
        !frame_init(frame, work->request, r->options.block_cache, error))
        return false;
    work->serial = ++r->n_begun;
    work->in_place = work->in_place && target_can_hold(&r->info, work->request);
    cut_frame(work);
    return true;
}

/* All that the frame shows, where it is not on the device: new, or the device was lost. */
static bool upload_all(struct renderer *r, struct renderer_model *model,
                       const struct frame_request *request, struct error *error)
{
    bool ok = model_upload(r, model, error);
    for (uint32_t i = 0; ok && i < request->n_lights; i++) {
        struct renderer_image *image = request->lights[i].pattern.image;
        ok = !image || image_upload(r, image, error);
    }
    return ok;
}

/* Makes one of the programs that the next tile takes, where one is not there. Frames that take
 * turns may take each other's away: one that has made as many as it can need gets all at once. */
static bool prepare(struct renderer *r, struct frame_work *work, bool *is_ready,
                    struct error *error)
{
    bool ok;
    do {
        ok = stage_shade_prepare(r, work->request, is_ready, error);
        work->n_programs += !*is_ready;
    } while (ok && !*is_ready && work->n_programs > MAX_FRAME_PROGRAMS);
    return ok;
}

/* *next: FRAME_DONE where the tile is whole now. */
static bool step(struct renderer *r, struct renderer_model *model, struct frame_work *work,
                 struct frame *frame, enum frame_step *next, struct error *error)
{
    const struct frame_request *request = work->request;
    struct view view;
    bool is_ready = false, is_whole = true;
    if (!upload_all(r, model, request, error))
        return false;
    if (work->x == 0 && work->y == 0)
        cut_frame(work);
    planes_choose(r, model, work);
    bool in_place = r->in_use == PLANES_TILED && !is_single(work);
    if (in_place)
        collect_begin(r, work);
    const struct tile tile = place_tile(r, work);
    if (is_of_polygons(work))
        canvas_resume(r, work);
    r->watch = work->watch;
    r->made = work->polygons;
    view_init(&view, &request->camera, request->width_px, request->height_px,
              model->tables->hull_min, model->tables->hull_max);
    bool ok = frame_watch_check(&work->watch, error) && reserve(r, work, error) &&
              prepare(r, work, &is_ready, error);
    *next = FRAME_PROGRAM;
    if (ok && !is_ready)
        return !work->canvas || canvas_set_aside(r, model, work, error);
    ok = ok && (in_place ? render_in_place(r, model, work, &view, &tile, frame, error)
                         : render_tile(r, model, work, &view, &tile, frame, &is_whole, error));
    *next = is_whole ? FRAME_DONE : FRAME_MORE;
    if (ok && is_whole && is_single(work))
        planes_keep(r, model, request);
    else if (!ok || !in_place)
        r->kept.model_serial = 0;
    if (ok && !is_whole)
        return canvas_set_aside(r, model, work, error);
    canvas_give_back(work);
    return ok;
}

enum frame_step renderer_step(struct renderer *r, struct renderer_model *model,
                              struct frame_work *work, struct frame *frame, struct error *error)
{
    bool ready = renderer_ready(r, error);
    enum frame_step next;
    if (ready && is_of_polygons(work) && !work->polygons &&
        (fault_at("gpu.polygons") ||
         !polygons_have(&r->polygons, model->serial, work->request->surface.level)))
        return FRAME_POLYGONS;
    if (!ready || !step(r, model, work, frame, &next, error)) {
        /* Whatever failed then, this is why. */
        if (renderer_check_lost(r))
            error_set(error, ERROR_GPU_LOST,
                      "the GPU was lost while it drew this frame: ask again");
        canvas_give_back(work);
        frame_finish(frame);
        return FRAME_FAILED;
    }
    if (next != FRAME_DONE) /* the tile is not whole */
        return next;
    work->x += work->tile_width;
    if (work->x >= work->request->width_px) {
        work->x = 0;
        work->y += work->tile_height;
    }
    return work->y < work->request->height_px ? FRAME_MORE : FRAME_DONE;
}

void frame_work_finish(struct frame_work *work)
{
    canvas_give_back(work);
}

bool renderer_render(struct renderer *r, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error)
{
    struct frame_work work = {.request = request};
    struct renderer_polygons *polygons = NULL;
    if (!renderer_begin(r, &work, frame, error))
        return false;
    enum frame_step next;
    do {
        next = renderer_step(r, model, &work, frame, error);
        if (next == FRAME_POLYGONS) {
            work.polygons = polygons =
                renderer_polygons_create(model->tables, request->surface.level, &work.watch, error);
            next = polygons ? FRAME_MORE : FRAME_FAILED;
        }
    } while (next == FRAME_MORE || next == FRAME_PROGRAM);
    if (next == FRAME_FAILED) {
        frame_work_finish(&work);
        frame_finish(frame);
    }
    renderer_polygons_destroy(polygons);
    return next == FRAME_DONE;
}
