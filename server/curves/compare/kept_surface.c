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

/* CORNERs of that many levels belong to vertices at which ten or more faces meet (corner.c). To make the points of a level
 * takes a time that grows with the number of faces, and so does the number of searches that come near the vertex: all
 * levels of such CORNERs are made once, if these bytes have room for them. */
enum { POLE_LEVELS = 38, POLE_BYTES = 16 << 20 };

/* How many levels of each CORNER are kept. */
struct keeping {
    unsigned most;  /* as parts */
    bool has_poles; /* the points of all levels at poles */
};

struct counts {
    size_t n_leaves, n_levels, n_parts;
};

/* The levels of a node that are parts. */
static unsigned parts_of(const struct limit_node *node, const struct keeping *keeping)
{
    unsigned n = levels_of(node);
    return node->kind == LIMIT_CORNER && n > keeping->most ? keeping->most : n;
}

/* The levels of a node whose points are kept. */
static unsigned kept_of(const struct limit_node *node, const struct keeping *keeping)
{
    unsigned n = levels_of(node);
    bool is_pole = node->kind == LIMIT_CORNER && n >= POLE_LEVELS;
    return is_pole && keeping->has_poles ? n : parts_of(node, keeping);
}

static struct counts count(const struct limit_tables *tables, const struct keeping *keeping)
{
    struct counts counts = {0, 0, 0};
    for (size_t i = 0; i < tables->n_nodes; i++) {
        if (!limit_has_points(&tables->nodes[i]))
            continue;
        counts.n_leaves++;
        counts.n_levels += kept_of(&tables->nodes[i], keeping);
        counts.n_parts += 3 * parts_of(&tables->nodes[i], keeping) + 1;
    }
    return counts;
}

static size_t bytes_of(const struct counts *counts)
{
    return counts->n_leaves * sizeof(struct kept_leaf) +
           counts->n_levels * sizeof(struct limit_patch);
}

/* The largest keeping, whatever the memory. */
static struct keeping choose_keeping(const struct limit_tables *tables, struct counts *counts)
{
    struct keeping keeping = {KEPT_LEVELS, false};
    *counts = count(tables, &keeping);
    keeping.has_poles = true;
    struct counts with_poles = count(tables, &keeping);
    keeping.has_poles = bytes_of(&with_poles) - bytes_of(counts) <= POLE_BYTES;
    if (keeping.has_poles)
        *counts = with_poles;
    return keeping;
}

size_t kept_surface_most_bytes(const struct limit_tables *tables, size_t *n_parts)
{
    struct counts counts;
    choose_keeping(tables, &counts);
    *n_parts = counts.n_parts;
    return bytes_of(&counts);
}

static void list_leaves(struct kept_surface *surface, const struct keeping *keeping)
{
    uint32_t level = 0;
    struct kept_leaf *to = surface->leaves;
    for (size_t i = 0; i < surface->tables->n_nodes; i++) {
        const struct limit_node *node = &surface->tables->nodes[i];
        if (!limit_has_points(node))
            continue;
        to->node = (uint32_t)i;
        to->first_level = level;
        to->n_levels = (uint8_t)parts_of(node, keeping);
        to->n_kept = (uint8_t)kept_of(node, keeping);
        to->corner = (uint32_t)surface->n_corners;
        surface->n_corners += node->kind == LIMIT_CORNER;
        level += to->n_kept;
        to++;
    }
}

bool kept_surface_init(struct kept_surface *surface, const struct limit_tables *tables,
                       size_t most_bytes, struct error *error)
{
    *surface = (struct kept_surface){.tables = tables};
    struct counts counts;
    struct keeping keeping = choose_keeping(tables, &counts);
    while (bytes_of(&counts) > most_bytes && (keeping.has_poles || keeping.most > 1)) {
        keeping.most -= keeping.has_poles ? 0 : 1;
        keeping.has_poles = false;
        counts = count(tables, &keeping);
    }
    if (bytes_of(&counts) > most_bytes)
        return error_set(error, ERROR_SERVER,
                         "the surface of %zu parts needs %zu MB, more than the %zu MB that a "
                         "computation may take",
                         counts.n_leaves, bytes_of(&counts) >> 20, most_bytes >> 20);
    surface->n_leaves = counts.n_leaves;
    surface->n_levels = counts.n_levels;
    surface->leaves = calloc(surface->n_leaves + 1, sizeof *surface->leaves);
    surface->levels = calloc(surface->n_levels + 1, sizeof *surface->levels);
    if (!surface->leaves || !surface->levels) {
        kept_surface_finish(surface);
        return error_set(error, ERROR_SERVER, "no memory for the parts of a surface");
    }
    list_leaves(surface, &keeping);
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
    return bytes_of(&(struct counts){surface->n_leaves, surface->n_levels, 0});
}

void kept_surface_fill(struct kept_surface *surface, size_t leaf)
{
    struct kept_leaf *to = &surface->leaves[leaf];
    const struct limit_node *node = kept_node(surface, leaf);
    for (unsigned k = 0; k < to->n_kept; k++) {
        int n = node->kind == LIMIT_REGULAR ? 0 : (int)k + 1;
        limit_patch_of_level(&surface->levels[to->first_level + k], surface->tables, node, n, 0, 0);
    }
    double area = 0;
    for (int k = 0; k < 4; k++) {
        struct limit_point at;
        kept_surface_evaluate(surface, leaf, k & 1 ? 0.75 : 0.25, k & 2 ? 0.75 : 0.25, &at);
        area += 0.25 * vec_length(vec_cross(at.su, at.sv));
    }
    to->area = isfinite(area) ? area : 0;
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

static void take_made(const struct kept_surface *surface, size_t leaf, int n, double x, double y,
                      struct made_levels *made, struct limit_patch *patch)
{
    int slot = n % MADE_LEVELS;
    struct limit_patch *level = &made->level[slot];
    const struct limit_node *node = kept_node(surface, leaf);
    if (made->node[slot] != node || level->level != n)
        limit_patch_of_level(level, surface->tables, node, n, x, y);
    made->node[slot] = node;
    limit_patch_in_level(patch, level, x, y);
}

/* Gets the patch that contains local (x,y) of a leaf. `made` may be NULL. */
static void find_patch(const struct kept_surface *surface, size_t leaf, double x, double y,
                       struct made_levels *made, struct limit_patch *patch)
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
    if (n - first < of->n_kept)
        limit_patch_in_level(patch, &surface->levels[of->first_level + (size_t)(n - first)], x, y);
    else if (!made)
        limit_patch_of_level(patch, surface->tables, node, n, x, y);
    else
        take_made(surface, leaf, n, x, y, made, patch);
    patch->is_vertex = is_vertex;
}

struct vec motion_turn(const struct rigid_motion *motion, struct vec v)
{
    return (struct vec){vec_dot(motion->row[0], v), vec_dot(motion->row[1], v),
                        vec_dot(motion->row[2], v)};
}

/* A cubic's four Bezier points from those of its uniform B-spline, `stride` apart. */
static void to_bezier(struct vec *p, int stride)
{
    struct vec a = p[0], b = p[stride], c = p[2 * stride], d = p[3 * stride];
    p[0] = vec_scale(vec_add(vec_mad(a, 4, b), c), 1.0 / 6);
    p[stride] = vec_scale(vec_mad(c, 2, b), 1.0 / 3);
    p[2 * stride] = vec_scale(vec_mad(b, 2, c), 1.0 / 3);
    p[3 * stride] = vec_scale(vec_add(vec_mad(b, 4, c), d), 1.0 / 6);
}

void kept_surface_net(const struct kept_surface *surface, size_t leaf, const struct kept_part *part,
                      struct vec net[16])
{
    struct limit_patch patch;
    find_patch(surface, leaf, part->x + 0.5 * part->width, part->y + 0.5 * part->height, NULL,
               &patch);
    limit_patch_points(&patch, net);
    for (int k = 0; k < 4; k++)
        to_bezier(net + 4 * k, 1);
    for (int k = 0; k < 4; k++)
        to_bezier(net + k, 4);
    const double *origin = patch.node->origin;
    for (int k = 0; k < 16; k++) {
        struct vec p = limit_frame_to_world(surface->tables, patch.node, net[k]);
        p = vec_add(p, (struct vec){origin[0], origin[1], origin[2]});
        net[k] = surface->is_moved
                     ? vec_add(motion_turn(&surface->motion, p), surface->motion.shift)
                     : p;
    }
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
    kept_surface_evaluate_again(surface, leaf, x, y, NULL, out);
}

void kept_surface_evaluate_again(const struct kept_surface *surface, size_t leaf, double x,
                                 double y, struct made_levels *made, struct limit_point *out)
{
    struct limit_patch patch;
    find_patch(surface, leaf, x, y, made, &patch);
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

/* True if the surface ends at an edge of a face. An edge without a neighbour that has no border is one point, such as a
 * pole: the surface goes on around it. */
static bool ends_at(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    const uint32_t across = tables->adjacency[face].across[edge];
    if (across == LIMIT_NO_FACE)
        return (tables->nodes[face].borders >> 4 * edge & 15) != 0;
    return tables->nodes[across >> 2].kind == LIMIT_HOLE;
}

bool kept_surface_at_border(const struct kept_surface *surface, size_t leaf, double x, double y)
{
    uint32_t face;
    double uv[2];
    kept_surface_place(surface, leaf, x, y, &face, uv);
    const double beyond[4] = {uv[1], 1 - uv[0], 1 - uv[1], uv[0]};
    for (unsigned edge = 0; edge < 4; edge++)
        if (beyond[edge] <= 1e-6 && ends_at(surface->tables, face, edge))
            return true;
    return false;
}
