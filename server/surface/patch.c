#include "server/surface/patch.h"

#include <math.h>

#include "server/surface/bound.h"
#include "server/surface/texels.h"

/* Converts (a,b) to the view from `turn` corners further. */
static void turn_place(unsigned turn, double a, double b, double *x, double *y)
{
    const double xs[4] = {a, b, 1 - a, 1 - b}, ys[4] = {b, 1 - a, 1 - b, a};
    *x = xs[turn & 3];
    *y = ys[turn & 3];
}

/* Finds the texels of level n and, separately, the scale and patch->exact: in the tables, or in what is made now. */
static const float (*level_texels(struct limit_patch *patch, const struct limit_tables *tables,
                                  const struct limit_node *node, int n))[4]
{
    if (!tables->texels) {
        tables->source->make(tables->source, tables, (uint32_t)(node - tables->nodes), (unsigned)n,
                             &patch->made, NULL);
        patch->points.scale = (double)patch->made.texels[0][0];
        patch->exact = patch->made.points;
        return (const float(*)[4])patch->made.texels + 1;
    }
    patch->exact = NULL;
    const float(*texels)[4] = (const float(*)[4])tables->texels + node->first;
    if (node->kind == LIMIT_CORNER) {
        patch->points.scale = (double)texels[1 + (n - 1) / 4][(n - 1) % 4];
        return texels + LIMIT_CORNER_HEAD((int)limit_levels(node)) + LIMIT_LEVEL_TEXELS * (n - 1);
    }
    if (node->kind == LIMIT_STRIP)
        texels += LIMIT_PATCH_TEXELS * (n - 1);
    patch->points.scale = (double)texels[0][0];
    return texels + 1;
}

/* Sets all but the points of the level, which patch->texels has. */
static void choose_patch(struct limit_patch *patch, const struct limit_node *node, int n, double x,
                         double y)
{
    patch->node = node;
    patch->s = x;
    patch->t = y;
    patch->level_x = patch->level_y = patch->depth = 0;
    patch->turn = 0;
    patch->is_vertex = false;
    patch->level = n;
    patch->points.column = NULL;
    patch->points.rows = patch->texels;
    patch->points.exact = patch->exact;
    patch->points.stride = 4;
    if (node->kind == LIMIT_CORNER) {
        patch->level_x = patch->level_y = n;
        patch->s = ldexp(x, n);
        patch->t = ldexp(y, n);
        bool far_x = patch->s >= 1, far_y = patch->t >= 1;
        patch->s -= far_x;
        patch->t -= far_y;
        patch->points.rows = far_y ? patch->texels + 3 : patch->texels;
        patch->points.column = far_x ? NULL : patch->texels + 15;
        patch->points.stride = LIMIT_LEVEL_SIDE;
        if (patch->exact)
            patch->points.exact = patch->exact + LIMIT_LEVEL_SIDE * far_y + far_x;
    } else if (node->kind == LIMIT_STRIP) {
        /* Patch n = 1..levels covers 2^-n <= y <= 2^(1-n), patch levels + 1 the rest. */
        bool is_last = n > node->levels;
        patch->level_y = is_last ? n - 1 : n;
        patch->t = ldexp(y, patch->level_y) - !is_last;
    }
}

void limit_patch_of_level(struct limit_patch *patch, const struct limit_tables *tables,
                          const struct limit_node *node, int n, double x, double y)
{
    patch->texels = level_texels(patch, tables, node, n);
    choose_patch(patch, node, n, x, y);
}

void limit_patch_in_level(struct limit_patch *patch, const struct limit_patch *kept, double x,
                          double y)
{
    patch->texels = kept->texels;
    patch->exact = kept->exact;
    patch->points.scale = kept->points.scale;
    choose_patch(patch, kept->node, kept->level, x, y);
}

int limit_level_at(const struct limit_node *node, double x, double y)
{
    if (node->kind == LIMIT_REGULAR)
        return 0;
    int exponent, last = (int)limit_levels(node);
    double nearest = node->kind == LIMIT_STRIP ? y : fmax(x, y);
    frexp(nearest, &exponent); /* nearest is in [2^(exponent-1), 2^exponent) */
    int n = nearest > 0 ? 1 - exponent : last + 1;
    return n < 1 ? 1 : n > last ? last + 1 : n;
}

static bool find(const struct limit_tables *tables, const struct limit_place *place,
                 struct limit_patch *patch, bool again)
{
    const struct limit_node *node = &tables->nodes[place->node];
    double a = place->a, b = place->b, x, y;
    int depth = 0;
    for (; node->kind == LIMIT_SPLIT; depth++) {
        bool far_a = a >= 0.5, far_b = b >= 0.5;
        unsigned child = far_a ? (far_b ? 2 : 1) : (far_b ? 3 : 0);
        node = &tables->nodes[node->first + ((place->corner + child) & 3)];
        a = 2 * a - far_a;
        b = 2 * b - far_b;
    }
    if (node->kind == LIMIT_HOLE)
        return false;
    unsigned turn = (node->rotation - place->corner) & 3;
    turn_place(turn, a, b, &x, &y);
    int n = limit_level_at(node, x, y);
    bool is_vertex = node->kind == LIMIT_CORNER && n > (int)limit_levels(node);
    n -= is_vertex;
    if (again && patch->node == node && patch->level == n)
        choose_patch(patch, node, n, x, y);
    else
        limit_patch_of_level(patch, tables, node, n, x, y);
    patch->turn = turn;
    patch->depth = depth;
    patch->is_vertex = is_vertex;
    return true;
}

bool limit_patch_find(const struct limit_tables *tables, const struct limit_place *place,
                      struct limit_patch *patch)
{
    return find(tables, place, patch, false);
}

bool limit_patch_find_again(const struct limit_tables *tables, const struct limit_place *place,
                            struct limit_patch *patch)
{
    return find(tables, place, patch, true);
}

struct vec limit_turn_to_world(const struct limit_tables *tables, const struct limit_node *node,
                               struct vec v)
{
    const float *q = tables->heads[node - tables->nodes].frame;
    struct vec axis = {(double)q[0], (double)q[1], (double)q[2]};
    struct vec twice = vec_scale(vec_cross(axis, v), 2);
    return vec_add(vec_mad(v, (double)q[3], twice), vec_cross(axis, twice));
}

double limit_patch_points(const struct limit_patch *patch, struct vec grid[16])
{
    bicubic_read(&patch->points, grid);
    return patch->points.scale;
}

struct limit_bound limit_patch_bound(const struct limit_tables *tables,
                                     const struct limit_patch *patch, struct limit_square part,
                                     const struct vec *unseen, double centre[3])
{
    struct vec whole[16], grid[16], middle = {0, 0, 0};
    const struct limit_node *node = patch->node;
    bicubic_read(&patch->points, whole);
    bicubic_cut(whole, part.s, part.t, part.size, grid);
    for (int k = 0; k < 16; k++)
        middle = vec_mad(middle, 1.0 / 16, grid[k]);
    for (int k = 0; k < 16; k++)
        grid[k] = vec_sub(grid[k], middle);
    struct limit_bound bound = bound_of_grid(grid, 4, false, true);
    for (int k = 0; unseen && k < 16; k++) {
        struct vec p = limit_frame_to_world(tables, node, grid[k]);
        grid[k] = vec_mad(p, -vec_dot(p, *unseen), *unseen);
    }
    struct limit_bound seen = unseen ? bound_of_grid(grid, 4, false, false) : bound;
    struct vec at = limit_frame_to_world(tables, node, middle);
    centre[0] = node->origin[0] + at.x;
    centre[1] = node->origin[1] + at.y;
    centre[2] = node->origin[2] + at.z;
    return bound_bend(&seen) < bound_bend(&bound) ? seen : bound;
}
