#include "server/curves/compare/kept_surface.h"

#include <math.h>
#include <stdlib.h>

/* The number of levels of a node, counted as limit_patch_of_level() counts them. */
static unsigned levels_of(const struct limit_node *node)
{
    return node->kind == LIMIT_CORNER  ? limit_levels(node)
           : node->kind == LIMIT_STRIP ? node->levels + 1u
                                       : 1;
}

static unsigned kept_of(const struct limit_node *node, unsigned most)
{
    unsigned n = levels_of(node);
    return node->kind == LIMIT_CORNER && n > most ? most : n;
}

/* The number of leaves, and of their levels if at most `most` levels of each CORNER are kept. */
static void count(const struct limit_tables *tables, unsigned most, size_t *n_leaves,
                  size_t *n_levels)
{
    *n_leaves = *n_levels = 0;
    for (size_t i = 0; i < tables->n_nodes; i++) {
        if (!limit_has_points(&tables->nodes[i]))
            continue;
        ++*n_leaves;
        *n_levels += kept_of(&tables->nodes[i], most);
    }
}

static size_t bytes_of(size_t n_leaves, size_t n_levels)
{
    return n_leaves * sizeof(struct kept_leaf) + n_levels * sizeof(struct limit_patch);
}

size_t kept_surface_most_bytes(const struct limit_tables *tables, size_t *n_parts)
{
    size_t n_leaves, n_levels;
    count(tables, KEPT_LEVELS, &n_leaves, &n_levels);
    *n_parts = 3 * n_levels + n_leaves;
    return bytes_of(n_leaves, n_levels);
}

bool kept_surface_init(struct kept_surface *surface, const struct limit_tables *tables,
                       size_t most_bytes, struct error *error)
{
    *surface = (struct kept_surface){.tables = tables};
    unsigned most = KEPT_LEVELS;
    count(tables, most, &surface->n_leaves, &surface->n_levels);
    while (most > 1 && bytes_of(surface->n_leaves, surface->n_levels) > most_bytes)
        count(tables, --most, &surface->n_leaves, &surface->n_levels);
    if (bytes_of(surface->n_leaves, surface->n_levels) > most_bytes)
        return error_set(error, ERROR_SERVER,
                         "the surface of %zu parts needs %zu MB, more than the %zu MB that a "
                         "computation may take",
                         surface->n_leaves, bytes_of(surface->n_leaves, surface->n_levels) >> 20,
                         most_bytes >> 20);
    surface->leaves = calloc(surface->n_leaves + 1, sizeof *surface->leaves);
    surface->levels = calloc(surface->n_levels + 1, sizeof *surface->levels);
    if (!surface->leaves || !surface->levels) {
        kept_surface_finish(surface);
        return error_set(error, ERROR_SERVER, "no memory for the parts of a surface");
    }
    uint32_t level = 0;
    size_t leaf = 0;
    for (size_t i = 0; i < tables->n_nodes; i++) {
        if (!limit_has_points(&tables->nodes[i]))
            continue;
        struct kept_leaf *to = &surface->leaves[leaf++];
        to->node = (uint32_t)i;
        to->first_level = level;
        to->n_levels = (uint8_t)kept_of(&tables->nodes[i], most);
        level += to->n_levels;
    }
    return true;
}

void kept_surface_finish(struct kept_surface *surface)
{
    free(surface->leaves);
    free(surface->levels);
    *surface = (struct kept_surface){0};
}

size_t kept_surface_bytes(const struct kept_surface *surface)
{
    return bytes_of(surface->n_leaves, surface->n_levels);
}

void kept_surface_fill(struct kept_surface *surface, size_t leaf)
{
    struct kept_leaf *to = &surface->leaves[leaf];
    const struct limit_node *node = kept_node(surface, leaf);
    for (unsigned k = 0; k < to->n_levels; k++) {
        int n = node->kind == LIMIT_REGULAR ? 0 : (int)k + 1;
        limit_patch_of_level(&surface->levels[to->first_level + k], surface->tables, node, n, 0, 0);
    }
    double area = 0;
    for (int k = 0; k < 4; k++) {
        struct limit_point at;
        kept_surface_evaluate(surface, leaf, k & 1 ? 0.75 : 0.25, k & 2 ? 0.75 : 0.25, &at);
        area += 0.25 * vec_length(vec_cross(at.su, at.sv));
    }
    to->area = isfinite(area) ? (float)area : 0;
}

unsigned kept_surface_parts(const struct kept_surface *surface, size_t leaf,
                            struct kept_part parts[KEPT_PARTS])
{
    const struct limit_node *node = kept_node(surface, leaf);
    unsigned n_levels = surface->leaves[leaf].n_levels, n = 0;
    if (node->kind == LIMIT_REGULAR) {
        parts[n++] = (struct kept_part){0, 0, 1, 1, false};
    } else if (node->kind == LIMIT_STRIP) {
        for (unsigned k = 1; k <= n_levels && n < KEPT_PARTS; k++) {
            double height = ldexp(1, -(int)(k < n_levels ? k : k - 1));
            parts[n++] = (struct kept_part){0, k < n_levels ? height : 0, 1, height, false};
        }
    } else {
        double h = 1;
        for (unsigned k = 0; k < n_levels; k++) {
            h *= 0.5;
            parts[n++] = (struct kept_part){h, 0, h, h, false};
            parts[n++] = (struct kept_part){h, h, h, h, false};
            parts[n++] = (struct kept_part){0, h, h, h, false};
        }
        parts[n++] = (struct kept_part){0, 0, h, h, true};
    }
    return n;
}

void kept_surface_patch(const struct kept_surface *surface, size_t leaf, double x, double y,
                        struct limit_patch *patch)
{
    const struct kept_leaf *of = &surface->leaves[leaf];
    const struct limit_node *node = kept_node(surface, leaf);
    int last = (int)levels_of(node), first = node->kind == LIMIT_REGULAR ? 0 : 1;
    int n = limit_level_at(node, fabs(x), fabs(y));
    bool is_vertex = node->kind == LIMIT_CORNER && x == 0 && y == 0;
    if (node->kind == LIMIT_CORNER && n > last) {
        /* Beside the vertex derivatives are wanted, which the vertex has not: those of the last level. */
        double least = ldexp(1, -last);
        n = last;
        x = fmax(x, least);
        y = fmax(y, least);
    }
    if (n - first < of->n_levels)
        limit_patch_in_level(patch, &surface->levels[of->first_level + (size_t)(n - first)], x, y);
    else
        limit_patch_of_level(patch, surface->tables, node, n, x, y);
    patch->is_vertex = is_vertex;
}

struct vec motion_turn(const struct rigid_motion *motion, struct vec v)
{
    return (struct vec){vec_dot(motion->row[0], v), vec_dot(motion->row[1], v),
                        vec_dot(motion->row[2], v)};
}

static void move(const struct rigid_motion *motion, struct limit_point *at)
{
    struct vec *const vectors[] = {&at->s, &at->su, &at->sv, &at->suu, &at->suv, &at->svv, &at->n};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        *vectors[k] = motion_turn(motion, *vectors[k]);
    at->s = vec_add(at->s, motion->shift);
}

void kept_surface_evaluate(const struct kept_surface *surface, size_t leaf, double x, double y,
                           struct limit_point *out)
{
    struct limit_patch patch;
    kept_surface_patch(surface, leaf, x, y, &patch);
    limit_patch_evaluate(surface->tables, &patch, out);
    if (surface->is_moved)
        move(&surface->motion, out);
}

void kept_surface_place(const struct kept_surface *surface, size_t leaf, double x, double y,
                        uint32_t *face, double uv[2])
{
    const struct limit_node *node = kept_node(surface, leaf);
    double side = ldexp(1, -node->depth);
    double cx = node->cell & 0xffff, cy = node->cell >> 16;
    /* Local (0,0) is the cell's corner `rotation`. */
    const double us[4] = {x, 1 - y, 1 - x, y}, vs[4] = {y, x, 1 - y, 1 - x};
    *face = node->face;
    uv[0] = (cx + us[node->rotation & 3]) * side;
    uv[1] = (cy + vs[node->rotation & 3]) * side;
}

bool kept_surface_at_border(const struct kept_surface *surface, size_t leaf, double x, double y)
{
    uint32_t face;
    double uv[2];
    kept_surface_place(surface, leaf, x, y, &face, uv);
    const double beyond[4] = {uv[1], 1 - uv[0], 1 - uv[1], uv[0]};
    const struct limit_adjacency *beside = &surface->tables->adjacency[face];
    for (int edge = 0; edge < 4; edge++) {
        if (beyond[edge] > 1e-6)
            continue;
        uint32_t across = beside->across[edge];
        if (across == LIMIT_NO_FACE || surface->tables->nodes[across >> 2].kind == LIMIT_HOLE)
            return true;
    }
    return false;
}
