/* Finds which of a tile's triangles each of its pixels shows (polygons/fill.h). */
#include "server/render/native/lanes/entries.h"

#include <math.h>

#include "server/render/native/denormals.h"

/* Shares of the second and third corner: (x,y) px from the first corner, b = bx x + by y, and the same for c. Inside,
 * b and c exceed their minimum, and their sum is below `most`. */
struct edges {
    float bx, by, least_b, cx, cy, least_c, most;
};

/* False where the triangle has no area. */
LANE_INLINE bool edges_of(const struct native_placed_triangle *t, float slack_px, struct edges *e)
{
    float qx = t->x[1] - t->x[0], qy = t->y[1] - t->y[0];
    float rx = t->x[2] - t->x[0], ry = t->y[2] - t->y[0];
    float area = qx * ry - rx * qy;
    if (area == 0)
        return false;
    float inverse = 1 / area;
    *e = (struct edges){
        .bx = ry * inverse, .by = -rx * inverse, .cx = -qy * inverse, .cy = qx * inverse};
    e->least_b = -slack_px * (fabsf(e->bx) + fabsf(e->by));
    e->least_c = -slack_px * (fabsf(e->cx) + fabsf(e->cy));
    e->most = 1 + slack_px * (fabsf(e->bx + e->cx) + fabsf(e->by + e->cy));
    return true;
}

/* The part of a triangle's box that lies in a tile, px of the target, inclusive. */
struct box {
    int x0, y0, x1, y1;
};

/* The lanes of a block whose pixels lie in the box. */
LANE_INLINE vmask in_box(const struct box *box, vint x, vint y)
{
    vfloat fx = v_to_float(x), fy = v_to_float(y);
    return v_at_most(v_float((float)box->x0), fx) & v_at_most(fx, v_float((float)box->x1)) &
           v_at_most(v_float((float)box->y0), fy) & v_at_most(fy, v_float((float)box->y1));
}

/* A pixel's result depends on its own place in the picture only, so any division into tiles gives the same
 * picture. */
static void draw(const struct native_slice *slice, const struct native_placed_triangle *t,
                 const struct box *box)
{
    struct native_seen_triangles *seen = slice->seen;
    struct edges e;
    if (!edges_of(t, slice->slack_px, &e))
        return;
    float rise_b = t->nearness[1] - t->nearness[0], rise_c = t->nearness[2] - t->nearness[0];
    float low = fminf(fminf(t->nearness[0], t->nearness[1]), t->nearness[2]);
    float high = fmaxf(fmaxf(t->nearness[0], t->nearness[1]), t->nearness[2]);
    vint lane_x = v_count() & (BLOCK_WIDTH - 1), lane_y = v_count() / BLOCK_WIDTH;
    for (int y = box->y0 & -BLOCK_HEIGHT; y <= box->y1; y += BLOCK_HEIGHT) {
        vint own_y = lane_y + y;
        vfloat dy = v_to_float(own_y + (int32_t)slice->tile.y) + 0.5f - t->y[0];
        for (int x = box->x0 & -BLOCK_WIDTH; x <= box->x1; x += BLOCK_WIDTH) {
            vint own_x = lane_x + x;
            size_t at = (size_t)y * seen->pitch + (size_t)x;
            vfloat dx = v_to_float(own_x + (int32_t)slice->tile.x) + 0.5f - t->x[0];
            vfloat b = e.bx * dx + e.by * dy, c = e.cx * dx + e.cy * dy;
            vfloat own = v_clamp(b * rise_b + (c * rise_c + t->nearness[0]), low, high);
            vmask in = v_less(v_float(e.least_b), b) & v_less(v_float(e.least_c), c) &
                       v_less(b + c, v_float(e.most)) & in_box(box, own_x, own_y) &
                       v_less(v_load_block(seen->nearness + at, (int)seen->pitch), own);
            if (!v_bits(in))
                continue;
            v_store_block(seen->nearness + at, (int)seen->pitch, in, own);
            v_store_int_block(seen->number + at, (int)seen->pitch, in, v_int(t->number));
        }
    }
}

/* Marks all pixels as empty. */
static void clear(struct native_seen_triangles *seen, const struct box *tile)
{
    for (int y = tile->y0; y <= tile->y1; y++) {
        size_t row = (size_t)y * seen->pitch;
        for (int x = tile->x0; x <= tile->x1; x++) {
            seen->nearness[row + (size_t)x] = 0;
            seen->number[row + (size_t)x] = -1;
        }
    }
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int largest(int a, int b)
{
    return a > b ? a : b;
}

void LANE_NAME(native_triangles)(struct native_slice *slice, uint32_t number)
{
    struct native_seen_triangles *seen = slice->seen;
    int x0 = (int)(number % slice->tiles_x) * TILE_WIDTH;
    int y0 = (int)(number / slice->tiles_x) * TILE_HEIGHT;
    const struct box tile = {x0, y0, least(x0 + TILE_WIDTH, (int)seen->width) - 1,
                             least(y0 + TILE_HEIGHT, (int)seen->height) - 1};
    denormals saved = denormals_flush();
    if (slice->is_first)
        clear(seen, &tile);
    for (uint32_t k = 0; k < slice->n_parts; k++) {
        const struct native_placed_part *part = &slice->stage->placed[k];
        for (uint32_t i = part->first_entry[number]; i < part->first_entry[number + 1]; i++) {
            const struct native_placed_triangle *triangle =
                &part->thread->triangle[part->thread->entry[i]];
            const struct box box = {largest(triangle->x0, x0), largest(triangle->y0, y0),
                                    least(triangle->x1, tile.x1), least(triangle->y1, tile.y1)};
            draw(slice, triangle, &box);
        }
    }
    denormals_restore(saved);
}
