/* Finds which pieces the rays of listed pixels may meet (rays/rays.h): draws the tile's pieces, cut finely, at the
 * points where these rays run through the picture. */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/lanes/half.h"
#include "server/render/native/lanes/project.h"
#include "server/render/native/lanes/stages.h"

#include <math.h>
#include <string.h>

/* The cells of the grids that patch_grids.h chooses lie within half a pixel of the surface: a ray may meet the surface
 * so far outside of the cell. */
static const float CELL_PX = 0.5f;
/* A cell of one sub-patch is cut into 1, 2 x 2 or 3 x 3 smaller ones: the fewest that lie within CLOSE_PX of the
 * surface, if there are any. 3 x 3 cells have 16 corners. */
enum { MOST_CUTS = 3, PLACES = 16 };
static const float CLOSE_PX = 0.125f;
/* Rounding moves a cell's corners less than this, px. */
static const float LEAST_BULGE_PX = 1.0f / 64;

/* Pixels of a tile, inclusive. */
struct touched {
    int x0, y0, x1, y1;
};

/* Finds the pixels that a shape of n corners may touch if it extends by `bulge` px. False if there is none. */
LANE_INLINE bool touch(const float *x, const float *y, int n, float bulge, struct touched *out)
{
    float x0 = x[0], x1 = x[0], y0 = y[0], y1 = y[0];
    for (int k = 1; k < n; k++) {
        x0 = x[k] < x0 ? x[k] : x0;
        x1 = x[k] > x1 ? x[k] : x1;
        y0 = y[k] < y0 ? y[k] : y0;
        y1 = y[k] > y1 ? y[k] : y1;
    }
    x0 -= bulge;
    y0 -= bulge;
    x1 += bulge;
    y1 += bulge;
    if (!(x1 >= 0 && y1 >= 0 && x0 < TILE_WIDTH && y0 < TILE_HEIGHT))
        return false;
    *out = (struct touched){x0 > 0 ? (int)x0 : 0, y0 > 0 ? (int)y0 : 0,
                            x1 < TILE_WIDTH ? (int)x1 : TILE_WIDTH - 1,
                            y1 < TILE_HEIGHT ? (int)y1 : TILE_HEIGHT - 1};
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

/* A cell of a piece: corners in px of the tile, their nearness, and how far the surface may lie outside of it, px. It
 * begins at s, t of the piece and is ds x dt large there, in PLACE_STEPS. */
struct cell {
    float x[4], y[4], nearness[4], bulge;
    float s, t, ds, dt;
    int piece;
};

/* What all pixels of a cell share. */
struct halves {
    struct half half[2];
    float more_b[2], more_c[2], more[2]; /* what `bulge` px add to b, c and most */
    float lowest, highest;               /* nearness */
};

/* Divides a cell into n triangles: 1 if it is itself a triangle, else 2. The second begins at the opposite corner, so s
 * and t decrease along its sides. */
static void halve(const struct cell *cell, int n, struct halves *out)
{
    out->half[0] = half_of(0, 0, cell->x, cell->y, cell->nearness, 0, 1, 2);
    out->half[1] = (struct half){.most = -1}; /* nothing is inside */
    if (n == 2)
        out->half[1] = half_of(0, 0, cell->x, cell->y, cell->nearness, 3, 2, 1);
    for (int i = 0; i < 2; i++) {
        const struct half *h = &out->half[i];
        out->more_b[i] = cell->bulge * (fabsf(h->bx) + fabsf(h->by));
        out->more_c[i] = cell->bulge * (fabsf(h->cx) + fabsf(h->cy));
        out->more[i] = cell->bulge * (fabsf(h->bx + h->cx) + fabsf(h->by + h->cy));
    }
    out->lowest = least_of(cell->nearness);
    out->highest = largest_of(cell->nearness);
}

/* Draws a cell at the rays of one pixel, from `first` on. */
static void draw_pixel(struct native_ray_room *room, const struct cell *cell,
                       const struct halves *of, int x, int y, uint32_t first)
{
    for (uint32_t k = 0; k < room->rays_per_px; k += LANES) {
        vmask lanes = v_mask(v_first(room->rays_per_px - k));
        /* All rays have a nearer piece. */
        if (!v_bits(lanes & v_less(v_load(room->on.nearness + first + k), v_float(of->highest))))
            continue;
        vfloat at_x = v_load(room->off_x + first + k) + ((float)x + 0.5f);
        vfloat at_y = v_load(room->off_y + first + k) + ((float)y + 0.5f);
        vfloat b[2], c[2], in[2], near_by[2];
        for (int i = 0; i < 2; i++) {
            const struct half *h = &of->half[i];
            b[i] = h->bx * at_x + h->by * at_y + h->b0;
            c[i] = h->cx * at_x + h->cy * at_y + h->c0;
            in[i] = inside(h, b[i], c[i]);
            near_by[i] = v_min(v_min(b[i] + of->more_b[i], c[i] + of->more_c[i]),
                               h->most - (b[i] + c[i]) + of->more[i]);
        }
        vmask is_on = lanes & v_less(v_float(0), v_max(in[0], in[1]));
        vmask is_near = lanes & v_less(v_float(0), v_max(near_by[0], near_by[1])) & v_not(is_on);
        if (!v_bits(is_on | is_near))
            continue;
        /* A point beside both halves belongs to the one whose sides are nearer. */
        vmask is_first =
            (is_on & v_less(v_float(0), in[0])) | (is_near & v_at_most(near_by[1], near_by[0]));
        vfloat u = v_select(is_first, b[0] + of->half[0].least_b, b[1] + of->half[1].least_b);
        vfloat v = v_select(is_first, c[0] + of->half[0].least_c, c[1] + of->half[1].least_c);
        vfloat nearness = v_select(
            is_first, u * of->half[0].rise_b + (v * of->half[0].rise_c + cell->nearness[0]),
            u * of->half[1].rise_b + (v * of->half[1].rise_c + cell->nearness[3]));
        u = v_select(is_first, u, 1 - u);
        v = v_select(is_first, v, 1 - v);
        vint s = v_round(v_clamp(v_clamp(u, 0, 1) * cell->ds + cell->s, 0, PLACE_STEPS));
        vint t = v_round(v_clamp(v_clamp(v, 0, 1) * cell->dt + cell->t, 0, PLACE_STEPS));
        put(&room->on, first + k, is_on, nearness, cell->piece, s | t << 16);
        if (v_bits(is_near))
            put(&room->beside, first + k, is_near, v_clamp(nearness, of->lowest, of->highest),
                cell->piece, s | t << 16);
    }
}

/* Sets a cell's place to that of a triangle at a pixel's centre, interpolated with perspective. */
static void place_in(const struct native_triangle *t, const struct half *half, int x, int y,
                     struct cell *cell)
{
    float at_x = (float)x + 0.5f, at_y = (float)y + 0.5f;
    float b = half->bx * at_x + half->by * at_y + half->b0 + half->least_b;
    float c = half->cx * at_x + half->cy * at_y + half->c0 + half->least_c;
    b = fminf(fmaxf(b, 0), 1);
    c = fminf(fmaxf(c, 0), 1 - b);
    const float weight[3] = {(1 - b - c) * t->inverse_z[0], b * t->inverse_z[1],
                             c * t->inverse_z[2]};
    float to_steps = PLACE_STEPS / (weight[0] + weight[1] + weight[2]);
    cell->s = to_steps * (weight[0] * t->s[0] + weight[1] * t->s[1] + weight[2] * t->s[2]);
    cell->t = to_steps * (weight[0] * t->t[0] + weight[1] * t->t[1] + weight[2] * t->t[2]);
}

/* Draws a cell at the listed pixels of `in`. If it is a triangle, its place is another at each of them. */
LANE_INLINE void draw_touched(struct native_ray_room *room, struct cell *cell,
                              const struct halves *of, const struct touched *in,
                              const struct native_triangle *triangle)
{
    for (int y = in->y0; y <= in->y1; y++)
        for (int word = in->x0 / 64; word <= in->x1 / 64; word++)
            for (uint64_t left = listed_in(room, y, word, in->x0, in->x1); left; left &= left - 1) {
                int x = 64 * word + __builtin_ctzll(left);
                if (triangle)
                    place_in(triangle, &of->half[0], x, y, cell);
                draw_pixel(room, cell, of, x, y, room->first_ray[y * TILE_WIDTH + x]);
            }
}

static void draw_cell(struct native_ray_room *room, struct cell *cell)
{
    struct touched in;
    if (!touch(cell->x, cell->y, 4, cell->bulge, &in) || !any_listed(room, &in))
        return;
    struct halves of;
    halve(cell, 2, &of);
    draw_touched(room, cell, &of, &in, NULL);
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
    *bulge = CELL_PX;
    if (!of->patch)
        return 1;
    float px = native_pixel_units(rays, rays->far - before_of(rays, largest_of(cell->nearness)));
    float size = of->piece->size * (cell->ds > cell->dt ? cell->ds : cell->dt) / PLACE_STEPS;
    float off = of->patch->bend * of->patch->scale * size * size / (8 * px);
    int cuts = off <= CLOSE_PX ? 1 : off <= 4 * CLOSE_PX ? 2 : MOST_CUTS;
    off = off / (float)(cuts * cuts) + LEAST_BULGE_PX;
    *bulge = off < CELL_PX ? off : CELL_PX;
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
            part.piece = cell->piece;
            part.bulge = bulge;
            for (int k = 0; k < 4; k++) {
                part.x[k] = x[corner[k]];
                part.y[k] = y[corner[k]];
                part.nearness[k] = nearness[corner[k]];
            }
            draw_cell(of->room, &part);
        }
    }
}

/* Draws a cell if it is near listed pixels. */
static void draw_whole(const struct source *of, struct cell *cell)
{
    struct touched in;
    if (!touch(cell->x, cell->y, 4, CELL_PX, &in) || !any_listed(of->room, &in))
        return;
    int cuts = cuts_of(of, cell, &cell->bulge);
    if (cuts > 1)
        draw_cut(of, cell, cuts, cell->bulge);
    else
        draw_cell(of->room, cell);
}

/* Draws a triangle of a piece that is cut at the near plane or extends far beyond the picture. Depth may change by
 * orders of magnitude over it, so the place at a pixel is interpolated with perspective. All rays of the pixel get the
 * place of its centre, from which Newton's method finds theirs. */
static void draw_triangle(const struct source *of, const struct native_triangle *t, int piece)
{
    struct cell cell = {.bulge = CELL_PX, .piece = piece};
    struct touched in;
    for (int k = 0; k < 4; k++) {
        int from = k < 3 ? k : 2;
        cell.x[k] = t->x[from] - of->left;
        cell.y[k] = t->y[from] - of->top;
        cell.nearness[k] = t->nearness[from];
    }
    if (!touch(cell.x, cell.y, 3, CELL_PX, &in))
        return;
    struct halves halves;
    halve(&cell, 1, &halves);
    draw_touched(of->room, &cell, &halves, &in, t);
}

/* Cells of a grid's row that are passed over together: with LANES vertices above and as many below them. */
enum { CELLS_TOGETHER = LANES - 1 };

/* Whether a listed pixel may lie near one of n <= CELLS_TOGETHER cells of a row. x and y: their first vertex in the
 * picture, `row` vertices before the one below it. */
static bool any_near(const struct source *of, const float *x, const float *y, int row, int n)
{
    vmask lanes = v_mask(v_first((uint32_t)n + 1));
    vfloat above_x = v_load(x), below_x = v_load(x + row);
    vfloat above_y = v_load(y), below_y = v_load(y + row);
    vfloat far = v_float(INFINITY);
    float ends_x[2] = {v_least(v_select(lanes, v_min(above_x, below_x), far)) - of->left,
                       v_largest(v_select(lanes, v_max(above_x, below_x), -far)) - of->left};
    float ends_y[2] = {v_least(v_select(lanes, v_min(above_y, below_y), far)) - of->top,
                       v_largest(v_select(lanes, v_max(above_y, below_y), -far)) - of->top};
    struct touched in;
    return touch(ends_x, ends_y, 2, CELL_PX, &in) && any_listed(of->room, &in);
}

/* Draws n cells of a row of a grid; `first` is the vertex at which they begin. */
static void draw_cells(const struct source *of, const float *const vertex[3], int first, int row,
                       int n, struct cell *cell)
{
    for (int i = first; i < first + n; i++) {
        cell->s = (float)(i % row) * cell->ds;
        const int corner[4] = {i, i + 1, i + row, i + row + 1};
        for (int k = 0; k < 4; k++) {
            cell->x[k] = vertex[0][corner[k]] - of->left;
            cell->y[k] = vertex[1][corner[k]] - of->top;
            cell->nearness[k] = vertex[2][corner[k]];
        }
        draw_whole(of, cell);
    }
}

static void draw_grid(const struct source *of, const float *vertex, uint32_t grid, int piece)
{
    int across = grid_cells[grid / GRID_SIDES], down = grid_cells[grid % GRID_SIDES];
    int row = across + 1, n = row * (down + 1);
    const float *const at[3] = {vertex, vertex + n + LANES, vertex + 2 * (n + LANES)};
    struct cell cell = {.ds = PLACE_STEPS / (float)across, .dt = PLACE_STEPS / (float)down};
    cell.piece = piece;
    for (int j = 0; j < down; j++) {
        cell.t = (float)j * cell.dt;
        for (int i = 0; i < across; i += CELLS_TOGETHER) {
            int first = j * row + i, left = across - i;
            int together = left < CELLS_TOGETHER ? left : CELLS_TOGETHER;
            if (any_near(of, at[0] + first, at[1] + first, row, together))
                draw_cells(of, at, first, row, together, &cell);
        }
    }
}

static void draw_quad(struct source *of, const struct native_thread *thread,
                      const struct native_quad *quad, struct native_tile_room *tile, int k)
{
    if (quad->grid == QUAD_TRIANGLES) {
        for (uint32_t i = 0; i < quad->n_triangles; i++)
            draw_triangle(of, &thread->triangle[quad->first + i], k);
        return;
    }
    bool is_of_patch = of->piece->kind == PIECE_OF_PATCH;
    of->patch = is_of_patch ? native_patch_of_piece(of->frame, tile, of->piece) : NULL;
    of->node = place_node(of->frame, of->piece->node);
    if (quad->grid != QUAD_CELL) {
        draw_grid(of, thread->vertex + quad->first, quad->grid, k);
        return;
    }
    struct cell cell = {.piece = k, .ds = PLACE_STEPS, .dt = PLACE_STEPS};
    for (int c = 0; c < 4; c++) {
        cell.x[c] = quad->x[c] - of->left;
        cell.y[c] = quad->y[c] - of->top;
        cell.nearness[c] = quad->nearness[c];
    }
    draw_whole(of, &cell);
}

/* Whether a listed pixel lies in a square that the entry touches: most entries lie in none, and this is quick. */
LANE_INLINE bool is_near_listed(const struct native_ray_room *room,
                                const struct native_entry *entry)
{
    uint32_t squares = 0;
    uint32_t columns = (2u << entry->x1 / RAY_SQUARE) - (1u << entry->x0 / RAY_SQUARE);
    for (int y = entry->y0 / RAY_SQUARE; y <= entry->y1 / RAY_SQUARE; y++)
        squares |= room->squares[y];
    return squares & columns;
}

/* Draws those of a part's pieces in the tile that may touch listed pixels, and lists them. */
static void draw_part(struct source *of, const struct native_part *part,
                      struct native_tile_room *tile)
{
    const struct native_thread *thread = &of->frame->thread[part->thread];
    const uint32_t *first = part->first_entry + of->room->tile;
    for (uint32_t i = first[0]; i < first[1]; i++) {
        const struct native_entry *entry = &thread->entry[i];
        const struct touched in = {entry->x0, entry->y0, entry->x1, entry->y1};
        if (!is_near_listed(of->room, entry) || !any_listed(of->room, &in))
            continue;
        of->piece = tile->local[tile->n_local] = &thread->piece[entry->quad];
        draw_quad(of, thread, &thread->quad[entry->quad], tile, (int)tile->n_local++);
    }
}

bool LANE_NAME(native_see_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                                struct native_ray_room *room)
{
    size_t n = 0;
    for (uint32_t p = 0; p < frame->n_parts; p++)
        n += frame->part[p].first_entry[room->tile + 1] - frame->part[p].first_entry[room->tile];
    tile->n_local = 0;
    memset(room->on.nearness, 0, room->n_rays * sizeof *room->on.nearness);
    memset(room->beside.nearness, 0, room->n_rays * sizeof *room->beside.nearness);
    if (!LANE_NAME(native_reserve_local)(tile, n))
        return false;
    uint32_t x = frame->first_x + room->tile % frame->tiles_x;
    uint32_t y = frame->first_y + room->tile / frame->tiles_x;
    struct source of = {.frame = frame,
                        .room = room,
                        .left = (float)(x * TILE_WIDTH),
                        .top = (float)(y * TILE_HEIGHT)};
    for (uint32_t p = 0; p < frame->n_parts; p++)
        draw_part(&of, &frame->part[p], tile);
    return true;
}
