/* One frame: tiles, the three stages of each, and what is kept for a light-only change. */
#include "server/gpu/gpu.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Larger frames are drawn in tiles: about 80 bytes a pixel live on the device. */
enum { TILE_MAX_PX = 4096 };

static uint64_t now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000u + (uint64_t)t.tv_nsec / 1000u;
}

/* Waits for the device and adds what passed since *since to *stage. */
static void end_stage(uint64_t *stage, uint64_t *since)
{
    glFinish();
    uint64_t now = now_us();
    *stage += now - *since;
    *since = now;
}

static bool same_camera(const struct camera *a, const struct camera *b)
{
    return a->kind == b->kind && !memcmp(a->eye, b->eye, sizeof a->eye) &&
           !memcmp(a->target, b->target, sizeof a->target) && !memcmp(a->up, b->up, sizeof a->up) &&
           a->fov_deg == b->fov_deg && a->ortho_height == b->ortho_height;
}

/* Whether the target's planes are those of this view already. */
static bool is_kept(const struct kept *kept, const struct renderer_model *model,
                    const struct frame_request *request)
{
    return kept->model_serial == model->serial && kept->width_px == request->width_px &&
           kept->height_px == request->height_px && same_camera(&kept->camera, &request->camera) &&
           kept->surface.kind == request->surface.kind &&
           kept->surface.level == request->surface.level &&
           (kept->ptex || !(request->planes & PLANE_PTEX)) &&
           (kept->edges || !edges_wanted(request));
}

static bool frame_init(struct frame *frame, const struct frame_request *request,
                       struct error *error)
{
    *frame = (struct frame){.width_px = request->width_px, .height_px = request->height_px};
    size_t pixels = (size_t)request->width_px * request->height_px;
    for (int p = 0; p < PLANE_COUNT; p++) {
        if (!(request->planes & 1u << p))
            continue;
        size_t bytes = pixels * renderer_plane_bytes((enum renderer_plane)(1 << p));
        frame->plane[p] = malloc(bytes);
        if (!frame->plane[p]) {
            frame_finish(frame);
            return error_set(error, ERROR_SERVER,
                             "out of memory: a plane of a %ux%u frame needs %zu bytes",
                             request->width_px, request->height_px, bytes);
        }
    }
    return true;
}

static bool render_tile(struct renderer *r, const struct renderer_model *model,
                        const struct frame_request *request, const struct view *view,
                        const struct tile *tile, struct frame *frame, struct error *error)
{
    struct view_block block;
    view_block_fill(&block, view, tile);
    glNamedBufferSubData(r->view_buffer, 0, sizeof block, &block);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, r->view_buffer);
    uint64_t since = now_us();
    bool exact = request->surface.kind == SURFACE_EXACT;
    if (!is_kept(&r->kept, model, request) && !exact) {
        if (!stage_polygons(r, model, request, tile, error))
            return false;
        stage_gather(r);
        end_stage(&frame->times.visibility_us, &since);
    } else if (!is_kept(&r->kept, model, request)) {
        if (!pieces_choose(&r->pieces, model->tables, view, tile, error))
            return false;
        stage_visibility(r, model, tile);
        stage_gather(r);
        end_stage(&frame->times.visibility_us, &since);
        stage_evaluate(r, model, request->planes & PLANE_PTEX);
        if (edges_wanted(request))
            stage_edges(r);
        end_stage(&frame->times.evaluate_us, &since);
    }
    if (!stage_shade(r, request, error))
        return false;
    if (request->surface.kind == SURFACE_WIREFRAME &&
        !stage_wireframe(r, model, request, tile, error))
        return false;
    end_stage(&frame->times.shade_us, &since);
    bool ok = readback(r, request, tile, frame, error);
    end_stage(&frame->times.readback_us, &since);
    return ok;
}

bool renderer_render(struct renderer *r, struct renderer_model *model,
                     const struct frame_request *request, struct frame *frame, struct error *error)
{
    *frame = (struct frame){0};
    if (!request_check(&r->info, request, error) || !frame_init(frame, request, error))
        return false;
    uint32_t width = request->width_px < TILE_MAX_PX ? request->width_px : TILE_MAX_PX;
    uint32_t height = request->height_px < TILE_MAX_PX ? request->height_px : TILE_MAX_PX;
    if (width > r->target.width || height > r->target.height)
        r->kept.model_serial = 0;
    if (!target_reserve(&r->target, width, height, error))
        goto fail;
    struct view view;
    view_init(&view, &request->camera, request->width_px, request->height_px,
              model->tables->hull_min, model->tables->hull_max);
    for (uint32_t y = 0; y < request->height_px; y += TILE_MAX_PX) {
        for (uint32_t x = 0; x < request->width_px; x += TILE_MAX_PX) {
            struct tile tile = {x, y, request->width_px - x, request->height_px - y};
            tile.width = tile.width < TILE_MAX_PX ? tile.width : TILE_MAX_PX;
            tile.height = tile.height < TILE_MAX_PX ? tile.height : TILE_MAX_PX;
            if (!render_tile(r, model, request, &view, &tile, frame, error))
                goto fail;
        }
    }
    bool single = request->width_px <= TILE_MAX_PX && request->height_px <= TILE_MAX_PX;
    bool still_kept = is_kept(&r->kept, model, request) && r->kept.ptex;
    bool edges = edges_wanted(request) || (is_kept(&r->kept, model, request) && r->kept.edges);
    bool drawn = request->surface.kind != SURFACE_EXACT; /* polygons always write ptex */
    bool ptex = request->planes & PLANE_PTEX || still_kept || drawn;
    r->kept = (struct kept){single ? model->serial : 0,
                            request->width_px,
                            request->height_px,
                            request->camera,
                            request->surface,
                            ptex,
                            edges};
    return true;

fail:
    r->kept.model_serial = 0;
    frame_finish(frame);
    return false;
}
