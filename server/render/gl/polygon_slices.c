#include "server/render/gl/polygon_slices.h"

#include <stdlib.h>

#include "server/render/gl/device_internal.h"
#include "server/render/gl/frame.h"
#include "server/render/gl/model.h"
#include "server/render/gl/context/quirks.h"

/* How much a step draws, and how much it puts on the device. On a software device a step takes no
 * longer than a tile of the exact surface (server/frame/request_frame.c). On hardware the aim is
 * the same; that has not been measured. */
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
    enum { BYTES_A_TRIANGLE = 28 }; /* of a fine mesh: half a vertex, three indices */
    return r->base.options.slice   ? r->base.options.slice * BYTES_A_TRIANGLE
           : r->base.info.software ? SOFTWARE_BYTES
                                   : HARDWARE_BYTES;
}

/* --- paused tiles */

struct paused_tiles *paused_tiles_create(void)
{
    struct paused_tiles *set = calloc(1, sizeof *set);
    if (!set)
        return NULL;
    atomic_init(&set->holders, 1);
    for (int i = 0; i < MAX_PAUSED_TILES; i++)
        set->paused[i].set = set;
    return set;
}

void paused_tiles_release(struct paused_tiles *set)
{
    if (set && atomic_fetch_sub(&set->holders, 1) == 1)
        free(set);
}

bool mesh_is_needed(const struct gl_renderer *r, const struct polygon_mesh *mesh)
{
    for (int i = 0; i < MAX_PAUSED_TILES; i++) {
        struct paused_tile *paused = &r->paused_tiles->paused[i];
        if (context_is_current(&r->context, paused->context) && atomic_load(&paused->is_taken) &&
            paused->model_serial == mesh->model_serial && paused->level == mesh->level)
            return true;
    }
    return false;
}

/* Takes the largest that is free, and frees the planes of the other free ones. */
static struct paused_tile *take(struct gl_renderer *r)
{
    struct paused_tile *taken = NULL;
    for (int i = 0; i < MAX_PAUSED_TILES; i++) {
        struct paused_tile *paused = &r->paused_tiles->paused[i], *smaller = paused;
        if (atomic_load(&paused->is_taken))
            continue;
        if (!context_is_current(&r->context, paused->context))
            paused->planes = (struct planes){0};
        paused->context = r->context.number;
        if (!taken || paused->planes.target.width > taken->planes.target.width) {
            smaller = taken;
            taken = paused;
        }
        if (smaller)
            target_finish(&smaller->planes.target);
    }
    if (!taken)
        return NULL;
    /* The frame before may have been one tile, or several. */
    taken->planes.kept.model_serial = 0;
    atomic_fetch_add(&taken->set->holders, 1);
    atomic_store(&taken->is_taken, true);
    return taken;
}

void tile_give_back(struct gl_frame *own)
{
    struct paused_tile *paused = own->paused;
    own->paused = NULL;
    if (!paused)
        return;
    struct paused_tiles *set = paused->set; /* another frame may take it at once */
    atomic_store(&paused->is_taken, false);
    paused_tiles_release(set);
}

void tile_resume(struct gl_renderer *r, struct gl_frame *own)
{
    if (own->paused && context_is_current(&r->context, own->paused->context)) {
        planes_swap(r, &own->paused->planes);
        return;
    }
    /* The tile is new, or what was drawn of it was lost with the device. */
    tile_give_back(own);
    own->stage = TILE_FILL;
    own->part = 0;
}

bool tile_pause(struct gl_renderer *r, const struct gl_model *model, struct gl_frame *own,
                struct error *error)
{
    if (!own->paused && !(own->paused = take(r)))
        return error_set(error, ERROR_SERVER,
                         "%d other frames of polygons are being drawn: try again later",
                         MAX_PAUSED_TILES);
    own->paused->model_serial = model->serial;
    own->paused->level = own->work->request->surface.level;
    planes_swap(r, &own->paused->planes);
    return true;
}

/* --- what a step does */

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

/* One stage, or a slice of it. */
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
    if (is_kept(&r->kept, model, own->work->request))
        own->stage = TILE_SHADE;
    struct slice slice = {
        .mesh = mesh,
        .view = view,
        .tile = drawn,
        .left = 3 * triangles_a_step(r),
        .at_once = r->base.info.software ? 3 * SOFTWARE_TRIANGLES_AT_ONCE : SIZE_MAX,
    };
    /* A small mesh is drawn in one step; else each stage takes its own steps. */
    do {
        if (!draw_stage(r, own, &slice, frame, error))
            return false;
        *is_whole = own->stage == TILE_WHOLE;
    } while (!*is_whole && !own->paused && slice.left > 0);
    return stage_clock_read(r);
}
