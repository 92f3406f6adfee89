#include "server/render/native/polygons/fill.h"

#include <stdlib.h>

#include "server/render/native/native.h"

/* Rows begin at multiples of PITCH_PX, and there are whole blocks of them (lanes.h). */
enum { PITCH_PX = 16, BLOCK_ROWS = 2 };

static size_t pitch_of(uint32_t width)
{
    return ((size_t)width + PITCH_PX - 1) / PITCH_PX * PITCH_PX;
}

static size_t pixels_of(uint32_t width, uint32_t height)
{
    return pitch_of(width) * (((size_t)height + BLOCK_ROWS - 1) / BLOCK_ROWS * BLOCK_ROWS);
}

uint64_t native_seen_bytes(uint32_t width_px, uint32_t height_px)
{
    return (uint64_t)pixels_of(width_px, height_px) * (sizeof(float) + sizeof(int32_t));
}

static bool reserve_seen(struct native_seen_triangles *seen, const struct tile *tile)
{
    size_t n = pixels_of(tile->width, tile->height);
    seen->width = tile->width;
    seen->height = tile->height;
    seen->pitch = pitch_of(tile->width);
    return native_grow(&seen->nearness, &seen->n_nearness, n, sizeof *seen->nearness) &&
           native_grow(&seen->number, &seen->n_number, n, sizeof *seen->number);
}

void native_seen_finish(struct native_seen_triangles *seen)
{
    free(seen->nearness);
    free(seen->number);
    *seen = (struct native_seen_triangles){0};
}

void native_polygon_stage_finish(struct native_polygon_stage *stage)
{
    for (int i = 0; i < NATIVE_MAX_THREADS; i++) {
        free(stage->thread[i].triangle);
        free(stage->thread[i].entry);
    }
    free(stage->part);
    free(stage->placed);
    free(stage->first_entry);
    *stage = (struct native_polygon_stage){0};
}

/* Chooses the parts from *part on that the tile may show, as many as a slice takes. */
static bool choose_parts(struct native_slice *slice, size_t *part, size_t most)
{
    struct native_polygon_stage *stage = slice->stage;
    const struct mesh *mesh = slice->mesh;
    struct view_sides sides;
    size_t n_indices = 0;
    view_sides_init(&sides, slice->view, &slice->tile);
    for (; *part < mesh->n_parts && n_indices < 3 * most; ++*part) {
        const struct mesh_part *next = &mesh->part[*part];
        if (mesh_part_is_outside(next, mesh->centre, slice->view, &sides))
            continue;
        if (!native_grow(&stage->part, &stage->part_capacity, slice->n_parts + (size_t)1,
                         sizeof *stage->part))
            return false;
        stage->part[slice->n_parts++] = (uint32_t)*part;
        n_indices += next->n;
    }
    return true;
}

static bool reserve_parts(const struct native_slice *slice)
{
    struct native_polygon_stage *stage = slice->stage;
    size_t row = (size_t)slice->tiles_x * slice->tiles_y + 2, n = slice->n_parts;
    if (!native_grow(&stage->placed, &stage->placed_capacity, n, sizeof *stage->placed) ||
        !native_grow(&stage->first_entry, &stage->first_entry_capacity, n * row,
                     sizeof *stage->first_entry))
        return false;
    for (size_t i = 0; i < n; i++)
        stage->placed[i].first_entry = stage->first_entry + i * row;
    return true;
}

static bool has_failed(const struct native_slice *slice)
{
    return __atomic_load_n(&slice->out_of_memory, __ATOMIC_RELAXED);
}

static void place(void *owner, unsigned number)
{
    struct native_slice *slice = owner;
    struct native_polygon_thread *thread = &slice->stage->thread[number];
    uint32_t k;
    thread->n_triangles = thread->n_entries = 0;
    while (!has_failed(slice) &&
           (k = __atomic_fetch_add(&slice->next_part, 1, __ATOMIC_RELAXED)) < slice->n_parts)
        slice->set->place(slice, thread, k);
}

static void draw(void *owner, unsigned number)
{
    struct native_slice *slice = owner;
    uint32_t n_tiles = slice->tiles_x * slice->tiles_y, k;
    (void)number;
    while ((k = __atomic_fetch_add(&slice->next_tile, 1, __ATOMIC_RELAXED)) < n_tiles)
        slice->set->triangles(slice, k);
}

/* Two roundings of the picture's largest coordinate, and as much again for how differently neighbours may round. */
static float slack_of(const struct view *view)
{
    uint32_t side = view->width_px > view->height_px ? view->width_px : view->height_px;
    return 1.0f / 4096 + (float)side / (1 << 22);
}

bool native_polygons_fill(struct native_polygon_stage *stage, struct native_device *device,
                          const struct mesh *mesh, const struct view *view, const struct tile *tile,
                          struct native_seen_triangles *seen, size_t *part, size_t most,
                          struct error *error)
{
    struct native_slice slice = {.stage = stage,
                                 .set = native_device_set(device),
                                 .mesh = mesh,
                                 .view = view,
                                 .seen = seen,
                                 .tile = *tile,
                                 .tiles_x = (tile->width - 1) / TILE_WIDTH + 1,
                                 .tiles_y = (tile->height - 1) / TILE_HEIGHT + 1,
                                 .is_first = *part == 0};
    double centre[3];
    view_transform(view, mesh->centre, centre);
    for (int k = 0; k < 3; k++)
        slice.centre[k] = (float)centre[k];
    slice.before = (float)(view->far - centre[2]);
    slice.slack_px = slack_of(view);
    native_rays_init(&slice.rays, view);
    native_clip_init(&slice.clip, view);
    bool ok = reserve_seen(seen, tile) && choose_parts(&slice, part, most) && reserve_parts(&slice);
    if (ok)
        native_device_run(device, place, &slice);
    if (ok && !has_failed(&slice)) {
        native_device_run(device, draw, &slice);
        return true;
    }
    return error_set(error, ERROR_SERVER, "out of memory for polygons");
}
