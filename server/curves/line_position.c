#include "server/curves/line_position.h"

#include <math.h>

/* What counts as 0 by shaders/README.md, "Where rounding decides": a sine, and a ratio of lengths. The first decides
 * as in the shaders. The second is the rounding of double precision. */
static const double LEAST_SINE = 1e-6, LEAST_SHARE = 0x1p-50;

static struct vec vec_of(const double v[3])
{
    return (struct vec){v[0], v[1], v[2]};
}

/* The unit vector along v, whose squares may be out of range. */
static struct vec unit_of(struct vec v)
{
    double largest = fmax(fmax(fabs(v.x), fabs(v.y)), fabs(v.z));
    return largest > 0 ? vec_unit(vec_scale(v, 1 / largest)) : v;
}

/* Sets the axis and the directions of azimuth 0 and of a quarter turn later. */
static void set_turns(struct line_map *map, struct vec axis, struct vec zero)
{
    map->axis = unit_of(axis);
    map->zero = unit_of(vec_mad(zero, -vec_dot(zero, map->axis), map->axis));
    map->next = vec_cross(map->axis, map->zero);
}

/* Sets what a family at infinity needs. */
static void set_infinity(struct line_map *map)
{
    bool is_environment = map->family == LINES_ENVIRONMENT;
    map->width = is_environment ? 360 : 180;
    map->height = is_environment ? 180 : 360;
    map->s_wraps = is_environment;
    map->t_wraps = map->family == LINES_ZEBRA;
    if (map->family != LINES_ISOPHOTE)
        set_turns(map, map->direction,
                  fabs(map->direction.x) < 0.999 ? (struct vec){1, 0, 0} : (struct vec){0, 1, 0});
}

static void set_plane(struct line_map *map, struct vec u, struct vec v)
{
    map->axis = unit_of(vec_cross(u, v));
    struct vec by_u = vec_cross(v, map->axis), by_v = vec_cross(map->axis, u);
    map->zero = vec_scale(by_u, 1 / vec_dot(u, by_u));
    map->next = vec_scale(by_v, 1 / vec_dot(v, by_v));
    map->width = vec_length(u);
    map->height = vec_length(v);
}

static void set_closed(struct line_map *map, struct vec u, struct vec v)
{
    set_turns(map, v, u);
    map->radius = vec_dot(u, map->zero);
    map->s_wraps = true;
    bool is_sphere = map->kind == LIGHT_SPHERE;
    map->width = is_sphere ? 360 : 2 * M_PI * map->radius;
    map->height = is_sphere ? 180 : vec_length(v);
}

void line_map_init(struct line_map *map, const struct lines *lines, const struct light *light)
{
    *map = (struct line_map){
        .family = lines->family,
        .kind = light->kind,
        .has_direction = lines->has_direction,
        .eye_is_point = lines->eye_kind == LINE_EYE_POINT,
        .one_sided = light->one_sided,
        .eye = vec_of(lines->eye),
        .centre = vec_of(light->centre),
        .direction = unit_of(vec_of(lines->direction)),
        .pattern = light->pattern,
    };
    if (!map->eye_is_point)
        map->eye = unit_of(map->eye);
    struct vec u = vec_of(light->u), v = vec_of(light->v);
    if (lines->family != LINES_REFLECTION && lines->family != LINES_HIGHLIGHT)
        set_infinity(map);
    else if (light->kind == LIGHT_RECTANGLE || light->kind == LIGHT_PLANE)
        set_plane(map, u, v);
    else
        set_closed(map, u, v);
}

/* The unit direction from the line eye to x. */
static struct vec sight(const struct line_map *map, struct vec x, struct vec n)
{
    if (!map->eye_is_point)
        return map->eye;
    struct vec from = vec_sub(x, map->eye);
    double distance = vec_length(from), noise = LEAST_SHARE * vec_length(x);
    return distance > noise ? vec_scale(from, 1 / distance) : vec_scale(n, -1);
}

/* Meets the plane by the ray from x along r, or by the line in both directions. */
static struct line_position meet_plane(const struct line_map *map, struct vec x, struct vec r)
{
    struct vec away = vec_sub(map->centre, x);
    double ahead = vec_dot(map->axis, away), approach = vec_dot(map->axis, r);
    if (fabs(ahead) <= LEAST_SHARE * (vec_length(map->centre) + vec_length(x)))
        ahead = 0;
    struct line_position at = {.sine = fabs(approach)};
    if (!(at.sine > LEAST_SINE))
        return at;
    double tau = ahead / approach;
    struct vec offset = vec_sub(vec_scale(r, tau), away);
    at.s = 0.5 + vec_dot(offset, map->zero);
    at.t = 0.5 + vec_dot(offset, map->next);
    at.tau = fabs(tau);
    bool is_ahead = map->family == LINES_HIGHLIGHT || tau > 0;
    at.known = is_ahead && !(map->one_sided && ahead >= 0);
    bool is_inside = map->kind == LIGHT_PLANE || fmax(fabs(at.s - 0.5), fabs(at.t - 0.5)) <= 0.5;
    at.met = at.known && is_inside;
    return at;
}

/* The far side of the cylinder. */
static struct line_position meet_tunnel(const struct line_map *map, struct vec x, struct vec r)
{
    struct vec from = vec_sub(x, map->centre);
    double rx = vec_dot(r, map->zero), ry = vec_dot(r, map->next), sine = hypot(rx, ry);
    struct line_position at = {.sine = sine};
    if (!(sine >= LEAST_SINE))
        return at;
    double ax = rx / sine, ay = ry / sine; /* the ray across the axis, unit */
    double px = vec_dot(from, map->zero), py = vec_dot(from, map->next);
    double gone = px * ax + py * ay, pass = ax * py - ay * px, away2 = px * px + py * py;
    double chord2 = (map->radius - fabs(pass)) * (map->radius + fabs(pass));
    if (!(chord2 >= 0))
        return at;
    double half = sqrt(chord2);
    /* The far one of two intersections, without cancellation where x is beyond the axis. */
    double power = map->radius * map->radius - away2;
    double across = gone > 0 ? power / (half + gone) : half - gone;
    at.tau = across / sine;
    at.s = 0.5 + atan2(half * ay + pass * ax, half * ax - pass * ay) / (2 * M_PI);
    at.t = 0.5 + (vec_dot(from, map->axis) + at.tau * vec_dot(r, map->axis)) / map->height;
    at.met = at.known = at.tau > 0;
    return at;
}

/* Directions alone: the azimuth as a part of a turn, and the elevation as a part of half a turn. */
static struct line_position meet_infinity(const struct line_map *map, struct vec r)
{
    double x = vec_dot(r, map->zero), y = vec_dot(r, map->next), z = vec_dot(r, map->axis);
    double sine = hypot(x, y), azimuth = sine < LEAST_SINE ? 0 : atan2(y, x) / (2 * M_PI);
    double elevation = atan2(z, sine) / M_PI;
    struct line_position at = {.met = true, .known = true, .sine = sine};
    if (map->family == LINES_ZEBRA)
        return at.s = 0.5 + elevation, at.t = 0.5 + azimuth, at.sine = 1, at;
    at.s = map->family == LINES_ENVIRONMENT ? 0.5 - azimuth : 0.5 + azimuth;
    at.t = 0.5 + elevation;
    return at;
}

struct vec line_ray(const struct line_map *map, struct vec x, struct vec n)
{
    struct vec v = sight(map, x, n);
    double towards = vec_dot(v, n);
    if (map->family == LINES_HIGHLIGHT) /* of the two directions, the one that faces the eye */
        return towards >= LEAST_SINE ? vec_scale(n, -1) : n;
    return vec_mad(v, -2 * towards, n);
}

struct line_position line_position_at(const struct line_map *map, struct vec x, struct vec n)
{
    if (map->family == LINES_ISOPHOTE) {
        struct vec v = sight(map, x, n);
        struct vec d = map->has_direction ? map->direction : vec_scale(v, -1);
        double angle = atan2(vec_length(vec_cross(n, d)), vec_dot(n, d));
        return (struct line_position){
            .met = true, .known = true, .s = angle / M_PI, .t = 0.5, .sine = 1};
    }
    struct vec r = line_ray(map, x, n);
    if (map->family == LINES_ZEBRA || map->family == LINES_ENVIRONMENT || map->kind == LIGHT_SPHERE)
        return meet_infinity(map, r);
    return map->kind == LIGHT_TUNNEL ? meet_tunnel(map, x, r) : meet_plane(map, x, r);
}

/* The length of a spacing in the light's units. */
static double spacing_of(const struct line_map *map)
{
    const struct pattern *pattern = &map->pattern;
    if (pattern->kind == PATTERN_IMAGE)
        return map->width;
    if (pattern->kind == PATTERN_LINES) {
        double least = 1; /* of the light's width */
        for (uint32_t i = 0; i < pattern->n_at; i++)
            for (uint32_t k = 0; k < i; k++)
                if (pattern->at[i] != pattern->at[k])
                    least = fmin(least, fabs(pattern->at[i] - pattern->at[k]));
        return least * map->width;
    }
    if (pattern->period > 0)
        return pattern->period;
    return pattern->kind == PATTERN_CIRCLES ? fmin(map->width, map->height) / (2 * pattern->count)
                                            : map->width / pattern->count;
}

static double difference(double from, double to, bool wraps)
{
    double d = to - from;
    return wraps ? d - round(d) : d;
}

double line_shift(const struct line_map *map, const struct line_position *from,
                  const struct line_position *to)
{
    const struct pattern *pattern = &map->pattern;
    if (pattern->kind == PATTERN_DISTANCE)
        return fabs(to->tau - from->tau) / spacing_of(map);
    double x = difference(from->s, to->s, map->s_wraps) * map->width;
    double y = difference(from->t, to->t, map->t_wraps) * map->height;
    bool is_flat = pattern->kind == PATTERN_LATTICE || pattern->kind == PATTERN_CIRCLES ||
                   pattern->kind == PATTERN_IMAGE;
    double turn = pattern->rotation_deg * (M_PI / 180);
    return (is_flat ? hypot(x, y) : fabs(cos(turn) * x + sin(turn) * y)) / spacing_of(map);
}

int line_axes(const struct line_map *map)
{
    return map->pattern.kind == PATTERN_LATTICE ? 2 : 1;
}

double line_change(const struct line_map *map, int axis, const struct line_position *from,
                   const struct line_position *to)
{
    const struct pattern *pattern = &map->pattern;
    double x = difference(from->s, to->s, map->s_wraps) * map->width;
    double y = difference(from->t, to->t, map->t_wraps) * map->height;
    double turn = pattern->rotation_deg * (M_PI / 180), change;
    if (pattern->kind == PATTERN_DISTANCE) {
        change = to->tau - from->tau;
    } else if (pattern->kind == PATTERN_CIRCLES) {
        double at_x = (from->s - 0.5) * map->width, at_y = (from->t - 0.5) * map->height;
        change = hypot(at_x + x, at_y + y) - hypot(at_x, at_y);
    } else {
        change = axis == 0 ? cos(turn) * x + sin(turn) * y : cos(turn) * y - sin(turn) * x;
    }
    return change / spacing_of(map);
}

/* 1 / the distance of x from the line eye or from the light's centre, whichever is nearer; 0 if both are at
 * infinity. */
static double nearness(const struct line_map *map, struct vec x)
{
    double eye = map->eye_is_point ? 1 / vec_length(vec_sub(x, map->eye)) : 0;
    bool has_centre = map->kind != LIGHT_SPHERE;
    double centre = has_centre ? 1 / vec_length(vec_sub(x, map->centre)) : 0;
    return fmin(fmax(eye, centre), 1e100);
}

double line_step(const struct line_map *map, struct vec x, struct vec n, struct vec along,
                 struct vec turn, struct line_position ends[2])
{
    /* A step over which neither x nor n changes much; errors are of second order in it. */
    double change = fmax(vec_length(turn), nearness(map, x)), step = 1e-4 / change;
    if (!(change > 0))
        return 0;
    for (int k = 0; k < 2; k++) {
        double way = k ? step : -step;
        ends[k] = line_position_at(map, vec_mad(x, way, along), vec_unit(vec_mad(n, way, turn)));
    }
    return 2 * step;
}

double line_density(const struct line_map *map, struct vec x, struct vec n,
                    const struct vec along[2], const struct vec turn[2])
{
    double density[2];
    for (int i = 0; i < 2; i++) {
        struct line_position ends[2];
        double length = line_step(map, x, n, along[i], turn[i], ends);
        density[i] = 0;
        if (length == 0)
            continue; /* the ray is the same everywhere */
        if (!ends[0].known || !ends[1].known)
            return 0;
        density[i] = line_shift(map, &ends[0], &ends[1]) / length;
    }
    return hypot(density[0], density[1]);
}
