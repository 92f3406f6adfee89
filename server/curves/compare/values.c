/* The measures at one place: README.md, "Comparing two surfaces". */
#include <math.h>

#include "server/curves/compare/parts.h"

/* Rays closer than this to a direction in which s has no value do not count: there the lines of any light run together
 * to a point, and no change is so small that it would not move them. A sine: 3 degrees. */
static const double LEAST_LINE_SINE = 0.05;

struct comparison_place comparison_place_of(const struct kept_surface *surface, size_t leaf,
                                            double x, double y, struct vec position)
{
    struct comparison_place place = {.position = position};
    double uv[2];
    kept_surface_place(surface, leaf, x, y, &place.face, uv);
    place.u = uv[0];
    place.v = uv[1];
    return place;
}

/* The part of the way from the point to its counterpart that runs along the surface. */
static double aside_of(const struct comparison_values *at)
{
    struct vec way = vec_sub(at->to.at.s, at->from.s);
    return vec_length(vec_mad(way, -vec_dot(way, at->from.n), at->from.n));
}

/* The principal curvature with the larger magnitude, by the normal n (evaluate.h); NAN where it has no value. */
static double curvature_of(const struct limit_point *at)
{
    double e = vec_dot(at->su, at->su), f = vec_dot(at->su, at->sv), g = vec_dot(at->sv, at->sv);
    double det = e * g - f * f;
    if (!(det > 0))
        return NAN;
    double mean = (at->luu * g - 2 * at->luv * f + at->lvv * e) / (2 * det);
    double gauss = (at->luu * at->lvv - at->luv * at->luv) / det;
    double root = sqrt(fmax(mean * mean - gauss, 0));
    return mean < 0 ? mean - root : mean + root;
}

/* Two perpendicular unit tangents, and the change of the normal along them. */
static bool set_turns(const struct limit_point *at, struct vec along[2], struct vec turn[2])
{
    struct vec n = at->n, su = at->su, sv = at->sv;
    double e = vec_dot(su, su), f = vec_dot(su, sv), g = vec_dot(sv, sv), det = e * g - f * f;
    if (!(det > 0))
        return false;
    along[0] = vec_unit(su);
    along[1] = vec_cross(n, along[0]);
    for (int k = 0; k < 2; k++) {
        /* The tangent is p su + q sv. */
        double au = vec_dot(along[k], su), av = vec_dot(along[k], sv);
        double p = (au * g - av * f) / det, q = (av * e - au * f) / det;
        /* dn.su = -(p luu + q luv), dn.sv = -(p luv + q lvv), dn.n = 0 */
        double du = -(p * at->luu + q * at->luv), dv = -(p * at->luv + q * at->lvv);
        turn[k] = vec_mad(vec_scale(su, (du * g - dv * f) / det), (dv * e - du * f) / det, sv);
    }
    return true;
}

/* What counts of a value that grows by `slope` for each unit of length along the surface. Where a shift of the place by the
 * limit of the distance makes more than the value's own limit, as in a narrow fillet, only what that shift does not
 * explain. */
static double unexplained(const struct comparison *comparison, double value,
                          enum comparison_measure measure, double slope)
{
    double limit = comparison->setup.limit[measure];
    double explained = slope * comparison->setup.limit[COMPARISON_DISTANCE];
    return value > limit && explained > limit ? fmax(value - explained, 0) : value;
}

/* Where a light's coordinate changes by less than this over the whole model, in spacings, its gradient is rounding, and
 * a shift has no length on the surface. */
static const double LEAST_CHANGE = 1e-3;

/* The largest shift of all lights, in spacings and in length on the surface. */
static void measure_lines(const struct comparison *comparison, struct comparison_values *at,
                          struct vec other_normal)
{
    struct vec along[2], turn[2];
    bool has_turns = false, is_same = true;
    for (uint32_t i = 0; i < comparison->setup.n_lights; i++) {
        const struct line_map *light = &comparison->setup.lights[i];
        struct line_position a = line_position_at(light, at->from.s, at->from.n);
        struct line_position b = line_position_at(light, at->to.at.s, other_normal);
        if (fmin(a.sine, b.sine) < LEAST_LINE_SINE)
            continue;
        at->is_unlit = at->is_unlit || a.known != b.known;
        if (!a.known || !b.known || !(a.met || b.met))
            continue;
        double shift = line_shift(light, &a, &b), length = 0;
        if (shift > 0) {
            if (is_same)
                has_turns = set_turns(&at->from, along, turn);
            is_same = false;
            double density =
                has_turns ? line_density(light, at->from.s, at->from.n, along, turn) : 0;
            length = density * comparison->result.size > LEAST_CHANGE
                         ? fmin(shift / density, comparison->result.size)
                         : (double)NAN;
            shift = unexplained(comparison, shift, COMPARISON_LINES, density);
        }
        at->value[COMPARISON_LINES] = fmax(at->value[COMPARISON_LINES], shift);
        at->value[COMPARISON_LINE_LENGTH] = fmax(at->value[COMPARISON_LINE_LENGTH], length);
    }
}

static void measure_curvature(const struct comparison *comparison, struct comparison_values *at)
{
    double a = curvature_of(&at->from), b = (at->is_rewound ? -1 : 1) * curvature_of(&at->to.at);
    /* Radii of more than the model's size are flat. */
    double least = 1 / comparison->result.size;
    at->value[COMPARISON_CURVATURE] = fabs(b - a) / fmax(fmax(fabs(a), fabs(b)), least);
}

static void measure_normals(const struct comparison *comparison, struct comparison_values *at)
{
    struct vec n = at->from.n, m = at->to.at.n;
    at->is_rewound = vec_dot(n, m) < 0;
    if (at->is_rewound)
        m = vec_scale(m, -1);
    double angle = atan2(vec_length(vec_cross(n, m)), vec_dot(n, m)) * (180 / M_PI);
    if (angle > comparison->setup.limit[COMPARISON_NORMAL]) {
        double k = fmax(fabs(curvature_of(&at->from)), fabs(curvature_of(&at->to.at)));
        angle = unexplained(comparison, angle, COMPARISON_NORMAL, k * (180 / M_PI));
    }
    at->value[COMPARISON_NORMAL] = angle;
    measure_lines(comparison, at, m);
    if (comparison->setup.has_curvature)
        measure_curvature(comparison, at);
}

/* At the vertex of a CORNER, where normals may turn infinitely fast, as at a smooth corner of a border: no shift of the
 * place is so small that they would agree. */
static bool is_vertex(const struct kept_surface *surface, size_t leaf, double x, double y)
{
    return x == 0 && y == 0 && kept_node(surface, leaf)->kind == LIMIT_CORNER;
}

void comparison_measure_at(const struct comparison *comparison, enum comparison_side side,
                           size_t leaf, double x, double y, const struct closest_start *start,
                           struct comparison_values *out)
{
    const struct comparison_part *own = &comparison->part[side], *other = &comparison->part[!side];
    out->is_covered = out->is_rewound = out->is_unlit = false;
    for (int k = 0; k < COMPARISON_MEASURES; k++)
        out->value[k] = NAN;
    kept_surface_evaluate(&own->surface, leaf, x, y, &out->from);
    if (out->from.has_normal)
        closest_find(&other->tree, &comparison->rules, out->from.s, out->from.n, start, &out->to);
    else
        closest_nearest(&other->tree, out->from.s, &out->to);
    bool is_missing = out->to.kind == CLOSEST_NONE ||
                      (out->to.kind == CLOSEST_BORDER &&
                       aside_of(out) > comparison->setup.limit[COMPARISON_DISTANCE]);
    if (is_missing)
        return;
    out->is_covered = true;
    out->value[COMPARISON_DISTANCE] = out->to.distance;
    bool has_normals = out->from.has_normal && out->to.at.has_normal;
    if (has_normals && !is_vertex(&own->surface, leaf, x, y) &&
        !is_vertex(&other->surface, out->to.leaf, out->to.x, out->to.y))
        measure_normals(comparison, out);
}
