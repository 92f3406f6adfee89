#include "server/render/native/lanes/raster.h"
#include "server/render/native/lanes/half.h"

#include <math.h>

/* Pixels of the room, inclusive. */
struct box {
    int x0, y0, x1, y1;
};

/* Pixels' centres are whole numbers in the room. */
LANE_INLINE float left_of(const struct native_tile_room *room)
{
    return (float)((int)room->tile.x - APRON) + 0.5f;
}

LANE_INLINE float top_of(const struct native_tile_room *room)
{
    return (float)((int)room->tile.y - APRON) + 0.5f;
}

/* Column of each lane in a block. */
LANE_INLINE vfloat block_x(void)
{
    return v_to_float(v_count() & (BLOCK_WIDTH - 1));
}

LANE_INLINE vfloat block_y(void)
{
    return v_to_float(v_count() / BLOCK_WIDTH);
}

/* Whether anything there is farther than the nearest corner of the cell. */
LANE_INLINE bool may_show(const struct native_tile_room *room, const struct box *box,
                          const float nearness[4])
{
    float nearest = fmaxf(fmaxf(nearness[0], nearness[1]), fmaxf(nearness[2], nearness[3]));
    unsigned any = 0;
    for (int x = box->x0; x <= box->x1; x += BLOCK_WIDTH)
        for (int y = box->y0; y <= box->y1; y += BLOCK_HEIGHT)
            any |= v_bits(v_less(v_load_block(room->nearness + y * SEEN_PITCH + x, SEEN_PITCH),
                                 v_float(nearest)));
    return any;
}

/* Draws both triangles of a cell whose first corner is at (s,t), in PLACE_STEPS, and whose size is (ds,dt). */
LANE_INLINE void draw_cell(struct native_tile_room *room, const float x[4], const float y[4],
                           const float nearness[4], const struct box *box, float s, float t,
                           float ds, float dt, int piece)
{
    if (!may_show(room, box, nearness))
        return;
    /* A pixel's result depends on its own place only, not on where boxes begin, so any division into tiles gives the
     * same picture. */
    const struct half first = half_of(left_of(room), top_of(room), x, y, nearness, 0, 1, 2);
    const struct half second = half_of(left_of(room), top_of(room), x, y, nearness, 3, 2, 1);
    for (int px = box->x0; px <= box->x1; px += BLOCK_WIDTH) {
        vfloat at_x = block_x() + (float)px, at_y = block_y() + (float)box->y0;
        vfloat first_b = first.bx * at_x + first.b0, first_c = first.cx * at_x + first.c0;
        vfloat second_b = second.bx * at_x + second.b0, second_c = second.cx * at_x + second.c0;
        int at = box->y0 * SEEN_PITCH + px;
        for (int py = box->y0; py <= box->y1; py += BLOCK_HEIGHT, at += BLOCK_HEIGHT * SEEN_PITCH) {
            vfloat b = first.by * at_y + first_b, c = first.cy * at_y + first_c;
            vfloat d = second.by * at_y + second_b, e = second.cy * at_y + second_c;
            vfloat in_first = inside(&first, b, c);
            vmask in = v_less(v_float(0), v_max(in_first, inside(&second, d, e)));
            at_y += BLOCK_HEIGHT;
            if (!v_bits(in))
                continue;
            vmask is_first = v_less(v_float(0), in_first);
            vfloat u = v_select(is_first, b + first.least_b, d + second.least_b);
            vfloat v = v_select(is_first, c + first.least_c, e + second.least_c);
            vfloat own = v_select(is_first, u * first.rise_b + (v * first.rise_c + nearness[0]),
                                  u * second.rise_b + (v * second.rise_c + nearness[3]));
            in = in & v_less(v_load_block(room->nearness + at, SEEN_PITCH), own);
            if (!v_bits(in))
                continue;
            u = v_select(is_first, u, 1 - u);
            v = v_select(is_first, v, 1 - v);
            vint q = v_round(v_clamp(u * ds + s, 0, PLACE_STEPS));
            vint r = v_round(v_clamp(v * dt + t, 0, PLACE_STEPS));
            v_store_block(room->nearness + at, SEEN_PITCH, in, own);
            v_store_int_block(room->piece + at, SEEN_PITCH, in, v_int(piece));
            v_store_int_block(room->place + at, SEEN_PITCH, in, q | r << 16);
        }
    }
}

/* Cuts a box to the pixels that the tile needs. False if nothing remains. */
LANE_INLINE bool cut_box(const struct native_tile_room *room, struct box *box)
{
    box->x0 = box->x0 < room->x0 ? room->x0 : box->x0;
    box->y0 = box->y0 < room->y0 ? room->y0 : box->y0;
    box->x1 = box->x1 < room->x1 ? box->x1 : room->x1;
    box->y1 = box->y1 < room->y1 ? box->y1 : room->y1;
    return box->x0 <= box->x1 && box->y0 <= box->y1;
}

/* The pixels of the room whose centres n vertices may cover. */
LANE_INLINE struct box box_of(const struct native_tile_room *room, const float *x, const float *y,
                              int n)
{
    float x0 = x[0], x1 = x[0], y0 = y[0], y1 = y[0];
    for (int k = 1; k < n; k++) {
        x0 = x[k] < x0 ? x[k] : x0;
        x1 = x[k] > x1 ? x[k] : x1;
        y0 = y[k] < y0 ? y[k] : y0;
        y1 = y[k] > y1 ? y[k] : y1;
    }
    int left = (int)room->tile.x - APRON, top = (int)room->tile.y - APRON;
    return (struct box){
        (int)ceilf(x0 - 0.5f - SLACK_PX) - left, (int)ceilf(y0 - 0.5f - SLACK_PX) - top,
        (int)floorf(x1 - 0.5f + SLACK_PX) - left, (int)floorf(y1 - 0.5f + SLACK_PX) - top};
}

static void draw_grid(struct native_tile_room *room, const float *vertex,
                      const struct native_quad *quad, int piece)
{
    int across = grid_cells[quad->grid / GRID_SIDES], down = grid_cells[quad->grid % GRID_SIDES];
    int n = (across + 1) * (down + 1);
    const float *x = vertex + quad->first, *y = x + n + LANES, *nearness = y + n + LANES;
    float ds = PLACE_STEPS / (float)across, dt = PLACE_STEPS / (float)down;
    for (int j = 0; j < down; j++) {
        for (int i = 0; i < across; i++) {
            int a = j * (across + 1) + i, c = a + across + 1;
            const float cell_x[4] = {x[a], x[a + 1], x[c], x[c + 1]};
            const float cell_y[4] = {y[a], y[a + 1], y[c], y[c + 1]};
            const float near[4] = {nearness[a], nearness[a + 1], nearness[c], nearness[c + 1]};
            struct box box = box_of(room, cell_x, cell_y, 4);
            if (cut_box(room, &box))
                draw_cell(room, cell_x, cell_y, near, &box, (float)i * ds, (float)j * dt, ds, dt,
                          piece);
        }
    }
}

/* Depth may change so much over such a triangle that positions need perspective. */
static void draw_triangle(struct native_tile_room *room, const struct native_triangle *t, int piece)
{
    struct box box = box_of(room, t->x, t->y, 3);
    if (!cut_box(room, &box))
        return;
    const float x[4] = {t->x[0], t->x[1], t->x[2]}, y[4] = {t->y[0], t->y[1], t->y[2]};
    const float nearness[4] = {t->nearness[0], t->nearness[1], t->nearness[2]};
    const struct half h = half_of(left_of(room), top_of(room), x, y, nearness, 0, 1, 2);
    for (int py = box.y0; py <= box.y1; py++) {
        for (int px = box.x0; px <= box.x1; px++) {
            float inner_b = h.bx * (float)px + h.by * (float)py + h.b0;
            float inner_c = h.cx * (float)px + h.cy * (float)py + h.c0;
            float b = inner_b + h.least_b, c = inner_c + h.least_c, a = 1 - b - c;
            float own = b * h.rise_b + c * h.rise_c + nearness[0];
            int at = py * SEEN_PITCH + px;
            if (!(inner_b > 0 && inner_c > 0 && inner_b + inner_c < h.most &&
                  own > room->nearness[at]))
                continue;
            float inverse = a * t->inverse_z[0] + b * t->inverse_z[1] + c * t->inverse_z[2];
            float s = a * t->s[0] * t->inverse_z[0] + b * t->s[1] * t->inverse_z[1] +
                      c * t->s[2] * t->inverse_z[2];
            float r = a * t->t[0] * t->inverse_z[0] + b * t->t[1] * t->inverse_z[1] +
                      c * t->t[2] * t->inverse_z[2];
            room->nearness[at] = own;
            room->piece[at] = piece;
            room->place[at] =
                (int32_t)((uint32_t)(fminf(fmaxf(s / inverse, 0), 1) * PLACE_STEPS + 0.5f) |
                          (uint32_t)(fminf(fmaxf(r / inverse, 0), 1) * PLACE_STEPS + 0.5f) << 16);
        }
    }
}

void LANE_NAME(native_raster)(struct native_tile_room *room, const struct native_thread *thread,
                              const struct native_quad *quad, int piece)
{
    if (quad->grid == QUAD_TRIANGLES) {
        for (uint32_t k = 0; k < quad->n_triangles; k++)
            draw_triangle(room, &thread->triangle[quad->first + k], piece);
        return;
    }
    if (quad->grid != QUAD_CELL) {
        draw_grid(room, thread->vertex, quad, piece);
        return;
    }
    int left = (int)room->tile.x - APRON, top = (int)room->tile.y - APRON;
    struct box box = {quad->x0 - left, quad->y0 - top, quad->x1 - left, quad->y1 - top};
    if (cut_box(room, &box))
        draw_cell(room, quad->x, quad->y, quad->nearness, &box, 0, 0, PLACE_STEPS, PLACE_STEPS,
                  piece);
}
