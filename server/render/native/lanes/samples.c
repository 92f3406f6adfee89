/* Finds which pieces the rays of listed pixels may meet (rays/rays.h): draws the tile's pieces, cut finely, at the
 * points where these rays run through the picture. */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/lanes/half.h"
#include "server/render/native/lanes/project.h"
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

/* A cell of a piece is cut into at most 3 x 3 cells, so that 16 places are enough. */
enum { MOST_CUTS = 3, PLACES = 16 };
/* Cells are cut until they lie so close to the surface, px. */
static const float CLOSE_PX = 0.125f;
/* Rounding moves a cell less than this, px. */
static const float LEAST_BULGE_PX = 1.0f / 64;
/* Pieces that are not of one sub-patch stay whole: patch_grids.h. */
static const float WHOLE_PX = 0.5f;

/* A cell or a triangle in the picture: corners in px of the tile, their nearness, and how far the surface may lie
 * outside of it, px. */
struct drawn {
    float x[4], y[4], nearness[4], bulge;
    int piece;
};

/* The pixels of a tile that a shape of n corners may touch, inclusive. False if there is none. */
struct touched {
    int x0, y0, x1, y1;
};

LANE_INLINE bool touch(const float *x, const float *y, int n, float bulge, struct touched *out)
{
    float x0 = x[0], x1 = x[0], y0 = y[0], y1 = y[0];
    for (int k = 1; k < n; k++) {
        x0 = x[k] < x0 ? x[k] : x0;
        x1 = x[k] > x1 ? x[k] : x1;
        y0 = y[k] < y0 ? y[k] : y0;
        y1 = y[k] > y1 ? y[k] : y1;
    }
    if (!(x1 + bulge >= 0 && y1 + bulge >= 0 && x0 - bulge < TILE_WIDTH &&
          y0 - bulge < TILE_HEIGHT))
        return false;
    *out = (struct touched){(int)fmaxf(x0 - bulge, 0), (int)fmaxf(y0 - bulge, 0),
                            (int)fminf(x1 + bulge, TILE_WIDTH - 1),
                            (int)fminf(y1 + bulge, TILE_HEIGHT - 1)};
    return true;
}

/* The listed pixels of columns x0 to x1 in word `word` of a row. */
LANE_INLINE uint64_t listed_in(const struct native_ray_room *room, int y, int word, int x0, int x1)
{
    int first = x0 - 64 * word, last = x1 - 64 * word;
    if (last < 0 || first > 63)
        return 0;
    uint64_t from = ~(uint64_t)0 << (first > 0 ? first : 0);
    uint64_t to = ~(uint64_t)0 >> (last < 63 ? 63 - last : 0);
    return room->listed[y][word] & from & to;
}

static bool any_listed(const struct native_ray_room *room, const struct touched *in)
{
    uint64_t any = 0;
    for (int y = in->y0; y <= in->y1; y++)
        for (int word = in->x0 / 64; word <= in->x1 / 64; word++)
            any |= listed_in(room, y, word, in->x0, in->x1);
    return any != 0;
}

/* --- */

LANE_INLINE void put(struct native_ray_pieces *to, uint32_t at, vmask is, vfloat nearness,
                     int piece, vint place)
{
    is = is & v_less(v_load(to->nearness + at), nearness);
    v_store_masked(to->nearness + at, is, nearness);
    v_store_int_masked(to->piece + at, is, v_int(piece));
    v_store_int_masked(to->place + at, is, place);
}

/* Positive within `bulge` px of the half; b and c without their least. */
LANE_INLINE vfloat beside(const struct half *h, float bulge, vfloat b, vfloat c)
{
    float more_b = bulge * (fabsf(h->bx) + fabsf(h->by));
    float more_c = bulge * (fabsf(h->cx) + fabsf(h->cy));
    float more = bulge * (fabsf(h->bx + h->cx) + fabsf(h->by + h->cy));
    return v_min(v_min(b + more_b, c + more_c), h->most - (b + c) + more);
}

/* A cell of a piece, which begins at s, t of the piece and is ds x dt large there, in PLACE_STEPS. */
struct cell {
    struct drawn drawn;
    float s, t, ds, dt;
};

/* Draws a cell at the rays of one pixel, from `first` on. */
static void draw_pixel(struct native_ray_room *room, const struct cell *cell,
                       const struct half half[2], int x, int y, uint32_t first)
{
    const float *near = cell->drawn.nearness;
    float lowest = fminf(fminf(near[0], near[1]), fminf(near[2], near[3]));
    float highest = fmaxf(fmaxf(near[0], near[1]), fmaxf(near[2], near[3]));
    for (uint32_t k = 0; k < room->rays_per_px; k += LANES) {
        vmask lanes = v_mask(v_first(room->rays_per_px - k));
        /* All rays have a nearer piece. */
        if (!v_bits(lanes & v_less(v_load(room->on.nearness + first + k), v_float(highest))))
            continue;
        vfloat at_x = v_load(room->off_x + first + k) + ((float)x + 0.5f);
        vfloat at_y = v_load(room->off_y + first + k) + ((float)y + 0.5f);
        vfloat b[2], c[2], in[2], near_by[2];
        for (int i = 0; i < 2; i++) {
            b[i] = half[i].bx * at_x + half[i].by * at_y + half[i].b0;
            c[i] = half[i].cx * at_x + half[i].cy * at_y + half[i].c0;
            in[i] = inside(&half[i], b[i], c[i]);
            near_by[i] = beside(&half[i], cell->drawn.bulge, b[i], c[i]);
        }
        vmask is_on = lanes & v_less(v_float(0), v_max(in[0], in[1]));
        vmask is_near = lanes & v_less(v_float(0), v_max(near_by[0], near_by[1])) & v_not(is_on);
        if (!v_bits(is_on | is_near))
            continue;
        vmask is_first =
            (is_on & v_less(v_float(0), in[0])) | (is_near & v_at_most(near_by[1], near_by[0]));
        vfloat u = v_select(is_first, b[0] + half[0].least_b, b[1] + half[1].least_b);
        vfloat v = v_select(is_first, c[0] + half[0].least_c, c[1] + half[1].least_c);
        vfloat nearness = v_select(is_first, u * half[0].rise_b + (v * half[0].rise_c + near[0]),
                                   u * half[1].rise_b + (v * half[1].rise_c + near[3]));
        u = v_select(is_first, u, 1 - u);
        v = v_select(is_first, v, 1 - v);
        vint s = v_round(v_clamp(v_clamp(u, 0, 1) * cell->ds + cell->s, 0, PLACE_STEPS));
        vint t = v_round(v_clamp(v_clamp(v, 0, 1) * cell->dt + cell->t, 0, PLACE_STEPS));
        put(&room->on, first + k, is_on, nearness, cell->drawn.piece, s | t << 16);
        if (v_bits(is_near))
            put(&room->beside, first + k, is_near, v_clamp(nearness, lowest, highest),
                cell->drawn.piece, s | t << 16);
    }
}

static void draw_cell(struct native_ray_room *room, const struct cell *cell)
{
    const struct drawn *d = &cell->drawn;
    struct touched in;
    if (!touch(d->x, d->y, 4, d->bulge, &in) || !any_listed(room, &in))
        return;
    const struct half half[2] = {half_of(0, 0, d->x, d->y, d->nearness, 0, 1, 2),
                                 half_of(0, 0, d->x, d->y, d->nearness, 3, 2, 1)};
    for (int y = in.y0; y <= in.y1; y++)
        for (int word = in.x0 / 64; word <= in.x1 / 64; word++)
            for (uint64_t left = listed_in(room, y, word, in.x0, in.x1); left; left &= left - 1) {
                int x = 64 * word + __builtin_ctzll(left);
                draw_pixel(room, cell, half, x, y, room->first_ray[y * TILE_WIDTH + x]);
            }
}

/* --- */

/* What the cells of a piece are made from. */
struct source {
    const struct native_frame *frame;
    struct native_ray_room *room;
    struct native_piece *piece;
    const struct native_patch *patch; /* NULL: the cells stay whole */
    float left, top;                  /* of the tile, px of the picture */
    struct placed_node node;
};

/* Number of cuts along each side of a cell, and what remains as its bulge. */
static int cuts_of(const struct source *of, const struct cell *cell, float *bulge)
{
    const struct native_rays *rays = &of->frame->rays;
    *bulge = WHOLE_PX;
    if (!of->patch)
        return 1;
    const float *near = cell->drawn.nearness;
    float nearest = fmaxf(fmaxf(near[0], near[1]), fmaxf(near[2], near[3]));
    float px = native_pixel_units(rays, rays->far - before_of(rays, nearest));
    float size = of->piece->size * fmaxf(cell->ds, cell->dt) * (1 / PLACE_STEPS);
    float off = of->patch->bend * of->patch->scale * size * size / (8 * px);
    int cuts = off <= CLOSE_PX ? 1 : off <= 4 * CLOSE_PX ? 2 : MOST_CUTS;
    *bulge = fminf(off / (float)(cuts * cuts), WHOLE_PX) + LEAST_BULGE_PX;
    return cuts;
}

/* Cuts a cell, and draws its parts. */
static void draw_cut(const struct source *of, const struct cell *cell, int cuts, float bulge)
{
    enum { ROW = MOST_CUTS + 1 };
    const struct projection on = projection_of(&of->frame->rays, &of->node, of->patch);
    const float to_s = of->piece->size * (1 / PLACE_STEPS);
    float x[PLACES + LANES], y[PLACES + LANES], nearness[PLACES + LANES];
    for (int i = 0; i < PLACES; i += LANES) {
        vint k = v_count() + i;
        vfloat u = v_to_float(k & (ROW - 1)) * (1 / (float)cuts);
        vfloat v = v_to_float(k / ROW) * (1 / (float)cuts), at_x, at_y, z, near;
        project(&on, (u * cell->ds + cell->s) * to_s + of->piece->s,
                (v * cell->dt + cell->t) * to_s + of->piece->t, &at_x, &at_y, &z, &near);
        v_store(x + i, at_x - of->left);
        v_store(y + i, at_y - of->top);
        v_store(nearness + i, near);
    }
    for (int j = 0; j < cuts; j++) {
        for (int i = 0; i < cuts; i++) {
            const int corner[4] = {j * ROW + i, j * ROW + i + 1, j * ROW + ROW + i,
                                   j * ROW + ROW + i + 1};
            struct cell part = {.ds = cell->ds / (float)cuts, .dt = cell->dt / (float)cuts};
            part.s = cell->s + (float)i * part.ds;
            part.t = cell->t + (float)j * part.dt;
            part.drawn.piece = cell->drawn.piece;
            part.drawn.bulge = bulge;
            for (int k = 0; k < 4; k++) {
                part.drawn.x[k] = x[corner[k]];
                part.drawn.y[k] = y[corner[k]];
                part.drawn.nearness[k] = nearness[corner[k]];
            }
            draw_cell(of->room, &part);
        }
    }
}

/* Draws a cell if it is near listed pixels. */
static void draw_whole(const struct source *of, struct cell *cell)
{
    struct touched in;
    if (!touch(cell->drawn.x, cell->drawn.y, 4, WHOLE_PX, &in) || !any_listed(of->room, &in))
        return;
    int cuts = cuts_of(of, cell, &cell->drawn.bulge);
    if (cuts > 1)
        draw_cut(of, cell, cuts, cell->drawn.bulge);
    else
        draw_cell(of->room, cell);
}

/* Depth may change so much over such a triangle that positions need perspective; its piece is met from there by
 * Newton's method, so one place for all rays of a pixel is enough. */
static void draw_triangle(const struct source *of, const struct native_triangle *t, int piece)
{
    struct cell cell = {.drawn = {.bulge = WHOLE_PX, .piece = piece}};
    struct touched in;
    for (int k = 0; k < 4; k++) {
        int from = k < 3 ? k : 2;
        cell.drawn.x[k] = t->x[from] - of->left;
        cell.drawn.y[k] = t->y[from] - of->top;
        cell.drawn.nearness[k] = t->nearness[from];
    }
    if (!touch(cell.drawn.x, cell.drawn.y, 3, WHOLE_PX, &in))
        return;
    const struct half half[2] = {
        half_of(0, 0, cell.drawn.x, cell.drawn.y, cell.drawn.nearness, 0, 1, 2), {.most = -1}};
    for (int y = in.y0; y <= in.y1; y++)
        for (int word = in.x0 / 64; word <= in.x1 / 64; word++)
            for (uint64_t left = listed_in(of->room, y, word, in.x0, in.x1); left;
                 left &= left - 1) {
                int x = 64 * word + __builtin_ctzll(left);
                float at_x = (float)x + 0.5f, at_y = (float)y + 0.5f;
                float b = half[0].bx * at_x + half[0].by * at_y + half[0].b0 + half[0].least_b;
                float c = half[0].cx * at_x + half[0].cy * at_y + half[0].c0 + half[0].least_c;
                b = fminf(fmaxf(b, 0), 1);
                c = fminf(fmaxf(c, 0), 1 - b);
                float weight[3] = {(1 - b - c) * t->inverse_z[0], b * t->inverse_z[1],
                                   c * t->inverse_z[2]};
                float inverse = 1 / (weight[0] + weight[1] + weight[2]);
                cell.s = PLACE_STEPS * inverse *
                         (weight[0] * t->s[0] + weight[1] * t->s[1] + weight[2] * t->s[2]);
                cell.t = PLACE_STEPS * inverse *
                         (weight[0] * t->t[0] + weight[1] * t->t[1] + weight[2] * t->t[2]);
                draw_pixel(of->room, &cell, half, x, y, of->room->first_ray[y * TILE_WIDTH + x]);
            }
}

static void draw_grid(const struct source *of, const float *vertex, uint32_t grid, int piece)
{
    int across = grid_cells[grid / GRID_SIDES], down = grid_cells[grid % GRID_SIDES];
    int n = (across + 1) * (down + 1);
    const float *x = vertex, *y = x + n + LANES, *nearness = y + n + LANES;
    struct cell cell = {.ds = PLACE_STEPS / (float)across, .dt = PLACE_STEPS / (float)down};
    cell.drawn.piece = piece;
    for (int j = 0; j < down; j++) {
        for (int i = 0; i < across; i++) {
            int first = j * (across + 1) + i;
            const int corner[4] = {first, first + 1, first + across + 1, first + across + 2};
            for (int k = 0; k < 4; k++) {
                cell.drawn.x[k] = x[corner[k]] - of->left;
                cell.drawn.y[k] = y[corner[k]] - of->top;
                cell.drawn.nearness[k] = nearness[corner[k]];
            }
            cell.s = (float)i * cell.ds;
            cell.t = (float)j * cell.dt;
            draw_whole(of, &cell);
        }
    }
}

static void draw_quad(struct source *of, const struct native_thread *thread, uint32_t i,
                      struct native_tile_room *tile)
{
    const struct native_quad *quad = &thread->quad[i];
    int k = native_ray_piece_of(thread->number, i);
    of->piece = &thread->piece[i];
    if (quad->grid == QUAD_TRIANGLES) {
        for (uint32_t n = 0; n < quad->n_triangles; n++)
            draw_triangle(of, &thread->triangle[quad->first + n], k);
        return;
    }
    bool is_of_patch = of->piece->kind == PIECE_OF_PATCH;
    of->patch = is_of_patch ? native_patch_of_piece(of->frame, tile, of->piece) : NULL;
    of->node = place_node(of->frame, of->piece->node);
    if (quad->grid != QUAD_CELL) {
        draw_grid(of, thread->vertex + quad->first, quad->grid, k);
        return;
    }
    struct cell cell = {.drawn = {.piece = k}, .ds = PLACE_STEPS, .dt = PLACE_STEPS};
    for (int c = 0; c < 4; c++) {
        cell.drawn.x[c] = quad->x[c] - of->left;
        cell.drawn.y[c] = quad->y[c] - of->top;
        cell.drawn.nearness[c] = quad->nearness[c];
    }
    draw_whole(of, &cell);
}

/* Draws those of a part's pieces in the tile that may touch listed pixels. */
static void draw_part(struct source *of, const struct native_part *part,
                      struct native_tile_room *tile)
{
    const struct native_thread *thread = &of->frame->thread[part->thread];
    const uint32_t *first = part->first_entry + of->room->tile;
    for (uint32_t i = first[0]; i < first[1]; i++) {
        const struct native_entry *entry = &thread->entry[i];
        const struct touched in = {entry->x0, entry->y0, entry->x1, entry->y1};
        if (any_listed(of->room, &in))
            draw_quad(of, thread, entry->quad, tile);
    }
}

void LANE_NAME(native_see_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                                struct native_ray_room *room)
{
    memset(room->on.nearness, 0, room->n_rays * sizeof *room->on.nearness);
    memset(room->beside.nearness, 0, room->n_rays * sizeof *room->beside.nearness);
    uint32_t x = frame->first_x + room->tile % frame->tiles_x;
    uint32_t y = frame->first_y + room->tile / frame->tiles_x;
    struct source of = {.frame = frame,
                        .room = room,
                        .left = (float)(x * TILE_WIDTH),
                        .top = (float)(y * TILE_HEIGHT)};
    for (uint32_t p = 0; p < frame->n_parts; p++)
        draw_part(&of, &frame->part[p], tile);
}
