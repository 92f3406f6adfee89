#include "server/surface/evaluate.h"

#include <math.h>

/* Evaluates position and derivatives in the node's frame, by s and t. */
static void evaluate_points(const struct limit_patch *patch, struct limit_point *out)
{
    struct bicubic_point at;
    bicubic_evaluate(&patch->points, patch->s, patch->t, &at);
    out->s = at.p;
    out->su = at.ps;
    out->sv = at.pt;
    out->suu = at.pss;
    out->suv = at.pst;
    out->svv = at.ptt;
}

/* limit_normal() of shaders/surface.glsl in double: README.md 4.6. */
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

/* Converts derivatives by s and t to derivatives by the place's a and b: scales them, then turns
 * them. */
static void turn_derivatives(const struct limit_patch *patch, struct limit_point *out)
{
    double x = ldexp(1, patch->level_x + patch->depth), y = ldexp(1, patch->level_y + patch->depth);
    struct vec sx = vec_scale(out->su, x), sy = vec_scale(out->sv, y);
    struct vec sxx = vec_scale(out->suu, x * x), sxy = vec_scale(out->suv, x * y);
    struct vec syy = vec_scale(out->svv, y * y);
    double sign = patch->turn >= 2 ? -1 : 1; /* two corners further, both are reversed */
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
        evaluate_points(patch, out);
        set_normal(patch, out); /* in the node's frame, as on the GPU */
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
