/* Frames of polygons, slice by slice: meshes of millions of triangles keep a software device busy
 * for seconds, and others are drawn in between. What a frame has drawn of its tile stays in its
 * planes, which are set aside meanwhile, so that the picture is that of one stroke. */
#include "server/render/gl/gpu.h"

#include <stdlib.h>

/* What a tile goes through. */
enum { FILL, SHADE, EDGES, WHOLE };

/* What a step draws, and puts on the device: on a software device it takes no longer than a tile
 * does (server/frame/request_frame.c). On hardware the aim is the same; that has not been
 * measured. */
static const size_t SOFTWARE_TRIANGLES = 65536, HARDWARE_TRIANGLES = (size_t)1 << 21;
static const size_t SOFTWARE_BYTES = (size_t)4 << 20, HARDWARE_BYTES = (size_t)32 << 20;

/* A software device draws what it has been given while it is given more: in slices of 65536
 * triangles a car of 12.9 million at 1280x720 took 0.8 s so on llvmpipe, and 1.6 s with nothing
 * handed on before a slice's end, 1.1 s in one stroke. */
static const size_t SOFTWARE_TRIANGLES_AT_ONCE = 8192;

static size_t triangles_a_step(const struct renderer *r)
{
    return r->options.slice   ? r->options.slice
           : r->info.software ? SOFTWARE_TRIANGLES
                              : HARDWARE_TRIANGLES;
}

static size_t bytes_a_step(const struct renderer *r)
{
    enum { BYTES_A_TRIANGLE = 28 }; /* of a fine mesh: half a vertex, three indices */
    return r->options.slice   ? r->options.slice * BYTES_A_TRIANGLE
           : r->info.software ? SOFTWARE_BYTES
                              : HARDWARE_BYTES;
}

/* --- canvases */

struct canvas_set *canvases_create(void)
{
    struct canvas_set *set = calloc(1, sizeof *set);
    if (!set)
        return NULL;
    atomic_init(&set->holders, 1);
    for (int i = 0; i < MAX_CANVASES; i++)
        set->canvas[i].set = set;
    return set;
}

void canvases_release(struct canvas_set *set)
{
    if (set && atomic_fetch_sub(&set->holders, 1) == 1)
        free(set);
}

bool canvas_needs(const struct renderer *r, const struct polygon_mesh *mesh)
{
    for (int i = 0; i < MAX_CANVASES; i++) {
        struct canvas *canvas = &r->canvases->canvas[i];
        if (is_current(r, canvas->context) && atomic_load(&canvas->is_taken) &&
            canvas->model_serial == mesh->model_serial && canvas->level == mesh->level)
            return true;
    }
    return false;
}

/* The largest that is free; the planes of the others that are free go. */
static struct canvas *take(struct renderer *r)
{
    struct canvas *taken = NULL;
    for (int i = 0; i < MAX_CANVASES; i++) {
        struct canvas *canvas = &r->canvases->canvas[i], *smaller = canvas;
        if (atomic_load(&canvas->is_taken))
            continue;
        if (!is_current(r, canvas->context))
            canvas->planes = (struct planes){0};
        canvas->context = r->context;
        if (!taken || canvas->planes.target.width > taken->planes.target.width) {
            smaller = taken;
            taken = canvas;
        }
        if (smaller)
            target_finish(&smaller->planes.target);
    }
    if (!taken)
        return NULL;
    taken->planes.kept.model_serial = 0; /* others may have been drawn in tiles, or not */
    atomic_fetch_add(&taken->set->holders, 1);
    atomic_store(&taken->is_taken, true);
    return taken;
}

void canvas_give_back(struct frame_work *work)
{
    struct canvas *canvas = work->canvas;
    work->canvas = NULL;
    if (!canvas)
        return;
    struct canvas_set *set = canvas->set; /* the canvas is the next frame's at once */
    atomic_store(&canvas->is_taken, false);
    canvases_release(set);
}

void canvas_resume(struct renderer *r, struct frame_work *work)
{
    if (work->canvas && is_current(r, work->canvas->context)) {
        planes_swap(r, &work->canvas->planes);
        return;
    }
    /* A new tile, or one that was lost with the device. */
    canvas_give_back(work);
    work->stage = FILL;
    work->part = 0;
}

bool canvas_set_aside(struct renderer *r, const struct renderer_model *model,
                      struct frame_work *work, struct error *error)
{
    if (!work->canvas && !(work->canvas = take(r)))
        return error_set(error, ERROR_SERVER,
                         "%d other frames of polygons are being drawn: try again later",
                         MAX_CANVASES);
    work->canvas->model_serial = model->serial;
    work->canvas->level = work->request->surface.level;
    planes_swap(r, &work->canvas->planes);
    return true;
}

/* --- what a step does */

static bool fill(struct renderer *r, struct frame_work *work, struct slice *slice,
                 struct error *error)
{
    slice->part = work->part;
    if (work->part == 0) {
        r->kept.model_serial = 0;
        if (!stage_polygons_begin(r, slice->tile, error))
            return false;
    }
    if (!stage_polygons(r, slice, error))
        return false;
    work->part = slice->part;
    if (work->part < slice->mesh->n_parts)
        return true;
    work->stage = SHADE;
    if (!pieces_cover_all(&r->pieces, slice->tile, error))
        return false;
    stage_gather(r);
    return true;
}

static bool shade(struct renderer *r, struct frame_work *work, struct error *error)
{
    work->stage = work->request->surface.kind == SURFACE_WIREFRAME ? EDGES : WHOLE;
    work->part = 0;
    return stage_shade(r, work->request, error);
}

static bool draw_edges(struct renderer *r, struct frame_work *work, struct slice *slice,
                       struct error *error)
{
    slice->part = work->part;
    if (!stage_wireframe(r, slice, error))
        return false;
    work->part = slice->part;
    if (work->part == slice->mesh->n_parts)
        work->stage = WHOLE;
    return true;
}

/* One stage, or a slice of it. */
static bool draw_stage(struct renderer *r, struct frame_work *work, struct slice *slice,
                       struct frame *frame, struct error *error)
{
    bool fills = work->stage == FILL;
    stage_clock_start(r);
    bool ok = fills                  ? fill(r, work, slice, error)
              : work->stage == SHADE ? shade(r, work, error)
                                     : draw_edges(r, work, slice, error);
    return ok && stage_clock_end(r, fills ? &frame->times.visibility_us : &frame->times.shade_us);
}

bool draw_polygons(struct renderer *r, const struct renderer_model *model, struct frame_work *work,
                   const struct view *view, const struct tile *drawn, struct frame *frame,
                   bool *is_whole, struct error *error)
{
    uint32_t level = work->request->surface.level;
    *is_whole = false;
    stage_clock_start(r);
    const struct polygon_mesh *mesh = polygons_put(r, model, level, bytes_a_step(r), error);
    if (!mesh)
        return false;
    if (!polygons_are_whole(mesh))
        return stage_clock_end(r, &frame->times.visibility_us) && stage_clock_read(r);
    if (is_kept(&r->kept, model, work->request))
        work->stage = SHADE;
    struct slice slice = {
        .mesh = mesh,
        .view = view,
        .tile = drawn,
        .left = 3 * triangles_a_step(r),
        .at_once = r->info.software ? 3 * SOFTWARE_TRIANGLES_AT_ONCE : SIZE_MAX,
    };
    /* All at once where that is little; else each stage has its steps. */
    do {
        if (!draw_stage(r, work, &slice, frame, error))
            return false;
        *is_whole = work->stage == WHOLE;
    } while (!*is_whole && !work->canvas && slice.left > 0);
    return stage_clock_read(r);
}
