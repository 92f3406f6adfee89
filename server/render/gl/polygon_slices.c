#include "server/render/gl/polygon_slices.h"

#include <stdlib.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/stage_clock.h"
#include "server/render/gl/shade.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/polygon_meshes.h"
#include "server/render/gl/polygon.h"
#include "server/render/gl/kept.h"
#include "server/render/gl/frame_state.h"
#include "server/render/gl/model.h"
#include "server/render/gl/context/quirks.h"

/* How much one step draws, and how much it uploads. On a software device a step takes no longer
 * than a tile of the exact surface (server/frame/request_frame.c). On hardware the aim is the same;
 * that has not been measured. */
static const size_t SOFTWARE_TRIANGLES = 65536, HARDWARE_TRIANGLES = (size_t)1 << 21;
static const size_t SOFTWARE_BYTES = (size_t)4 << 20, HARDWARE_BYTES = (size_t)32 << 20;

static size_t triangles_a_step(const struct gl_renderer *r)
{
    return r->base.options.slice   ? r->base.options.slice
           : r->base.info.software ? SOFTWARE_TRIANGLES
                                   : HARDWARE_TRIANGLES;
}

static size_t bytes_a_step(const struct gl_renderer *r)
{
    enum { BYTES_A_TRIANGLE = 28 }; /* in a fine mesh: half a vertex and three indices */
    return r->base.options.slice   ? r->base.options.slice * BYTES_A_TRIANGLE
           : r->base.info.software ? SOFTWARE_BYTES
                                   : HARDWARE_BYTES;
}

static bool fill(struct gl_renderer *r, struct gl_frame *own, struct slice *slice,
                 struct error *error)
{
    slice->part = own->part;
    if (own->part == 0) {
        r->kept.model_serial = 0;
        if (!stage_polygons_begin(r, slice->tile, error))
            return false;
    }
    if (!stage_polygons(r, slice, error))
        return false;
    own->part = slice->part;
    if (own->part < slice->mesh->n_parts)
        return true;
    own->stage = TILE_SHADE;
    if (!patch_grids_cover_all(&r->grids, slice->tile, error))
        return false;
    stage_gather(r);
    return true;
}

static bool shade(struct gl_renderer *r, struct gl_frame *own, struct error *error)
{
    own->stage = own->work->request->surface.kind == SURFACE_WIREFRAME ? TILE_EDGES : TILE_WHOLE;
    own->part = 0;
    return stage_shade(r, own->work->request, error);
}

static bool draw_edges(struct gl_renderer *r, struct gl_frame *own, struct slice *slice,
                       struct error *error)
{
    slice->part = own->part;
    if (!stage_wireframe(r, slice, error))
        return false;
    own->part = slice->part;
    if (own->part == slice->mesh->n_parts)
        own->stage = TILE_WHOLE;
    return true;
}

/* Draws one stage, or a slice of it. */
static bool draw_stage(struct gl_renderer *r, struct gl_frame *own, struct slice *slice,
                       struct frame *frame, struct error *error)
{
    bool fills = own->stage == TILE_FILL;
    stage_clock_start(r);
    bool ok = fills                      ? fill(r, own, slice, error)
              : own->stage == TILE_SHADE ? shade(r, own, error)
                                         : draw_edges(r, own, slice, error);
    return ok && stage_clock_end(r, fills ? &frame->times.visibility_us : &frame->times.shade_us);
}

bool draw_polygons(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                   const struct view *view, const struct tile *drawn, struct frame *frame,
                   bool *is_whole, struct error *error)
{
    uint32_t level = own->work->request->surface.level;
    *is_whole = false;
    stage_clock_start(r);
    const struct polygon_mesh *mesh = polygons_put(r, model, level, bytes_a_step(r), error);
    if (!mesh)
        return false;
    if (!polygons_are_whole(mesh))
        return stage_clock_end(r, &frame->times.visibility_us) && stage_clock_read(r);
    if (kept_view_serves(&r->kept, model->serial, own->work->request))
        own->stage = TILE_SHADE;
    struct slice slice = {
        .mesh = mesh,
        .view = view,
        .tile = drawn,
        .left = 3 * triangles_a_step(r),
        .at_once = r->base.info.software ? 3 * SOFTWARE_TRIANGLES_AT_ONCE : SIZE_MAX,
    };
    /* A small mesh is drawn in one step; otherwise each stage takes steps of its own. */
    do {
        if (!draw_stage(r, own, &slice, frame, error))
            return false;
        *is_whole = own->stage == TILE_WHOLE;
    } while (!*is_whole && !own->paused && slice.left > 0);
    return stage_clock_read(r);
}
