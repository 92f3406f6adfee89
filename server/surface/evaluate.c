#include "server/surface/evaluate.h"

#include <math.h>
#include <string.h>

#include "server/surface/texels.h"

/* The four uniform cubic B-splines at t: values, first and second derivatives. */
struct blends {
    double value[4], first[4], second[4];
};

static struct blends blends_at(double t)
{
    double r = 1 - t;
    return (struct blends){
        .value = {r * r * r / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + r * r * (3 * r - 6)) / 6,
                  t * t * t / 6},
        .first = {-r * r / 2, t * (3 * t - 4) / 2, -r * (3 * r - 4) / 2, t * t / 2},
        .second = {r, 3 * t - 2, 3 * r - 2, t},
    };
}

/* (a,b) to what they are when seen from `turn` corners on. */
static void turn_place(unsigned turn, double a, double b, double *x, double *y)
{
    const double xs[4] = {a, b, 1 - a, 1 - b}, ys[4] = {b, 1 - a, 1 - b, a};
    *x = xs[turn & 3];
    *y = ys[turn & 3];
}

void limit_patch_of_level(struct limit_patch *patch, const struct limit_tables *tables,
                          const struct limit_node *node, int n, double x, double y)
{
    const float(*texels)[4] = (const float(*)[4])tables->texels + node->first;
    *patch = (struct limit_patch){.node = node, .s = x, .t = y};
    if (node->kind == LIMIT_CORNER) {
        int head = LIMIT_CORNER_HEAD(node->levels & ~(int)LIMIT_NO_NORMAL);
        patch->scale = (double)texels[1 + (n - 1) / 4][(n - 1) % 4];
        patch->level_x = patch->level_y = n;
        patch->s = ldexp(x, n);
        patch->t = ldexp(y, n);
        bool far_x = patch->s >= 1, far_y = patch->t >= 1;
        patch->s -= far_x;
        patch->t -= far_y;
        const float(*level)[4] = texels + head + LIMIT_LEVEL_TEXELS * (n - 1);
        patch->rows = far_y ? level + 3 : level;
        patch->column = far_x ? NULL : level + 15;
        return;
    }
    if (node->kind == LIMIT_STRIP) {
        /* Patch n = 1..levels covers 2^-n <= y <= 2^(1-n), patch levels + 1 the rest. */
        bool is_last = n > node->levels;
        texels += LIMIT_PATCH_TEXELS * (n - 1);
        patch->level_y = is_last ? n - 1 : n;
        patch->t = ldexp(y, patch->level_y) - !is_last;
    }
    patch->scale = (double)texels[0][0];
    patch->rows = texels + 1;
}

/* Which level of a node holds (x,y); beyond the last one of a CORNER lies its vertex. */
static int level_at(const struct limit_node *node, double x, double y)
{
    if (node->kind == LIMIT_REGULAR)
        return 0;
    int exponent, last = node->levels & ~(int)LIMIT_NO_NORMAL;
    double nearest = node->kind == LIMIT_STRIP ? y : fmax(x, y);
    frexp(nearest, &exponent); /* nearest is in [2^(exponent-1), 2^exponent) */
    int n = nearest > 0 ? 1 - exponent : last + 1;
    return n < 1 ? 1 : n > last ? last + 1 : n;
}

bool limit_patch_find(const struct limit_tables *tables, const struct limit_place *place,
                      struct limit_patch *patch)
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
    int n = level_at(node, x, y);
    bool is_vertex = node->kind == LIMIT_CORNER && n > (node->levels & ~(int)LIMIT_NO_NORMAL);
    limit_patch_of_level(patch, tables, node, is_vertex ? n - 1 : n, x, y);
    patch->turn = turn;
    patch->depth = depth;
    patch->is_vertex = is_vertex;
    return true;
}

void limit_patch_points(const struct limit_patch *patch, struct vec grid[16])
{
    for (int j = 0; j < 4; j++)
        texels_read_row(patch->rows + 3 * j, patch->scale, grid + 4 * j);
    if (!patch->column)
        return;
    struct vec first[4];
    texels_read_row(patch->column, patch->scale, first);
    for (int j = 0; j < 4; j++) {
        memmove(grid + 4 * j + 1, grid + 4 * j, 3 * sizeof *grid);
        grid[4 * j] = first[j];
    }
}

struct vec limit_frame_to_world(const struct limit_tables *tables, const struct limit_node *node,
                                struct vec v)
{
    if (node->kind != LIMIT_CORNER)
        return v;
    const float *q = tables->texels[node->first];
    struct vec axis = {(double)q[0], (double)q[1], (double)q[2]};
    struct vec twice = vec_scale(vec_cross(axis, v), 2);
    return vec_add(vec_mad(v, (double)q[3], twice), vec_cross(axis, twice));
}

/* Sums of the 16 points, in the node's frame, by s and t. */
static void sum_points(const struct limit_patch *patch, struct limit_point *out)
{
    struct blends x = blends_at(patch->s), y = blends_at(patch->t);
    struct vec grid[16];
    limit_patch_points(patch, grid);
    for (int k = 0; k < 16; k++) {
        int i = k & 3, j = k >> 2;
        struct vec p = grid[k];
        out->s = vec_mad(out->s, x.value[i] * y.value[j], p);
        out->su = vec_mad(out->su, x.first[i] * y.value[j], p);
        out->sv = vec_mad(out->sv, x.value[i] * y.first[j], p);
        out->suu = vec_mad(out->suu, x.second[i] * y.value[j], p);
        out->suv = vec_mad(out->suv, x.first[i] * y.first[j], p);
        out->svv = vec_mad(out->svv, x.value[i] * y.second[j], p);
    }
}

/* limit_normal() of shaders/surface.glsl, whose comment says why. */
static void set_normal(const struct limit_patch *patch, struct limit_point *out)
{
    struct vec su = out->su, sv = out->sv, n = vec_cross(su, sv);
    double area2 = vec_dot(n, n), u2 = vec_dot(su, su), v2 = vec_dot(sv, sv);
    double bend2 = fmax(fmax(vec_dot(out->suu, out->suu), vec_dot(out->svv, out->svv)),
                        vec_dot(out->suv, out->suv));
    bool both_vanish = fmax(u2, v2) < 1e-8 * bend2;
    double lost = patch->node->kind == LIMIT_CORNER ? 1e-13 : 1e-8;
    bool vanishes = both_vanish || fmin(u2, v2) < lost * fmax(u2, v2) || !(area2 > 1e-24 * u2 * v2);
    if (vanishes) {
        double s = 0.5 - patch->s, t = 0.5 - patch->t;
        struct vec du = vec_mad(vec_scale(out->suu, s), t, out->suv);
        struct vec dv = vec_mad(vec_scale(out->suv, s), t, out->svv);
        n = both_vanish ? vec_cross(du, dv) : vec_add(vec_cross(du, sv), vec_cross(su, dv));
    }
    double largest = fmax(fmax(fabs(n.x), fabs(n.y)), fabs(n.z));
    out->has_normal = largest > 0;
    out->n = largest > 0 ? vec_unit(vec_scale(n, 1 / largest)) : (struct vec){0, 0, 0};
}

/* From derivatives by s and t to those by the place's a and b: scaled, then turned. */
static void turn_derivatives(const struct limit_patch *patch, struct limit_point *out)
{
    double x = ldexp(1, patch->level_x + patch->depth), y = ldexp(1, patch->level_y + patch->depth);
    struct vec sx = vec_scale(out->su, x), sy = vec_scale(out->sv, y);
    struct vec sxx = vec_scale(out->suu, x * x), sxy = vec_scale(out->suv, x * y);
    struct vec syy = vec_scale(out->svv, y * y);
    double sign = patch->turn >= 2 ? -1 : 1; /* two corners on, both run backwards */
    bool crossed = patch->turn & 1;          /* x is b and y is 1 - a */
    out->su = vec_scale(crossed ? sy : sx, crossed ? -sign : sign);
    out->sv = vec_scale(crossed ? sx : sy, sign);
    out->suu = crossed ? syy : sxx;
    out->suv = vec_scale(sxy, crossed ? -1 : 1);
    out->svv = crossed ? sxx : syy;
    out->luu = vec_dot(out->suu, out->n);
    out->luv = vec_dot(out->suv, out->n);
    out->lvv = vec_dot(out->svv, out->n);
}

void limit_patch_evaluate(const struct limit_tables *tables, const struct limit_patch *patch,
                          struct limit_point *out)
{
    const struct limit_node *node = patch->node;
    *out = (struct limit_point){0};
    if (patch->is_vertex) {
        out->has_normal = !(node->levels & LIMIT_NO_NORMAL);
        out->n = (struct vec){0, 0, 1};
    } else {
        sum_points(patch, out);
        set_normal(patch, out); /* in the node's own frame, as on the GPU */
        turn_derivatives(patch, out);
    }
    struct vec *const vectors[] = {&out->s,   &out->su,  &out->sv, &out->suu,
                                   &out->suv, &out->svv, &out->n};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++)
        *vectors[k] = limit_frame_to_world(tables, node, *vectors[k]);
    out->s = vec_add(out->s, (struct vec){node->origin[0], node->origin[1], node->origin[2]});
}

bool limit_evaluate_at(const struct limit_tables *tables, const struct limit_place *place,
                       struct limit_point *out)
{
    struct limit_patch patch;
    if (!limit_patch_find(tables, place, &patch))
        return false;
    limit_patch_evaluate(tables, &patch, out);
    return true;
}

bool limit_evaluate(const struct limit_tables *tables, uint32_t face, double u, double v,
                    struct limit_point *out)
{
    const struct limit_place place = {.node = face, .a = u, .b = v};
    return limit_evaluate_at(tables, &place, out);
}
