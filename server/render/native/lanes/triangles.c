/* Projects the triangles of a mesh, and finds the tiles they lie in (polygons/fill.h). */
#include "server/render/native/lanes/entries.h"

#include <string.h>

#include "server/render/native/denormals.h"

/* Farther from the picture's top left corner, px, single precision is not exact enough. */
static const float FARTHEST_PX = 30000;

/* The corners of LANES triangles. */
struct corners {
    vfloat at[3][3]; /* camera space */
    vfloat x[3], y[3], nearness[3];
    vint vertex[3];
};

LANE_INLINE vfloat least_of(const vfloat a[3])
{
    return v_min(v_min(a[0], a[1]), a[2]);
}

LANE_INLINE vfloat largest_of(const vfloat a[3])
{
    return v_max(v_max(a[0], a[1]), a[2]);
}

LANE_INLINE void load_corners(const struct native_slice *slice, vint triangle, struct corners *c)
{
    enum { VERTEX_WORDS = sizeof(struct mesh_vertex) / sizeof(float) };
    const struct native_rays *rays = &slice->rays;
    const float *vertices = slice->mesh->vertex->position;
    for (int i = 0; i < 3; i++) {
        c->vertex[i] = v_gather_int(slice->mesh->index, 3 * triangle + i);
        vint first = VERTEX_WORDS * c->vertex[i];
        vfloat p[3], turned[3];
        for (int k = 0; k < 3; k++)
            p[k] = v_gather(vertices, first + k);
        for (int a = 0; a < 3; a++) {
            turned[a] = p[0] * rays->axis[a][0] + p[1] * rays->axis[a][1] + p[2] * rays->axis[a][2];
            c->at[i][a] = turned[a] + slice->centre[a];
        }
        vfloat before = slice->before - turned[2], px;
        if (rays->perspective) {
            vfloat inverse = 1 / c->at[i][2];
            px = inverse * (1 / rays->slope_px);
            c->nearness[i] = before * inverse;
        } else {
            px = v_float(1 / rays->start_px);
            c->nearness[i] = before;
        }
        c->x[i] = c->at[i][0] * px + rays->centre_px[0];
        c->y[i] = c->at[i][1] * px + rays->centre_px[1];
    }
}

/* The triangles that the near plane does not cut and for which single precision is exact enough. */
LANE_INLINE vmask plain_ones(const struct native_slice *slice, const struct corners *c)
{
    const struct native_rays *rays = &slice->rays;
    vfloat z[3] = {c->at[0][2], c->at[1][2], c->at[2][2]};
    vmask is_before =
        rays->perspective ? v_less(v_float(0), least_of(z)) : v_at_most(v_float(0), v_float(0));
    return is_before & v_at_most(largest_of(c->nearness), v_float(rays->nearest)) &
           v_less(v_float(-FARTHEST_PX), v_min(least_of(c->x), least_of(c->y))) &
           v_less(v_max(largest_of(c->x), largest_of(c->y)), v_float(FARTHEST_PX));
}

/* The pixels of one side of the tile whose centres lie from `low` to `high`, px of the picture. */
struct range {
    vint first, last;
    vmask is_empty;
};

LANE_INLINE struct range range_of(vfloat low, vfloat high, float slack_px, uint32_t begin,
                                  uint32_t size)
{
    vfloat least = v_clamp(low - (0.5f + slack_px) - (float)begin, -1, (float)size) + 1;
    vfloat most = v_clamp(high - (0.5f - slack_px) - (float)begin, -1, (float)size) + 1;
    vfloat first = v_to_float(v_truncate(least)), last = v_to_float(v_truncate(most)) - 1;
    first = v_select(v_less(first, least), first, first - 1); /* rounded up, less the 1 */
    first = v_max(first, v_float(0));
    last = v_min(last, v_float((float)size - 1));
    return (struct range){v_truncate(first), v_truncate(last), v_less(last, first)};
}

/* --- */

static bool add(struct native_polygon_thread *thread, const struct native_placed_triangle *triangle)
{
    if (!native_grow(&thread->triangle, &thread->triangle_capacity, thread->n_triangles + 1,
                     sizeof *thread->triangle))
        return false;
    thread->triangle[thread->n_triangles++] = *triangle;
    return true;
}

/* Adds the triangles of the mask that cover pixels' centres. False: no memory. */
static bool add_plain(struct native_polygon_thread *thread, const struct corners *c,
                      const struct range *x, const struct range *y, unsigned bits, int32_t first)
{
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct native_placed_triangle triangle = {
            .x0 = (uint16_t)x->first[lane],
            .y0 = (uint16_t)y->first[lane],
            .x1 = (uint16_t)x->last[lane],
            .y1 = (uint16_t)y->last[lane],
            .number = first + lane,
        };
        for (int i = 0; i < 3; i++) {
            triangle.x[i] = c->x[i][lane];
            triangle.y[i] = c->y[i][lane];
            triangle.nearness[i] = c->nearness[i][lane];
        }
        if (!add(thread, &triangle))
            return false;
    }
    return true;
}

/* Adds a triangle that remains of one that was cut. */
static bool add_cut(const struct native_slice *slice, struct native_polygon_thread *thread,
                    const struct native_corner *const corners[3], int32_t number)
{
    const struct view *view = slice->view;
    struct native_placed_triangle triangle = {.number = number};
    for (int i = 0; i < 3; i++) {
        double z = corners[i]->at[2], units = view->units_per_px * (view->perspective ? z : 1);
        triangle.x[i] = (float)(corners[i]->at[0] / units + view->centre_px[0]);
        triangle.y[i] = (float)(corners[i]->at[1] / units + view->centre_px[1]);
        triangle.nearness[i] = (float)((view->far - z) / (view->perspective ? z : 1));
    }
    const vfloat x[3] = {v_float(triangle.x[0]), v_float(triangle.x[1]), v_float(triangle.x[2])};
    const vfloat y[3] = {v_float(triangle.y[0]), v_float(triangle.y[1]), v_float(triangle.y[2])};
    const struct tile *tile = &slice->tile;
    struct range across =
        range_of(least_of(x), largest_of(x), slice->slack_px, tile->x, tile->width);
    struct range down =
        range_of(least_of(y), largest_of(y), slice->slack_px, tile->y, tile->height);
    if (v_bits(across.is_empty | down.is_empty))
        return true;
    triangle.x0 = (uint16_t)across.first[0];
    triangle.y0 = (uint16_t)down.first[0];
    triangle.x1 = (uint16_t)across.last[0];
    triangle.y1 = (uint16_t)down.last[0];
    return add(thread, &triangle);
}

/* Cuts the triangles of the mask, in double precision. False: no memory. */
static bool cut(const struct native_slice *slice, struct native_polygon_thread *thread,
                const struct corners *c, unsigned bits, int32_t first)
{
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits);
        struct native_corner corners[3] = {{{0}, 0, 0}}, left[CLIP_MOST_CORNERS];
        for (int i = 0; i < 3; i++) {
            double world[3];
            for (int k = 0; k < 3; k++)
                world[k] = slice->mesh->centre[k] +
                           (double)slice->mesh->vertex[c->vertex[i][lane]].position[k];
            view_transform(slice->view, world, corners[i].at);
        }
        int n = native_clip_triangle(&slice->clip, corners, left);
        for (int i = 2; i < n; i++) {
            const struct native_corner *const three[3] = {&left[0], &left[i - 1], &left[i]};
            if (!add_cut(slice, thread, three, first + lane))
                return false;
        }
    }
    return true;
}

/* --- */

struct tiles {
    uint32_t x0, y0, x1, y1;
};

static struct tiles tiles_under(const struct native_placed_triangle *triangle)
{
    return (struct tiles){triangle->x0 / TILE_WIDTH, triangle->y0 / TILE_HEIGHT,
                          triangle->x1 / TILE_WIDTH, triangle->y1 / TILE_HEIGHT};
}

/* Sorts the thread's triangles from `first` on by the tiles they lie in (counting sort). */
static bool sort_by_tile(const struct native_slice *slice, struct native_polygon_thread *thread,
                         uint32_t *count, size_t first)
{
    uint32_t n_tiles = slice->tiles_x * slice->tiles_y;
    memset(count, 0, (n_tiles + 2) * sizeof *count);
    for (size_t i = first; i < thread->n_triangles; i++) {
        struct tiles t = tiles_under(&thread->triangle[i]);
        for (uint32_t y = t.y0; y <= t.y1; y++)
            for (uint32_t x = t.x0; x <= t.x1; x++)
                count[y * slice->tiles_x + x + 2]++;
    }
    count[0] = count[1] = (uint32_t)thread->n_entries;
    for (uint32_t k = 1; k <= n_tiles; k++)
        count[k + 1] += count[k];
    size_t n = count[n_tiles + 1];
    if (!native_grow(&thread->entry, &thread->entry_capacity, n, sizeof *thread->entry))
        return false;
    for (size_t i = first; i < thread->n_triangles; i++) {
        struct tiles t = tiles_under(&thread->triangle[i]);
        for (uint32_t y = t.y0; y <= t.y1; y++)
            for (uint32_t x = t.x0; x <= t.x1; x++)
                thread->entry[count[y * slice->tiles_x + x + 1]++] = (uint32_t)i;
    }
    thread->n_entries = n;
    return true;
}

void LANE_NAME(native_place)(struct native_slice *slice, struct native_polygon_thread *thread,
                             uint32_t number)
{
    const struct mesh_part *part = &slice->mesh->part[slice->stage->part[number]];
    struct native_placed_part *placed = &slice->stage->placed[number];
    const struct tile *tile = &slice->tile;
    size_t before = thread->n_triangles;
    int32_t first = (int32_t)(part->first / 3), n = (int32_t)(part->n / 3);
    denormals saved = denormals_flush();
    bool ok = true;
    for (int32_t k = 0; ok && k < n; k += LANES) {
        vint triangle = first + k + v_count();
        unsigned all = v_first((uint32_t)(n - k));
        struct corners c;
        load_corners(slice, v_select_int(v_mask(all), triangle, v_int(first)), &c);
        vmask plain = plain_ones(slice, &c);
        struct range x =
            range_of(least_of(c.x), largest_of(c.x), slice->slack_px, tile->x, tile->width);
        struct range y =
            range_of(least_of(c.y), largest_of(c.y), slice->slack_px, tile->y, tile->height);
        unsigned drawn = v_bits(plain & v_not(x.is_empty | y.is_empty)) & all;
        ok = add_plain(thread, &c, &x, &y, drawn, first + k) &&
             cut(slice, thread, &c, v_bits(v_not(plain)) & all, first + k);
    }
    placed->thread = thread;
    if (!ok || !sort_by_tile(slice, thread, placed->first_entry, before))
        __atomic_store_n(&slice->out_of_memory, true, __ATOMIC_RELAXED);
    denormals_restore(saved);
}
