/* Projects pieces of the surface to quads and grids in the picture, and finds the tiles they lie in. */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/lanes/project.h"

#include <math.h>
#include <string.h>

#include "server/render/native/denormals.h"

/* Farther from the picture's top left corner, px, single precision is not exact enough. */
static const float FARTHEST_PX = 30000;
/* Rounding may move an edge over a pixel's centre. */
static const float SLACK_PX = 1.0f / 512;

/* Always four, whatever LANES is. */
typedef float four __attribute__((vector_size(16)));

/* The extent of what was placed: box in the picture, and depths as nearness. */
struct reach {
    float x0, x1, y0, y1, farthest, nearest;
};

/* Projects a quad's corners, given relative to the node's origin. False if one lies behind the eye. */
static bool project_corners(const struct native_rays *rays, const struct placed_node *node,
                            const float corner[3][4], struct native_quad *quad, struct reach *reach)
{
    four p[3], at[3];
    memcpy(p, corner, sizeof p);
    for (int a = 0; a < 3; a++)
        at[a] = p[0] * rays->axis[a][0] + p[1] * rays->axis[a][1] + p[2] * rays->axis[a][2];
    four before = node->before - at[2], z = at[2] + node->at[2], nearness = before, px;
    if (rays->perspective) {
        four inverse = 1 / z;
        nearness = before * inverse;
        px = inverse * (1 / rays->slope_px);
    } else {
        px = (four){0} + 1 / rays->start_px;
    }
    four x = (at[0] + node->at[0]) * px + rays->centre_px[0];
    four y = (at[1] + node->at[1]) * px + rays->centre_px[1];
    memcpy(quad->x, &x, sizeof x);
    memcpy(quad->y, &y, sizeof y);
    memcpy(quad->nearness, &nearness, sizeof nearness);
    float depth[4];
    memcpy(depth, &z, sizeof depth);
    *reach =
        (struct reach){least_of(quad->x),   largest_of(quad->x),      least_of(quad->y),
                       largest_of(quad->y), least_of(quad->nearness), largest_of(quad->nearness)};
    return !rays->perspective || least_of(depth) > 0;
}

/* Projects the vertices of a grid over a piece. False if one lies behind the eye. */
static bool project_grid(const struct native_frame *frame, const struct native_patch *patch,
                         const struct native_piece *piece, const struct placed_node *node,
                         uint32_t grid, float *vertex, struct reach *reach)
{
    const struct native_rays *rays = &frame->rays;
    uint32_t n = (grid_cells[grid / GRID_SIDES] + 1u) * (grid_cells[grid % GRID_SIDES] + 1u);
    float *to_x = vertex, *to_y = to_x + n + LANES, *to_nearness = to_y + n + LANES;
    const struct projection on = projection_of(rays, node, patch);
    vfloat x0 = v_float(INFINITY), x1 = -x0, y0 = x0, y1 = x1, farthest = x0, nearest = x1, z0 = x0;
    for (uint32_t i = 0; i < n; i += LANES) {
        vfloat s = v_load(frame->grid_s[grid] + i) * piece->size + piece->s;
        vfloat t = v_load(frame->grid_t[grid] + i) * piece->size + piece->t, x, y, z, nearness;
        project(&on, s, t, &x, &y, &z, &nearness);
        v_store(to_x + i, x);
        v_store(to_y + i, y);
        v_store(to_nearness + i, nearness);
        x0 = v_min(x0, x);
        x1 = v_max(x1, x);
        y0 = v_min(y0, y);
        y1 = v_max(y1, y);
        z0 = v_min(z0, z);
        farthest = v_min(farthest, nearness);
        nearest = v_max(nearest, nearness);
    }
    *reach = (struct reach){v_least(x0),   v_largest(x1),     v_least(y0),
                            v_largest(y1), v_least(farthest), v_largest(nearest)};
    return !rays->perspective || v_least(z0) > 0;
}

/* Whether the near plane cuts nothing of it and single precision is exact enough for it. */
static bool is_plain(const struct native_rays *rays, const struct reach *r)
{
    return r->nearest <= rays->nearest && r->x0 > -FARTHEST_PX && r->x1 < FARTHEST_PX &&
           r->y0 > -FARTHEST_PX && r->y1 < FARTHEST_PX;
}

static bool is_looked_at(const struct tile *around, const int box[4])
{
    return box[0] <= box[2] && box[1] <= box[3] && box[2] >= (int)around->x &&
           box[0] < (int)(around->x + around->width) && box[3] >= (int)around->y &&
           box[1] < (int)(around->y + around->height);
}

/* Cuts a box of pixels to the picture. False if none of them is looked at. */
static bool cut_to_picture(const struct native_frame *frame, int x0, int y0, int x1, int y1,
                           int box[4])
{
    int width = (int)frame->view->width_px, height = (int)frame->view->height_px;
    box[0] = x0 < 0 ? 0 : x0;
    box[1] = y0 < 0 ? 0 : y0;
    box[2] = x1 < width ? x1 : width - 1;
    box[3] = y1 < height ? y1 : height - 1;
    return is_looked_at(&frame->around, box);
}

/* Finds the pixels whose centres a piece may cover, or if there are none those that it touches: rays of these may meet
 * it (rays/rays.h). False if none of them is looked at. */
static bool pixels_of(const struct native_frame *frame, const struct reach *r, int box[4])
{
    float x0 = r->x0 - SLACK_PX, x1 = r->x1 + SLACK_PX;
    float y0 = r->y0 - SLACK_PX, y1 = r->y1 + SLACK_PX;
    return cut_to_picture(frame, (int)ceilf(x0 - 0.5f), (int)ceilf(y0 - 0.5f),
                          (int)floorf(x1 - 0.5f), (int)floorf(y1 - 0.5f), box) ||
           cut_to_picture(frame, (int)floorf(x0), (int)floorf(y0), (int)floorf(x1), (int)floorf(y1),
                          box);
}

/* --- */

/* The corners of what remains of a CORNER below a level: the vertex, and the inner corners of that level's
 * squares. */
static void rest_corners(const struct native_frame *frame, uint32_t node, int level,
                         float corner[3][4])
{
    const struct limit_node *of = &frame->model->tables->nodes[node];
    for (int c = 1; c < 4; c++) {
        unsigned square = c == 1 ? 1 : c == 3 ? 2 : 3;
        struct native_patch room;
        const struct native_patch *patch =
            native_patch_get(frame->model, node, native_patch_index(of, level, square), &room);
        for (int k = 0; k < 3; k++)
            corner[k][c] = patch->corner[k][0];
    }
    for (int k = 0; k < 3; k++)
        corner[k][0] = 0;
}

/* The index of a chosen grid's sub-patch in its node. */
static uint32_t patch_index_of(const struct limit_node *node, const struct patch_grid *chosen)
{
    int level = chosen->where & 63;
    unsigned square = chosen->where >> 6 & 3;
    bool is_last = node->kind == LIMIT_STRIP && !square; /* follows all levels */
    return native_patch_index(node, level + is_last, square);
}

/* Describes a grid that patch_grids.c has chosen as a piece. Returns its sub-patch, computed in *room if it is not
 * kept; NULL if the corners of its node are enough to place it. */
static const struct native_patch *understand(const struct native_frame *frame,
                                             const struct patch_grid *chosen,
                                             struct native_piece *piece, struct native_patch *room)
{
    const struct limit_node *node = &frame->model->tables->nodes[chosen->node];
    int level = chosen->where & 63;
    unsigned square = chosen->where >> 6 & 3, depth = chosen->where >> 8 & 0xff;
    float size = ldexpf(1, -(int)depth);
    *piece = (struct native_piece){.node = chosen->node,
                                   .s = (float)chosen->x * size,
                                   .t = (float)chosen->y * size,
                                   .size = size,
                                   .level = (uint8_t)level,
                                   .square = (uint8_t)square};
    if (node->kind == LIMIT_CORNER && !square)
        piece->kind = PIECE_REST;
    else if (node->kind == LIMIT_STRIP && !square && level == 0 && node->levels > 0)
        piece->kind = PIECE_STRIP;
    bool is_whole = node->kind == LIMIT_REGULAR && chosen->where >> 8 == 0;
    if (piece->kind != PIECE_OF_PATCH || is_whole)
        return NULL;
    const struct native_patch *patch =
        native_patch_get(frame->model, chosen->node, patch_index_of(node, chosen), room);
    piece->patch = patch == room ? NULL : patch;
    return patch;
}

/* Places a piece as a cell, a grid or triangles. 0: not in a place that is looked at; -1: no memory. */
static int draw_piece(struct native_frame *frame, struct native_thread *thread,
                      const struct placed_node *node, uint32_t grid,
                      const struct native_patch *patch, struct native_piece *piece,
                      struct native_quad *quad, float *nearest)
{
    float own[3][4];
    const float(*corner)[4] = (const float(*)[4])frame->model->tables->heads[piece->node].corner;
    struct reach reach;
    int box[4];
    bool is_cell = grid == 0 && piece->size >= 1, is_before;
    *quad = (struct native_quad){.grid = (uint16_t)(is_cell ? QUAD_CELL : grid),
                                 .first = (uint32_t)thread->n_vertices};
    if (patch) {
        corner = (const float(*)[4])patch->corner;
    } else if (piece->kind == PIECE_REST && piece->level > 0) {
        rest_corners(frame, piece->node, piece->level, own);
        corner = (const float(*)[4])own;
    }
    if (is_cell)
        is_before = project_corners(&frame->rays, node, corner, quad, &reach);
    else
        is_before = project_grid(frame, patch, piece, node, grid,
                                 thread->vertex + thread->n_vertices, &reach);
    if (is_before && is_plain(&frame->rays, &reach)) {
        if (!pixels_of(frame, &reach, box))
            return 0;
        *nearest = reach.nearest;
    } else {
        *quad =
            (struct native_quad){.grid = QUAD_TRIANGLES, .first = (uint32_t)thread->n_triangles};
        int n = native_cut_piece(frame, thread, piece, patch, grid, box, nearest);
        if (n <= 0 || !is_looked_at(&frame->around, box))
            return n < 0 ? n : 0;
        quad->n_triangles = (uint16_t)n;
    }
    quad->x0 = piece->x0 = (uint16_t)box[0];
    quad->y0 = piece->y0 = (uint16_t)box[1];
    quad->x1 = piece->x1 = (uint16_t)box[2];
    quad->y1 = piece->y1 = (uint16_t)box[3];
    return 1;
}

static uint32_t vertices_of(uint32_t grid)
{
    uint32_t n = (grid_cells[grid / GRID_SIDES] + 1u) * (grid_cells[grid % GRID_SIDES] + 1u);
    return (3 * (n + LANES) + 15) & ~15u;
}

/* Reserves room for what the chosen pieces may need. */
static bool reserve(struct native_thread *thread, size_t n_chosen)
{
    size_t n_vertices = 0, n = thread->n_quads + n_chosen, most = thread->quad_capacity;
    for (size_t i = 0; i < n_chosen; i++) {
        uint32_t where = thread->grids.chosen[i].where;
        n_vertices += where >> 8 ? vertices_of(where >> 16) : 0;
    }
    if (n > thread->quad_capacity) {
        size_t quads = most, nearest = most;
        if (!native_grow(&thread->piece, &most, n, sizeof *thread->piece) ||
            !native_grow(&thread->quad, &quads, n, sizeof *thread->quad) ||
            !native_grow(&thread->nearest, &nearest, n, sizeof *thread->nearest))
            return false;
        thread->quad_capacity = most;
    }
    return native_grow(&thread->vertex, &thread->vertex_capacity, thread->n_vertices + n_vertices,
                       sizeof *thread->vertex);
}

/* So many pieces ahead the processor is told what will be read. */
enum { AHEAD = 8 };

/* Most pieces of a view were placed before, so that their patches are kept, but not in the processor's caches. */
static void expect(const struct native_frame *frame, const struct native_thread *thread, size_t i,
                   size_t n_chosen)
{
    const struct limit_node *nodes = frame->model->tables->nodes;
    const struct patch_grid *chosen = thread->grids.chosen;
    if (i + 2 * AHEAD < n_chosen)
        __builtin_prefetch(&nodes[chosen[i + 2 * AHEAD].node]);
    if (i + AHEAD < n_chosen) {
        const struct patch_grid *next = &chosen[i + AHEAD];
        uint32_t index = patch_index_of(&nodes[next->node], next);
        record_cache_expect(frame->model->patches, record_cache_key(next->node, index));
    }
}

/* Draws the chosen pieces that cover pixels' centres. False: no memory. */
static bool draw_chosen(struct native_frame *frame, struct native_thread *thread, size_t n_chosen)
{
    struct placed_node node = {{0}, 0, {{0}}};
    uint32_t last = UINT32_MAX;
    for (size_t i = 0; i < n_chosen; i++) {
        const struct patch_grid *chosen = &thread->grids.chosen[i];
        uint32_t grid = chosen->where >> 16;
        size_t at = thread->n_quads;
        expect(frame, thread, i, n_chosen);
        if (chosen->node != last)
            node = place_node(frame, last = chosen->node);
        struct native_patch room;
        const struct native_patch *patch = understand(frame, chosen, &thread->piece[at], &room);
        int drawn = draw_piece(frame, thread, &node, grid, patch, &thread->piece[at],
                               &thread->quad[at], &thread->nearest[at]);
        if (drawn < 0)
            return false;
        if (drawn && thread->quad[at].grid < QUAD_TRIANGLES)
            thread->n_vertices += vertices_of(grid);
        thread->n_quads += (size_t)drawn;
    }
    return true;
}

/* --- */

struct tiles {
    uint32_t x0, y0, x1, y1;
};

/* The frame's tiles in which a quad may be visible, aprons included. */
static struct tiles tiles_under(const struct native_frame *frame, const struct native_quad *quad)
{
    int x0 = (quad->x0 - APRON) / TILE_WIDTH - (int)frame->first_x;
    int y0 = (quad->y0 - APRON) / TILE_HEIGHT - (int)frame->first_y;
    int x1 = (quad->x1 + APRON) / TILE_WIDTH - (int)frame->first_x;
    int y1 = (quad->y1 + APRON) / TILE_HEIGHT - (int)frame->first_y;
    int last_x = (int)frame->tiles_x - 1, last_y = (int)frame->tiles_y - 1;
    return (struct tiles){(uint32_t)(x0 < 0 ? 0 : x0), (uint32_t)(y0 < 0 ? 0 : y0),
                          (uint32_t)(x1 > last_x ? last_x : x1),
                          (uint32_t)(y1 > last_y ? last_y : y1)};
}

static uint8_t in_tile(int at, int size)
{
    return (uint8_t)(at < 0 ? 0 : at < size ? at : size - 1);
}

/* The entry of a quad in the frame's tile at column x, row y. Its box has the pixels whose centres the quad covers,
 * unless it covers none, so it may also touch those around. */
static struct native_entry entry_of(const struct native_frame *frame,
                                    const struct native_thread *thread, uint32_t quad, uint32_t x,
                                    uint32_t y)
{
    const struct native_quad *box = &thread->quad[quad];
    int left = (int)((frame->first_x + x) * TILE_WIDTH);
    int top = (int)((frame->first_y + y) * TILE_HEIGHT);
    return (struct native_entry){thread->nearest[quad],
                                 quad,
                                 in_tile(box->x0 - left - 1, TILE_WIDTH),
                                 in_tile(box->y0 - top - 1, TILE_HEIGHT),
                                 in_tile(box->x1 - left + 1, TILE_WIDTH),
                                 in_tile(box->y1 - top + 1, TILE_HEIGHT)};
}

/* Sorts the thread's quads from `first` on by the tiles they lie in (counting sort). */
static bool sort_by_tile(const struct native_frame *frame, struct native_thread *thread,
                         struct native_part *part, size_t first)
{
    uint32_t n_tiles = frame->tiles_x * frame->tiles_y, *count = part->first_entry;
    memset(count, 0, (n_tiles + 2) * sizeof *count);
    for (size_t i = first; i < thread->n_quads; i++) {
        struct tiles t = tiles_under(frame, &thread->quad[i]);
        for (uint32_t y = t.y0; y <= t.y1; y++)
            for (uint32_t x = t.x0; x <= t.x1; x++)
                count[y * frame->tiles_x + x + 2]++;
    }
    count[0] = count[1] = (uint32_t)thread->n_entries;
    for (uint32_t k = 1; k <= n_tiles; k++)
        count[k + 1] += count[k];
    size_t n = count[n_tiles + 1];
    if (!native_grow(&thread->entry, &thread->entry_capacity, n, sizeof *thread->entry))
        return false;
    for (size_t i = first; i < thread->n_quads; i++) {
        struct tiles t = tiles_under(frame, &thread->quad[i]);
        for (uint32_t y = t.y0; y <= t.y1; y++)
            for (uint32_t x = t.x0; x <= t.x1; x++)
                thread->entry[count[y * frame->tiles_x + x + 1]++] =
                    entry_of(frame, thread, (uint32_t)i, x, y);
    }
    thread->n_entries = n;
    return true;
}

void LANE_NAME(native_pieces)(struct native_frame *frame, struct native_thread *thread,
                              uint32_t number)
{
    struct native_part *part = &frame->part[number];
    size_t first = thread->n_quads, n_chosen = thread->grids.n_chosen;
    denormals saved = denormals_flush();
    part->thread = thread->number;
    bool ok = reserve(thread, n_chosen) && draw_chosen(frame, thread, n_chosen) &&
              sort_by_tile(frame, thread, part, first);
    if (!ok)
        __atomic_store_n(&frame->out_of_memory, true, __ATOMIC_RELAXED);
    denormals_restore(saved);
}
