#include "server/curves/breaks/measure.h"

#include <math.h>
#include <string.h>

#include "server/curves/breaks/joints.h"
#include "server/surface/evaluate.h"

/* Nearer to its ends than this part of an edge no curvature is measured: around an extraordinary vertex it need not
 * have a bound. */
static const double LEAST_AT = 1.0 / 256;
/* Curvatures below this part of 1 / the edge's length count as flat: the jump from one flat side to another is no
 * percentage. Rounding of the stored points causes 1e-6. */
static const double FLAT = 1e-3;
/* The ring on which the curvature around a vertex is measured, in parts of a face. */
static const double RING = 1.0 / 64;

/* Normals of equal sides differ by this many degrees, because points are stored in single precision: so much more than
 * the limit is not out of tolerance. */
static const double ANGLE_FLOOR = 1e-5;

enum { N_GAUSS = 8, N_END = 3, N_PLACES = N_GAUSS + 2 * N_END, GOLDEN_STEPS = 18, RING_PLACES = 9 };
/* Places and weights of Gauss and Legendre on [-1, 1]; the other half by symmetry. */
static const double GAUSS_AT[N_GAUSS / 2] = {0.1834346424956498, 0.5255324099163290,
                                             0.7966664774136267, 0.9602898564975363};
static const double GAUSS_WEIGHT[N_GAUSS / 2] = {0.3626837833783620, 0.3137066458778873,
                                                 0.2223810344533745, 0.1012285362903763};

/* Gauss place i of N_GAUSS on [0, 1], in ascending order. */
static double gauss_at(int i)
{
    return i < N_GAUSS / 2 ? 0.5 - 0.5 * GAUSS_AT[N_GAUSS / 2 - 1 - i]
                           : 0.5 + 0.5 * GAUSS_AT[i - N_GAUSS / 2];
}

static double gauss_weight(int i)
{
    return 0.5 * GAUSS_WEIGHT[i < N_GAUSS / 2 ? N_GAUSS / 2 - 1 - i : i - N_GAUSS / 2];
}

/* An edge that is measured at many places. */
struct walk {
    const struct break_setup *setup;
    const struct surface_edge *edge;
    double length;
    struct limit_patch patch[2]; /* the latest of each side, whose points need not be made again */
};

/* --- one side of an edge at one place */

struct side {
    struct vec x, n;
    struct vec along[2]; /* unit tangents: along the edge, and across it */
    struct vec turn[2];  /* change of the normal along them */
    double across;       /* curvature across the edge */
    double speed;        /* length of the derivative along the edge */
    bool has_curvature;
};

/* a and b with a su + b sv = `tangent`, which lies in the tangent plane. */
static void solve(const struct limit_point *point, struct vec tangent, double out[2])
{
    double e = vec_dot(point->su, point->su), f = vec_dot(point->su, point->sv),
           g = vec_dot(point->sv, point->sv), det = e * g - f * f;
    double p = vec_dot(tangent, point->su), q = vec_dot(tangent, point->sv);
    out[0] = (g * p - f * q) / det;
    out[1] = (e * q - f * p) / det;
}

/* Fills in side i at `at` of its own edge, `inside` parts of the face away from it. The first tangent points to the
 * next corner. False where there is no normal. */
static bool side_at(struct walk *walk, int i, double at, double inside, struct side *side)
{
    const struct limit_tables *tables = walk->setup->tables;
    const struct limit_place place = {walk->edge->face[i], walk->edge->edge[i], at, inside};
    struct limit_point point;
    if (!limit_patch_find_again(tables, &place, &walk->patch[i]))
        return false;
    limit_patch_evaluate(tables, &walk->patch[i], &point);
    if (!point.has_normal)
        return false;
    *side = (struct side){.x = point.s, .n = point.n, .speed = vec_length(point.su)};
    side->along[0] = vec_unit(point.su);
    side->along[1] = vec_cross(point.n, side->along[0]);
    double area = vec_length(vec_cross(point.su, point.sv));
    side->has_curvature = area > 1e-9 * side->speed * vec_length(point.sv);
    for (int t = 0; t < 2 && side->has_curvature; t++) {
        double w[2], on[2], k[2];
        solve(&point, side->along[t], w);
        /* The part of the second form along each derivative; the normal turns against it. */
        double to_u = w[0] * point.luu + w[1] * point.luv;
        double to_v = w[0] * point.luv + w[1] * point.lvv;
        for (int j = 0; j < 2; j++) {
            solve(&point, side->along[j], on);
            k[j] = on[0] * to_u + on[1] * to_v;
        }
        side->turn[t] =
            vec_scale(vec_mad(vec_scale(side->along[0], k[0]), k[1], side->along[1]), -1);
        if (t == 1)
            side->across = k[1];
    }
    return true;
}

/* Turns a side over: its face is wound against the other one. */
static void flip(struct side *side)
{
    side->n = vec_scale(side->n, -1);
    side->across = -side->across;
    for (int i = 0; i < 2; i++)
        side->turn[i] = vec_scale(side->turn[i], -1);
}

static double angle_between(struct vec a, struct vec b)
{
    return atan2(vec_length(vec_cross(a, b)), vec_dot(a, b)) * (180 / M_PI);
}

/* --- both sides */

struct both {
    double value[BREAK_MEASURES]; /* NaN: none */
    uint8_t kink_light, jump_light;
    double shift;
    struct vec x;
    double speed;
};

/* The direction of a light's lines on one side: along the surface, across the gradient. Zero where it is not known or
 * where lines have no direction. */
static struct vec line_tangent(const struct line_map *light, int axis, const struct side *side)
{
    struct vec gradient = {0, 0, 0};
    for (int i = 0; i < 2; i++) {
        struct line_position ends[2];
        double length = line_step(light, side->x, side->n, side->along[i], side->turn[i], ends);
        if (length == 0)
            continue;
        if (!ends[0].known || !ends[1].known)
            return (struct vec){0, 0, 0};
        double slope = line_change(light, axis, &ends[0], &ends[1]) / length;
        gradient = vec_mad(gradient, slope, side->along[i]);
    }
    return vec_cross(side->n, gradient);
}

/* Measures kink and jump of one light. */
static void measure_light(const struct break_setup *setup, uint8_t index,
                          const struct side sides[2], struct both *both)
{
    const struct line_map *light = &setup->lights[index];
    struct line_position at[2];
    for (int i = 0; i < 2; i++) {
        at[i] = line_position_at(light, sides[i].x, sides[i].n);
        if (!at[i].known)
            return;
    }
    double jump = line_shift(light, &at[0], &at[1]);
    if (!(both->value[BREAK_JUMP] >= jump)) {
        both->value[BREAK_JUMP] = jump;
        both->jump_light = index;
        double density = sides[0].has_curvature ? line_density(light, sides[0].x, sides[0].n,
                                                               sides[0].along, sides[0].turn)
                                                : 0;
        both->shift = density > 0 ? jump / density : NAN;
    }
    for (int axis = 0; axis < line_axes(light); axis++) {
        struct vec tangent[2];
        for (int i = 0; i < 2; i++)
            tangent[i] = sides[i].has_curvature ? line_tangent(light, axis, &sides[i])
                                                : (struct vec){0, 0, 0};
        if (vec_length(tangent[0]) == 0 || vec_length(tangent[1]) == 0)
            continue;
        double kink = angle_between(tangent[0], tangent[1]);
        if (!(both->value[BREAK_KINK] >= kink)) {
            both->value[BREAK_KINK] = kink;
            both->kink_light = index;
        }
    }
}

/* The place of the second side at `at` of the first one. */
static double place_there(const struct surface_edge *edge, double at)
{
    return edge->from + edge->by * at;
}

/* The distance of both sides. Inside one cage both have one curve, by the same parameter. At a joint it is the distance
 * from the first side's point to the nearest one of the second side's curve, to which *second moves. */
static double gap_at(struct walk *walk, double at, struct vec x, struct side *second)
{
    double there = place_there(walk->edge, at);
    struct side best = *second;
    for (int step = 0; step < 8 && walk->edge->is_joint; step++) {
        struct vec between = vec_sub(x, best.x);
        double move = vec_dot(between, best.along[0]) / best.speed;
        double next = fmin(fmax(there + move, 0), 1);
        if (!(best.speed > 0) || next == there || !side_at(walk, 1, next, 0, &best))
            break;
        if (vec_length(vec_sub(x, best.x)) > vec_length(vec_sub(x, second->x)))
            break; /* the curve bends away: the first point was nearer */
        there = next;
        *second = best;
    }
    return vec_length(vec_sub(x, second->x));
}

static void measure_curvature(const struct side sides[2], double length, struct both *both)
{
    double a = sides[0].across, b = sides[1].across;
    if (!sides[0].has_curvature || !sides[1].has_curvature)
        return;
    both->value[BREAK_CURVATURE] = fabs(a - b);
    both->value[BREAK_PERCENT] = 200 * fabs(a - b) / fmax(fabs(a) + fabs(b), FLAT / length);
}

/* Both sides of an edge of smooth surface: of a semi-sharp crease. The surface has no break there; so the normals are
 * those on both sides of the crease's rounding, and curvature is compared between the crease and there. */
static bool measure_rounding(struct walk *walk, double at, struct both *both)
{
    const struct surface_edge *edge = walk->edge;
    const double width = ldexp(1, -edge->levels);
    struct side middle, beside[2];
    if (!side_at(walk, 0, at, width, &beside[0]) ||
        !side_at(walk, 1, place_there(edge, at), width * fabs(edge->by), &beside[1]) ||
        !side_at(walk, 0, at, 0, &middle))
        return false;
    both->x = middle.x;
    both->speed = middle.speed;
    both->value[BREAK_ANGLE] = angle_between(beside[0].n, beside[1].n);
    struct side pair[2] = {middle, beside[0]};
    if (fabs(beside[1].across - middle.across) > fabs(beside[0].across - middle.across))
        pair[1] = beside[1];
    if (at >= LEAST_AT && at <= 1 - LEAST_AT)
        measure_curvature(pair, walk->length, both);
    return true;
}

static bool measure_at(struct walk *walk, double at, bool with_lights, struct both *both)
{
    const struct break_setup *setup = walk->setup;
    struct side sides[2];
    *both = (struct both){.shift = NAN};
    for (int i = 0; i < BREAK_MEASURES; i++)
        both->value[i] = NAN;
    if (walk->edge->levels != LIMIT_BORDER_SHARP)
        return measure_rounding(walk, at, both);
    if (!side_at(walk, 0, at, 0, &sides[0]) ||
        !side_at(walk, 1, place_there(walk->edge, at), 0, &sides[1]))
        return false;
    both->x = sides[0].x;
    both->speed = sides[0].speed;
    both->value[BREAK_GAP] = gap_at(walk, at, sides[0].x, &sides[1]);
    if (walk->edge->is_flipped)
        flip(&sides[1]);
    both->value[BREAK_ANGLE] = angle_between(sides[0].n, sides[1].n);
    if (at < LEAST_AT || at > 1 - LEAST_AT)
        return true;
    measure_curvature(sides, walk->length, both);
    for (uint32_t i = 0; i < setup->n_lights && with_lights; i++)
        measure_light(setup, (uint8_t)i, sides, both);
    return true;
}

/* --- the worst place */

static void keep_worst(struct break_edge *out, int measure, double at, const struct both *both)
{
    struct break_worst *worst = &out->worst[measure];
    double value = both->value[measure];
    if (isnan(value) || worst->value >= value)
        return;
    *worst = (struct break_worst){value, at, {both->x.x, both->x.y, both->x.z}};
    if (measure == BREAK_KINK)
        out->kink_light = both->kink_light;
    if (measure == BREAK_JUMP) {
        out->jump_light = both->jump_light;
        out->shift = both->shift;
    }
}

/* The value of a measure at a place, which is kept if it is the worst one. Below 0: none. */
static double probe(struct walk *walk, int measure, double at, struct break_edge *out)
{
    struct both both;
    if (!measure_at(walk, at, measure >= BREAK_KINK, &both) || isnan(both.value[measure]))
        return -1;
    keep_worst(out, measure, at, &both);
    return both.value[measure];
}

/* Looks for the largest value of a measure between two places by golden section search, to 1e-4 of their distance. */
static void refine(struct walk *walk, int measure, double low, double high, struct break_edge *out)
{
    const double part = 0.6180339887498949;
    double left = high - part * (high - low), right = low + part * (high - low);
    double at_left = probe(walk, measure, left, out);
    double at_right = probe(walk, measure, right, out);
    for (int step = 0; step < GOLDEN_STEPS; step++) {
        if (at_left >= at_right) {
            high = right;
            right = left;
            at_right = at_left;
            left = high - part * (high - low);
            at_left = probe(walk, measure, left, out);
        } else {
            low = left;
            left = right;
            at_left = at_right;
            right = low + part * (high - low);
            at_right = probe(walk, measure, right, out);
        }
    }
}

/* How many times over their limits the measures are that have one. */
static double severity_of(const struct break_limits *limits, double gap, double angle_deg,
                          double percent)
{
    double severity = 0; /* NaN counts as nothing */
    severity = fmax(severity, gap / limits->gap);
    severity = fmax(severity, angle_deg / (limits->angle_deg + ANGLE_FLOOR));
    return fmax(severity, percent / limits->curvature_percent);
}

double breaks_severity(const struct break_setup *setup, const struct break_edge *edge)
{
    return edge->kind == BREAK_SEMISHARP
               ? 0 /* the surface is smooth there */
               : severity_of(&setup->limits, edge->worst[BREAK_GAP].value,
                             edge->worst[BREAK_ANGLE].value, edge->worst[BREAK_PERCENT].value);
}

/* The length of the curve of a face's edge. */
static double length_of(const struct limit_tables *tables, uint32_t face, unsigned edge)
{
    double length = 0;
    for (int i = 0; i < N_GAUSS; i++) {
        const struct limit_place place = {.node = face, .corner = edge, .a = gauss_at(i)};
        struct limit_point point;
        if (limit_evaluate_at(tables, &place, &point))
            length += gauss_weight(i) * vec_length(point.su);
    }
    return length;
}

/* The part of [0, 1] where a quantity is above 1 that is linear from a to b. */
static double part_above_1(double a, double b)
{
    if (a <= 1 && b <= 1)
        return 0;
    return a > 1 && b > 1 ? 1 : (fmax(a, b) - 1) / fabs(a - b);
}

/* The Gauss places, and places near the ends, where curvature grows fast beside an extraordinary vertex. Ascending. */
static double place_at(int i)
{
    static const double end[N_END] = {0, LEAST_AT, 4 * LEAST_AT};
    return i < N_END              ? end[i]
           : i < N_PLACES - N_END ? gauss_at(i - N_END)
                                  : 1 - end[N_PLACES - 1 - i];
}

/* What an edge is measured as at all places; `any` is false where it cannot be measured. */
struct sampled {
    struct both at[N_PLACES];
    bool any[N_PLACES];
};

/* Samples an edge: keeps the worst of all places. False if no place can be measured. */
static bool sample(struct walk *walk, struct break_edge *out, struct sampled *sampled)
{
    bool any = false;
    for (int i = 0; i < N_PLACES; i++) {
        sampled->any[i] = measure_at(walk, place_at(i), true, &sampled->at[i]);
        for (int m = 0; m < BREAK_MEASURES && sampled->any[i]; m++)
            keep_worst(out, m, place_at(i), &sampled->at[i]);
        any = any || sampled->any[i];
    }
    return any;
}

/* The length that is out of tolerance. */
static double out_length(const struct break_setup *setup, const struct sampled *sampled)
{
    double length = 0, last = 0;
    for (int i = 0; i < N_PLACES; i++) {
        const struct both *at = &sampled->at[i];
        if (!sampled->any[i])
            continue;
        double severity = severity_of(&setup->limits, at->value[BREAK_GAP], at->value[BREAK_ANGLE],
                                      at->value[BREAK_PERCENT]);
        if (i > 0 && sampled->any[i - 1])
            length += (place_at(i) - place_at(i - 1)) * 0.5 * (at[-1].speed + at->speed) *
                      part_above_1(last, severity);
        last = severity;
    }
    return length;
}

/* The value of a measure at a place; below all others where there is none. */
static double sampled_value(const struct sampled *sampled, int measure, int i)
{
    bool has = i >= 0 && i < N_PLACES && sampled->any[i] && !isnan(sampled->at[i].value[measure]);
    return has ? sampled->at[i].value[measure] : -1;
}

/* Looks for the worst place about each local maximum of the samples that could hold it. */
static void refine_all(struct walk *walk, const struct sampled *sampled, struct break_edge *out)
{
    for (int m = 0; m < BREAK_MEASURES; m++) {
        const double least = out->worst[m].value / 2; /* a peak between samples is rarely higher */
        for (int i = 0; i < N_PLACES; i++) {
            double value = sampled_value(sampled, m, i);
            bool is_peak = value > 0 && value >= sampled_value(sampled, m, i - 1) &&
                           value >= sampled_value(sampled, m, i + 1);
            if (is_peak && value >= least)
                refine(walk, m, place_at(i > 0 ? i - 1 : 0), place_at(i < N_PLACES - 1 ? i + 1 : i),
                       out);
        }
    }
}

bool breaks_measure_edge(const struct break_setup *setup, const struct surface_edge *edge,
                         uint8_t kind, struct break_edge *out)
{
    struct sampled sampled;
    *out = (struct break_edge){.face = {edge->face[0], edge->face[1]},
                               .edge = {edge->edge[0], edge->edge[1]},
                               .kind = kind,
                               .has_dart = edge->has_dart,
                               .shift = NAN};
    for (int m = 0; m < BREAK_MEASURES; m++)
        out->worst[m] = (struct break_worst){NAN, NAN, {NAN, NAN, NAN}};
    out->length = length_of(setup->tables, edge->face[0], edge->edge[0]);
    struct walk walk = {.setup = setup, .edge = edge, .length = out->length};
    if (!(out->length > 0) || !sample(&walk, out, &sampled))
        return false;
    refine_all(&walk, &sampled, out);
    if (kind == BREAK_SEMISHARP)
        return true;
    out->out_length = out_length(setup, &sampled);
    out->out_length = fmin(out->out_length, out->length);
    out->over = (uint8_t)((out->worst[BREAK_GAP].value > setup->limits.gap) << BREAK_GAP |
                          (out->worst[BREAK_ANGLE].value > setup->limits.angle_deg + ANGLE_FLOOR)
                              << BREAK_ANGLE |
                          (out->worst[BREAK_PERCENT].value > setup->limits.curvature_percent)
                              << BREAK_PERCENT);
    return true;
}

static struct vec place_of(const struct limit_tables *tables, const struct limit_place *place)
{
    struct limit_point point = {.s = {NAN, NAN, NAN}};
    limit_evaluate_at(tables, place, &point);
    return point.s;
}

void breaks_measure_border(const struct limit_tables *tables, struct break_border *border)
{
    struct limit_place place = {.node = border->of.face, .corner = border->of.edge};
    for (int i = 0; i < 3; i++) {
        place.a = 0.5 * i;
        border->points[i] = place_of(tables, &place);
    }
    place.a = 0.5;
    place.b = 1;
    struct vec across = vec_sub(place_of(tables, &place), border->points[1]);
    struct vec chord = vec_sub(border->points[2], border->points[0]);
    double square = vec_dot(chord, chord);
    border->across =
        square > 0 ? vec_sub(across, vec_scale(chord, vec_dot(across, chord) / square)) : across;
    border->length = length_of(tables, border->of.face, border->of.edge);
}

/* --- vertices */

/* The principal curvatures of a point. False where its derivatives vanish. */
static bool curvatures_of(const struct limit_point *point, double k[2])
{
    double e = vec_dot(point->su, point->su), f = vec_dot(point->su, point->sv),
           g = vec_dot(point->sv, point->sv), det = e * g - f * f;
    if (!point->has_normal || !(det > 1e-18 * e * g))
        return false;
    double mean = 0.5 * (e * point->lvv - 2 * f * point->luv + g * point->luu) / det;
    double gauss = (point->luu * point->lvv - point->luv * point->luv) / det;
    double half = sqrt(fmax(mean * mean - gauss, 0));
    k[0] = mean - half;
    k[1] = mean + half;
    return isfinite(k[0]) && isfinite(k[1]);
}

bool breaks_measure_sector(const struct limit_tables *tables, const struct surface_sector *sector,
                           struct break_vertex *out)
{
    struct limit_point vertex, point;
    uint32_t face = sector->face;
    unsigned corner = sector->corner;
    const struct limit_place at = {.node = face, .corner = corner};
    double n = 0;
    if (!limit_evaluate_at(tables, &at, &vertex))
        return false;
    *out = (struct break_vertex){.face = face,
                                 .corner = sector->corner,
                                 .is_inside = sector->is_closed,
                                 .n_faces = sector->n_faces < UINT16_MAX ? (uint16_t)sector->n_faces
                                                                         : UINT16_MAX,
                                 .k_least = INFINITY,
                                 .k_greatest = -INFINITY,
                                 .point = {vertex.s.x, vertex.s.y, vertex.s.z}};
    for (uint32_t i = 0; i < sector->n_faces; i++) {
        for (int step = 0; step < RING_PLACES; step++) {
            double angle = 0.5 * M_PI * step / (RING_PLACES - 1), k[2];
            const struct limit_place place = {face, corner, RING * fabs(cos(angle)),
                                              RING * fabs(sin(angle))};
            if (!limit_evaluate_at(tables, &place, &point) || !curvatures_of(&point, k))
                continue;
            out->k_least = fmin(out->k_least, k[0]);
            out->k_greatest = fmax(out->k_greatest, k[1]);
            out->radius += vec_length(vec_sub(point.s, vertex.s));
            n++;
        }
        if (!surface_next_around(tables, &face, &corner))
            break;
    }
    out->radius /= fmax(n, 1);
    return n > 0;
}
