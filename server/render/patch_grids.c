#include "server/render/patch_grids.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/surface/bound.h"
#include "server/surface/patch.h"
#include "server/surface/vec.h"

/* The largest distance of a triangle from the surface, px. Stage 2 solves for the exact place. */
static const double TOLERANCE_PX = 0.5;
/* A square is cut into four at most this often: 2^20 squares across a face. */
enum { MAX_DEPTH = 20 };
/* The number of steps in which s and t of a guess, each from 0 to 2, are stored. */
enum { GUESS_STEPS = 8191 };

const uint8_t grid_cells[GRID_SIDES] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};

/* The state that all steps of the choice share. */
struct chooser {
    struct patch_grids *out;
    const struct limit_tables *tables;
    const struct view *view;
    struct view_sides sides; /* sides of the tile */
    const struct tile *tile;
    bool guesses;       /* make guesses, not grids */
    size_t first_guess; /* index of the first new guess */
    uint32_t blocks[2]; /* blocks of the tile across and down; 0: none wanted */
    uint64_t n_vertices;
    bool no_memory;
};

/* A part of the surface: a sphere in camera space, and how much the part bends. */
struct extent {
    double centre[3];
    struct limit_bound bound;
};

static bool is_outside(const struct chooser *c, const struct extent *e)
{
    return view_sides_exclude(&c->sides, e->centre, e->bound.radius);
}

/* The number of px that a length can span at the extent's nearest depth. */
static double in_px(const struct chooser *c, const struct extent *e, double length)
{
    double z = fmax(e->centre[2] - e->bound.radius, c->view->near);
    return length / (c->view->perspective ? z * c->view->units_per_px : c->view->units_per_px);
}

/* Converts a coordinate of the picture to a block of the tile, limited to the tile. */
static uint32_t block_at(const struct chooser *c, int k, double px)
{
    double origin = k ? c->tile->y : c->tile->x;
    double block = floor((px - origin) / COVER_BLOCK_PX);
    return (uint32_t)fmin(fmax(block, 0), c->blocks[k] - 1);
}

/* Marks the blocks under a sphere's outline. */
static void cover(struct chooser *c, const struct extent *e)
{
    double nearest = e->centre[2] - e->bound.radius, farthest = e->centre[2] + e->bound.radius;
    bool whole = c->view->perspective && nearest <= 0;
    uint32_t first[2], last[2];
    for (int k = 0; k < 2; k++) {
        double low = e->centre[k] - e->bound.radius, high = e->centre[k] + e->bound.radius;
        if (c->view->perspective) {
            low = fmin(low / nearest, low / farthest);
            high = fmax(high / nearest, high / farthest);
        }
        /* One pixel more on either side, because stage 2 looks at neighbours. */
        low = low / c->view->units_per_px + c->view->centre_px[k] - 2;
        high = high / c->view->units_per_px + c->view->centre_px[k] + 2;
        first[k] = whole ? 0 : block_at(c, k, low);
        last[k] = whole ? c->blocks[k] - 1 : block_at(c, k, high);
    }
    for (uint32_t y = first[1]; y <= last[1]; y++)
        memset(c->out->is_covered + (size_t)y * c->blocks[0] + first[0], 1, last[0] - first[0] + 1);
}

static bool grow(struct patch_grids *out)
{
    size_t capacity = out->capacity ? 2 * out->capacity : 4096;
    struct patch_grid *grid = realloc(out->grid, capacity * sizeof *grid);
    if (grid)
        out->grid = grid;
    struct patch_grid *chosen = realloc(out->chosen, capacity * sizeof *chosen);
    if (chosen)
        out->chosen = chosen;
    if (grid && chosen)
        out->capacity = capacity;
    return grid && chosen;
}

/* The middle of a grid, for patch_grids_guess(). */
static void add_guess(struct chooser *c, const struct patch_grid *grid, const struct extent *extent)
{
    struct patch_grids *out = c->out;
    if (c->no_memory || out->n_guesses - c->first_guess > MAX_GUESSES)
        return;
    if (out->n_guesses == out->guess_capacity) {
        size_t capacity = out->guess_capacity ? 2 * out->guess_capacity : 1024;
        struct guess *guess = realloc(out->guess, capacity * sizeof *guess);
        c->no_memory = !guess;
        if (!guess)
            return;
        out->guess = guess;
        out->guess_capacity = capacity;
    }
    unsigned square = grid->where >> 6 & 3;
    double size = ldexp(1, -(int)(grid->where >> 8));
    double s = (square == 1 || square == 2) + (grid->x + 0.5) * size;
    double t = (square >= 2) + (grid->y + 0.5) * size;
    out->guess[out->n_guesses++] = (struct guess){
        .node = grid->node,
        .where = (grid->where & 63) | (uint32_t)lround(s / 2 * GUESS_STEPS) << 6 |
                 (uint32_t)lround(t / 2 * GUESS_STEPS) << 19,
        .depth = (float)fmax(extent->centre[2], c->view->near),
    };
}

static void emit(struct chooser *c, unsigned shape, struct patch_grid grid,
                 const struct extent *extent)
{
    struct patch_grids *out = c->out;
    if (c->guesses) {
        add_guess(c, &grid, extent);
        return;
    }
    c->n_vertices += (grid_cells[shape / GRID_SIDES] + 1u) * (grid_cells[shape % GRID_SIDES] + 1u);
    if (c->n_vertices > GRIDS_MAX_VERTICES || c->no_memory)
        return;
    if (c->blocks[0])
        cover(c, extent);
    if (out->n_chosen == out->capacity && !grow(out)) {
        c->no_memory = true;
        return;
    }
    grid.where |= shape << 16;
    out->chosen[out->n_chosen++] = grid;
    out->first[shape + 1]++;
}

/* Sorts the chosen grids by counting. */
static void sort_by_shape(struct chooser *c)
{
    struct patch_grids *out = c->out;
    size_t next[GRID_SHAPES];
    for (int g = 0; g < GRID_SHAPES; g++) {
        next[g] = out->first[g];
        out->first[g + 1] += out->first[g];
    }
    for (size_t i = 0; i < out->n_chosen; i++)
        out->grid[next[out->chosen[i].where >> 16]++] = out->chosen[i];
}

/* The patch that a grid covers a part of. */
static void find_patch(const struct limit_tables *tables, const struct patch_grid *grid,
                       struct limit_patch *patch)
{
    const struct limit_node *node = &tables->nodes[grid->node];
    int level = grid->where & 63;
    unsigned square = grid->where >> 6 & 3;
    /* A place in its middle. The rest of a STRIP follows all levels. */
    bool rest = node->kind == LIMIT_STRIP && !square;
    double x = square == 1 || square == 2 ? 1.5 : 0.5, y = square >= 2 ? 1.5 : 0.5;
    limit_patch_of_level(patch, tables, node, rest ? level + 1 : level, ldexp(x, -level),
                         ldexp(y, -level));
}

static struct extent square_extent(const struct chooser *c, const struct patch_grid *grid,
                                   const struct limit_patch *patch)
{
    double size = ldexp(1, -(int)(grid->where >> 8)), centre[3];
    const struct limit_square part = {grid->x * size, grid->y * size, size};
    /* What extends along the view is not visible. */
    const double *axis = c->view->axis[2];
    const struct vec forward = {axis[0], axis[1], axis[2]};
    struct extent extent;
    extent.bound =
        limit_patch_bound(c->tables, patch, part, c->view->perspective ? NULL : &forward, centre);
    view_transform(c->view, centre, extent.centre);
    return extent;
}

static void choose_square(struct chooser *c, struct patch_grid grid, const struct extent *extent);

/* Too large for the finest grid: chooses four quarters, each with its own bounds. */
static void choose_quarters(struct chooser *c, struct patch_grid grid)
{
    struct limit_patch patch;
    find_patch(c->tables, &grid, &patch);
    for (uint32_t i = 0; i < 4; i++) {
        struct patch_grid quarter = {grid.node, grid.where + (1u << 8), 2 * grid.x + (i & 1),
                                     2 * grid.y + (i >> 1)};
        struct extent extent = square_extent(c, &quarter, &patch);
        choose_square(c, quarter, &extent);
    }
}

/* Finds the grid with fewest cells whose triangles deviate at most by an eighth of `allowed`. False
 * if even the finest deviates more. */
static bool find_shape(const struct limit_bound *bound, double allowed, unsigned *shape)
{
    double u = bound->u / allowed, mixed = bound->mixed / allowed, v = bound->v / allowed;
    double border_u = bound->border_u / allowed, border_v = bound->border_v / allowed;
    unsigned fewest = UINT_MAX;
    for (unsigned i = 0; i < GRID_SIDES && grid_cells[i] < fewest; i++) {
        double m = grid_cells[i], left = 1 - u / (m * m);
        if (left <= 0 || border_u > m * m)
            continue;
        /* v / n^2 + 2 mixed / (m n) = left */
        double n =
            fmax((mixed / m + sqrt(mixed / m * (mixed / m) + left * v)) / left, sqrt(border_v));
        unsigned k = 0;
        while (k < GRID_SIDES && grid_cells[k] < n)
            k++;
        if (k == GRID_SIDES || grid_cells[i] * grid_cells[k] >= fewest)
            continue;
        fewest = grid_cells[i] * grid_cells[k];
        *shape = i * GRID_SIDES + k;
    }
    return fewest < UINT_MAX;
}

static void choose_square(struct chooser *c, struct patch_grid grid, const struct extent *extent)
{
    if (is_outside(c, extent) || c->n_vertices > GRIDS_MAX_VERTICES)
        return;
    double allowed = 8 * TOLERANCE_PX / in_px(c, extent, 1);
    unsigned shape = 0;
    if (bound_bend(&extent->bound) <= allowed ||
        (!c->guesses && find_shape(&extent->bound, allowed, &shape)))
        emit(c, shape, grid, extent);
    else if (grid.where >> 8 < MAX_DEPTH)
        choose_quarters(c, grid);
    else
        emit(c, GRID_SHAPES - 1, grid, extent);
}

static void choose_regular(struct chooser *c, uint32_t node)
{
    struct extent extent = {.bound = c->tables->whole[node]};
    view_transform(c->view, c->tables->nodes[node].origin, extent.centre);
    choose_square(c, (struct patch_grid){node, 0, 0, 0}, &extent);
}

/* One quad for the whole strip if that is flat enough, else a grid for each patch across the
 * crease. */
static void choose_strip(struct chooser *c, uint32_t node)
{
    uint32_t levels = c->tables->nodes[node].levels;
    struct extent extent = {.bound = c->tables->whole[node]};
    view_transform(c->view, c->tables->nodes[node].origin, extent.centre);
    if (is_outside(c, &extent))
        return;
    if (in_px(c, &extent, bound_bend(&extent.bound)) <= 8 * TOLERANCE_PX) {
        emit(c, 0, (struct patch_grid){node, 0, 0, 0}, &extent);
        return;
    }
    for (uint32_t n = 1; n <= levels + 1; n++) {
        extent.bound = limit_level_bound(c->tables, node, n);
        uint32_t where = n <= levels ? n | 3u << 6 : levels;
        choose_square(c, (struct patch_grid){node, where, 0, 0}, &extent);
    }
}

/* Chooses rings from the outside inwards, until one quad can represent the rest, because it is
 * smaller than the tolerance or bends too little. (A ring's net extends two units in each
 * direction, so its bend counts four times; the rings inside it add their own, a geometric
 * series.) */
static void choose_corner(struct chooser *c, uint32_t node)
{
    struct extent extent = {.bound = c->tables->whole[node]};
    view_transform(c->view, c->tables->nodes[node].origin, extent.centre);
    if (is_outside(c, &extent))
        return;
    uint32_t level = 0, levels = limit_levels(&c->tables->nodes[node]);
    /* The node's own net bends four times as much as that of its first level, or somewhat less if
     * many faces meet. */
    bool is_small = in_px(c, &extent, extent.bound.radius) < TOLERANCE_PX ||
                    in_px(c, &extent, bound_bend(&extent.bound)) < 3 * TOLERANCE_PX;
    for (; level < levels && !is_small; level++) {
        extent.bound = limit_level_bound(c->tables, node, level + 1);
        if (is_outside(c, &extent))
            return;
        if (in_px(c, &extent, extent.bound.radius) < TOLERANCE_PX ||
            in_px(c, &extent, bound_bend(&extent.bound)) < TOLERANCE_PX)
            break;
        for (uint32_t square = 1; square <= 3; square++)
            choose_square(c, (struct patch_grid){node, (level + 1) | square << 6, 0, 0}, &extent);
    }
    emit(c, 0, (struct patch_grid){node, level, 0, 0}, &extent);
}

static void choose_node(struct chooser *c, uint32_t node)
{
    switch (c->tables->nodes[node].kind) {
    case LIMIT_REGULAR:
        choose_regular(c, node);
        break;
    case LIMIT_CORNER:
        choose_corner(c, node);
        break;
    case LIMIT_STRIP:
        choose_strip(c, node);
        break;
    }
}

static void choose_cluster(struct chooser *c, const struct clusters *clusters, size_t k)
{
    const struct cluster *cluster = &clusters->cluster[k];
    double centre[3];
    view_transform(c->view, cluster->centre, centre);
    if (cluster->radius < 0 || view_sides_exclude(&c->sides, centre, cluster->radius))
        return;
    size_t end = (k + 1) * CLUSTER_NODES, n = c->tables->n_nodes;
    for (size_t node = k * CLUSTER_NODES; node < (end < n ? end : n); node++)
        choose_node(c, (uint32_t)node);
}

static bool reserve_blocks(struct chooser *c, struct error *error)
{
    struct patch_grids *out = c->out;
    c->blocks[0] = (c->tile->width + COVER_BLOCK_PX - 1) / COVER_BLOCK_PX;
    c->blocks[1] = (c->tile->height + COVER_BLOCK_PX - 1) / COVER_BLOCK_PX;
    memset(out->first, 0, sizeof out->first);
    out->n_chosen = 0;
    size_t n = (size_t)c->blocks[0] * c->blocks[1];
    if (n > out->block_capacity) {
        free(out->block);
        free(out->is_covered);
        out->block = malloc(n * sizeof *out->block);
        out->is_covered = malloc(n);
        out->block_capacity = out->block && out->is_covered ? n : 0;
        if (!out->block_capacity)
            return error_set(error, ERROR_SERVER, "out of memory for the blocks of a frame");
    }
    memset(out->is_covered, 0, n);
    return true;
}

static void list_blocks(struct chooser *c)
{
    const uint8_t *covered = c->out->is_covered;
    c->out->n_blocks = 0;
    for (uint32_t y = 0; y < c->blocks[1]; y++)
        for (uint32_t x = 0; x < c->blocks[0]; x++)
            if (*covered++)
                c->out->block[c->out->n_blocks++] = x | y << 16;
}

bool patch_grids_too_many(struct error *error)
{
    return error_set(error, ERROR_REQUEST,
                     "camera: the view would take more than %u grid vertices: move it away from "
                     "the model, or make the picture smaller",
                     GRIDS_MAX_VERTICES);
}

/* Chooses what clusters first to end - 1 may show in the tile. False: no memory. */
static bool choose_clusters(struct chooser *c, const struct clusters *clusters, size_t first,
                            size_t end, struct error *error)
{
    view_sides_init(&c->sides, c->view, c->tile);
    for (size_t k = first; k < end; k++)
        choose_cluster(c, clusters, k);
    return !c->no_memory ||
           error_set(error, ERROR_SERVER, "out of memory for the grids of a frame");
}

/* Chooses everything that the tile may show. */
static bool choose_all(struct chooser *c, const struct clusters *clusters, struct error *error)
{
    return choose_clusters(c, clusters, 0, clusters->n, error) &&
           (c->n_vertices <= GRIDS_MAX_VERTICES || patch_grids_too_many(error));
}

bool patch_grids_choose(struct patch_grids *grids, const struct limit_tables *tables,
                        const struct clusters *clusters, const struct view *view,
                        const struct tile *tile, struct error *error)
{
    struct chooser c = {.out = grids, .tables = tables, .view = view, .tile = tile};
    if (!reserve_blocks(&c, error) || !choose_all(&c, clusters, error))
        return false;
    sort_by_shape(&c);
    list_blocks(&c);
    return true;
}

bool patch_grids_choose_part(struct patch_grids *grids, const struct limit_tables *tables,
                             const struct clusters *clusters, size_t first, size_t n,
                             const struct view *view, const struct tile *tile, uint64_t *n_vertices,
                             struct error *error)
{
    struct chooser c = {.out = grids, .tables = tables, .view = view, .tile = tile};
    size_t left = clusters->n - first;
    memset(grids->first, 0, sizeof grids->first);
    grids->n_chosen = 0;
    bool ok = choose_clusters(&c, clusters, first, first + (n < left ? n : left), error);
    *n_vertices += c.n_vertices;
    return ok;
}

bool patch_grids_guess(struct patch_grids *grids, const struct limit_tables *tables,
                       const struct clusters *clusters, const struct view *view,
                       const struct tile *tile, struct error *error)
{
    struct chooser c = {.out = grids,
                        .tables = tables,
                        .view = view,
                        .tile = tile,
                        .guesses = true,
                        .first_guess = grids->n_guesses};
    if (!choose_all(&c, clusters, error))
        return false;
    if (grids->n_guesses - c.first_guess > MAX_GUESSES)
        grids->n_guesses = c.first_guess;
    return true;
}

void patch_grids_move_blocks(struct patch_grids *grids, uint32_t x, uint32_t y)
{
    for (size_t i = 0; i < grids->n_blocks; i++)
        grids->block[i] += x | y << 16;
}

void patch_grids_cut_blocks(struct patch_grids *grids, const struct tile *part)
{
    size_t n = 0;
    for (size_t i = 0; i < grids->n_blocks; i++) {
        uint32_t block = grids->block[i];
        uint32_t x = (block & 0xffff) * COVER_BLOCK_PX, y = (block >> 16) * COVER_BLOCK_PX;
        if (x >= part->x && x < part->x + part->width && y >= part->y && y < part->y + part->height)
            grids->block[n++] = block;
    }
    grids->n_blocks = n;
}

bool patch_grids_cover_all(struct patch_grids *grids, const struct tile *tile, struct error *error)
{
    struct chooser c = {.out = grids, .tile = tile};
    if (!reserve_blocks(&c, error))
        return false;
    memset(grids->is_covered, 1, (size_t)c.blocks[0] * c.blocks[1]);
    list_blocks(&c);
    return true;
}

void patch_grids_finish(struct patch_grids *grids)
{
    free(grids->grid);
    free(grids->chosen);
    free(grids->block);
    free(grids->is_covered);
    free(grids->guess);
    *grids = (struct patch_grids){0};
}
