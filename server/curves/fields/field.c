#include "server/curves/fields/field.h"

#include <math.h>
#include <string.h>

/* What the formulas start from. */
struct terms {
    const struct numbers *numbers;
    struct number_room *room;
    const struct line_field *field;
    const double *l[3];    /* the place relative to the light's centre */
    const double *v[3];    /* the view */
    const double *n[3];    /* the normal */
    const double *nn, *vn; /* N.N, V.N; not set where R is N */
    bool along_normal;     /* R is N */
};

static const double *product(const struct terms *t, const double *a, const double *b)
{
    return t->numbers->product(t->room, a, b);
}

static const double *sum(const struct terms *t, double x, const double *a, double y,
                         const double *b)
{
    return t->numbers->sum(t->room, x, a, y, b);
}

static const double *dot(const struct terms *t, const double *const a[3], const double *const b[3])
{
    const double *xy = sum(t, 1, product(t, a[0], b[0]), 1, product(t, a[1], b[1]));
    return sum(t, 1, xy, 1, product(t, a[2], b[2]));
}

static const double *along(const struct terms *t, const double *const a[3], struct vec e)
{
    const double by[3] = {e.x, e.y, e.z};
    return t->numbers->along(t->room, by, a);
}

/* The part of R along e. */
static const double *ray_along(const struct terms *t, struct vec e)
{
    const double *n = along(t, t->n, e);
    if (t->along_normal)
        return n;
    return sum(t, 1, product(t, t->nn, along(t, t->v, e)), -2, product(t, t->vn, n));
}

static void relative_to(const struct terms *t, const double *const s[3], struct vec from,
                        const double *out[3])
{
    const double at[3] = {from.x, from.y, from.z};
    for (int d = 0; d < 3; d++)
        out[d] = t->numbers->shifted(t->room, s[d], -at[d]);
}

static void start(struct terms *t, struct vec origin, const double *const s[3],
                  const double *const n[3])
{
    const struct line_map *map = &t->field->map;
    relative_to(t, s, vec_sub(map->centre, origin), t->l);
    const double view[3] = {map->eye.x, map->eye.y, map->eye.z};
    if (map->eye_is_point)
        relative_to(t, s, vec_sub(map->eye, origin), t->v);
    for (int d = 0; d < 3; d++) {
        if (!map->eye_is_point)
            t->v[d] = t->numbers->constant(t->room, view[d]);
        t->n[d] = n[d];
    }
    t->along_normal = map->family == LINES_HIGHLIGHT;
    if (!t->along_normal) {
        t->nn = dot(t, n, n);
        t->vn = dot(t, t->v, n);
    }
}

static int plane_terms(const struct terms *t, const double *g[FIELD_TERMS])
{
    struct vec e = t->field->across, m = t->field->map.axis;
    const double *mr = ray_along(t, m), *er = ray_along(t, e);
    g[0] = sum(t, 1, product(t, along(t, t->l, e), mr), -1, product(t, along(t, t->l, m), er));
    g[1] = mr;
    return 2;
}

static int around_terms(const struct terms *t, const double *g[FIELD_TERMS])
{
    struct vec e1 = t->field->map.zero, e2 = t->field->map.next;
    const double *x = along(t, t->l, e1), *y = along(t, t->l, e2);
    g[1] = ray_along(t, e2);
    g[2] = ray_along(t, e1);
    g[0] = sum(t, -1, product(t, x, g[1]), 1, product(t, y, g[2]));
    return 3;
}

static int along_terms(const struct terms *t, const double *g[FIELD_TERMS])
{
    const struct line_map *map = &t->field->map;
    const double *q[2] = {ray_along(t, map->zero), ray_along(t, map->next)};
    const double *x[2] = {along(t, t->l, map->zero), along(t, t->l, map->next)};
    const double *a = ray_along(t, map->axis), *z = along(t, t->l, map->axis), *w[2];
    for (int k = 0; k < 2; k++)
        w[k] = sum(t, 1, product(t, a, x[k]), -1, product(t, z, q[k]));
    const double *ww = sum(t, 1, product(t, w[0], w[0]), 1, product(t, w[1], w[1]));
    const double *wq = sum(t, 1, product(t, w[0], q[0]), 1, product(t, w[1], q[1]));
    g[0] = sum(t, 1, ww, -map->radius * map->radius, product(t, a, a));
    g[1] = sum(t, 2, wq, 0, wq);
    g[2] = sum(t, 1, product(t, q[0], q[0]), 1, product(t, q[1], q[1]));
    return 3;
}

static const double *root(const struct terms *t, const double *a)
{
    return t->numbers->root(t->room, a);
}

static int elevation_terms(const struct terms *t, const double *g[FIELD_TERMS])
{
    g[0] = ray_along(t, t->field->map.axis);
    if (t->along_normal)
        g[1] = root(t, dot(t, t->n, t->n));
    else
        g[1] = product(t, t->nn, root(t, dot(t, t->v, t->v)));
    return 2;
}

static int isophote_terms(const struct terms *t, const double *g[FIELD_TERMS])
{
    const double *length = root(t, t->nn);
    if (t->field->map.has_direction) {
        g[0] = along(t, t->n, t->field->map.direction);
        g[1] = length;
    } else { /* towards the eye */
        g[0] = sum(t, -1, t->vn, 0, t->vn);
        g[1] = product(t, length, root(t, dot(t, t->v, t->v)));
    }
    return 2;
}

static int terms_of(const struct terms *t, const double *g[FIELD_TERMS])
{
    switch (t->field->form) {
    case FIELD_PLANE:
        return plane_terms(t, g);
    case FIELD_AROUND:
        return around_terms(t, g);
    case FIELD_ALONG:
        return along_terms(t, g);
    case FIELD_AZIMUTH:
        g[0] = ray_along(t, t->field->map.zero);
        g[1] = ray_along(t, t->field->map.next);
        return 2;
    case FIELD_ELEVATION:
        return elevation_terms(t, g);
    case FIELD_ISOPHOTE:
        return isophote_terms(t, g);
    case FIELD_SILHOUETTE:
        g[0] = dot(t, t->v, t->n);
        return 1;
    }
    return 0;
}

/* The factor of field_line.r for the whole piece. */
static double facing_of(const struct terms *t)
{
    const struct line_field *field = t->field;
    if (field->form == FIELD_PLANE && !t->along_normal) {
        return -range_sign(along(t, t->l, field->map.axis));
    }
    if (field->form != FIELD_AROUND && field->form != FIELD_AZIMUTH)
        return 0;
    if (!t->along_normal)
        return 1;
    return -range_sign(dot(t, t->v, t->n));
}

/* The doubles that the numbers of a formula take at most. */
enum { MOST_NUMBERS = 120 };

void field_find_bounds(const struct line_field *field, struct vec origin, double reach,
                       struct field_bounds *bounds)
{
    double memory[MOST_NUMBERS], one = 1;
    struct number_room room = {memory, 0};
    const double *s[3] = {&reach, &reach, &reach}, *n[3] = {&one, &one, &one}, *g[FIELD_TERMS];
    struct terms t = {.numbers = &NUMBERS_BOUND, .room = &room, .field = field};
    start(&t, origin, s, n);
    bounds->n_terms = terms_of(&t, g);
    for (int k = 0; k < bounds->n_terms; k++)
        bounds->g[k] = g[k][0];
}

double field_bound(const struct field_bounds *bounds, const struct field_line *line)
{
    double bound = 0;
    for (int k = 0; k < bounds->n_terms; k++)
        bound += fabs(line->w[k]) * bounds->g[k];
    return bound;
}

void field_find_range(const struct line_field *field, struct vec origin,
                      const struct piece_range *piece, struct field_range *range)
{
    double memory[MOST_NUMBERS * RANGE_SIZE];
    struct number_room room = {memory, 0};
    const double *s[3] = {piece->s[0], piece->s[1], piece->s[2]};
    const double *n[3] = {piece->n[0], piece->n[1], piece->n[2]}, *g[FIELD_TERMS];
    struct terms t = {.numbers = &NUMBERS_RANGE, .room = &room, .field = field};
    start(&t, origin, s, n);
    range->n_terms = terms_of(&t, g);
    range->facing = facing_of(&t);
    for (int k = 0; k < FIELD_TERMS; k++)
        if (k < range->n_terms)
            memcpy(range->g[k], g[k], sizeof range->g[k]);
        else
            memset(range->g[k], 0, sizeof range->g[k]);
}

void field_line_range(const struct field_range *range, const struct field_line *line,
                      double out[RANGE_SIZE])
{
    const double *const g[FIELD_TERMS] = {range->g[0], range->g[1], range->g[2]};
    range_combine(line->w, g, out);
}

/* The sign of factors times the terms, if it is the same throughout by the terms' own ranges; else 0. */
static int quick_sign(const struct field_range *range, const double factor[FIELD_TERMS])
{
    double middle = 0, off = 0, size = 0;
    for (int k = 0; k < range->n_terms; k++) {
        double part = factor[k] * range->g[k][0];
        middle += part;
        size += fabs(part);
        off += fabs(factor[k]) * range->g[k][RANGE_OFF];
    }
    /* Where the rounding of the middle may count, nothing is known. */
    return !(fabs(middle) > off + 1e-9 * (off + size)) ? 0 : middle > 0 ? 1 : -1;
}

int field_quick_sign(const struct field_range *range, const struct field_line *line)
{
    return quick_sign(range, line->w);
}

bool field_is_never_met(const struct field_range *range, const struct field_line *line)
{
    return range->facing != 0 && quick_sign(range, line->r) * range->facing < 0;
}

void field_jet(const struct line_field *field, const struct field_line *line, struct vec origin,
               const struct bezier_jet *at, double out[3])
{
    double memory[3 * MOST_NUMBERS], from_s[3][3], from_n[3][3];
    struct number_room room = {memory, 0};
    for (int k = 0; k < 3; k++) {
        from_s[0][k] = at->s[k].x, from_s[1][k] = at->s[k].y, from_s[2][k] = at->s[k].z;
        from_n[0][k] = at->n[k].x, from_n[1][k] = at->n[k].y, from_n[2][k] = at->n[k].z;
    }
    const double *s[3] = {from_s[0], from_s[1], from_s[2]};
    const double *n[3] = {from_n[0], from_n[1], from_n[2]}, *g[FIELD_TERMS];
    struct terms t = {.numbers = &NUMBERS_JET, .room = &room, .field = field};
    start(&t, origin, s, n);
    int count = terms_of(&t, g);
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int i = 0; i < count; i++)
            out[k] += line->w[i] * g[i][k];
    }
}

/* Whether an angle is a multiple of a quarter turn; then which, from 0 to 3. */
static bool quarter_of(double rotation_deg, int *quarter)
{
    double quarters = rotation_deg / 90, whole = round(quarters);
    *quarter = (int)(whole - 4 * floor(whole / 4));
    return quarters == whole;
}

/* The place on the light's own s or t of the line at `place`. */
static double own_place(const struct line_field *field, double place)
{
    const struct line_map *map = &field->map;
    int quarter;
    if (field->form == FIELD_PLANE || !quarter_of(map->pattern.rotation_deg, &quarter))
        return place;
    double offset = quarter == 2 || quarter == 3 ? 0.5 - place : place - 0.5;
    return 0.5 + (quarter & 1 ? offset * map->width / map->height : offset);
}

bool line_field_init(struct line_field *field, const struct line_map *map)
{
    *field = (struct line_field){.map = *map};
    bool is_light = map->family == LINES_REFLECTION || map->family == LINES_HIGHLIGHT;
    if (is_light && (map->kind == LIGHT_RECTANGLE || map->kind == LIGHT_PLANE)) {
        field->form = FIELD_PLANE;
        field->turn = map->pattern.rotation_deg * (M_PI / 180);
        field->across = vec_mad(vec_scale(map->zero, cos(field->turn)),
                                sin(field->turn) * map->height / map->width, map->next);
        return true;
    }
    int quarter;
    if (!quarter_of(map->pattern.rotation_deg, &quarter))
        return false;
    field->by_t = quarter & 1;
    if (map->family == LINES_ISOPHOTE) {
        field->form = FIELD_ISOPHOTE;
        return !field->by_t;
    }
    bool by_elevation = (map->family == LINES_ZEBRA) != field->by_t;
    if (is_light && map->kind == LIGHT_TUNNEL)
        field->form = field->by_t ? FIELD_ALONG : FIELD_AROUND;
    else if (by_elevation)
        field->form = FIELD_ELEVATION;
    else
        field->form = FIELD_AZIMUTH;
    return true;
}

void silhouette_field_init(struct line_field *field, const struct line_map *map)
{
    *field = (struct line_field){.map = *map, .form = FIELD_SILHOUETTE};
    field->map.family = LINES_REFLECTION; /* of all families the view and no other ray */
}

bool field_line_init(const struct line_field *field, double place, struct field_line *line)
{
    const struct line_map *map = &field->map;
    double own = own_place(field, place) - 0.5, azimuth = 2 * M_PI * own;
    if (map->family == LINES_ENVIRONMENT)
        azimuth = -azimuth;
    double c = cos(azimuth), s = sin(azimuth);
    *line = (struct field_line){.place = place, .w = {1, 0, 0}};
    switch (field->form) {
    case FIELD_PLANE:
        line->w[1] = -own;
        line->r[1] = 1;
        break;
    case FIELD_AROUND:
        line->w[1] = map->radius * c;
        line->w[2] = -map->radius * s;
        line->r[1] = s;
        line->r[2] = c;
        break;
    case FIELD_ALONG:
        line->w[1] = own * map->height;
        line->w[2] = line->w[1] * line->w[1];
        break;
    case FIELD_AZIMUTH:
        line->w[0] = -s;
        line->w[1] = c;
        line->r[0] = c;
        line->r[1] = s;
        break;
    case FIELD_ELEVATION:
        line->w[1] = -sin(M_PI * own);
        break;
    case FIELD_ISOPHOTE:
        line->w[1] = sin(M_PI * own); /* the cosine of the angle with the other sign */
        break;
    case FIELD_SILHOUETTE:
        break;
    }
    bool is_open = field->form == FIELD_PLANE || field->form == FIELD_ALONG;
    bool has_poles = field->form == FIELD_ELEVATION || field->form == FIELD_ISOPHOTE;
    return is_open || (has_poles ? fabs(own) < 0.5 : fabs(own) <= 0.5);
}

/* Whether the ray of a point meets a tunnel's line on its way into the tunnel: F is 0 there, but the light is met on the far
 * side. */
static bool comes_from_outside(const struct line_field *field, const struct field_line *line,
                               struct vec x, struct vec n)
{
    const struct line_map *map = &field->map;
    struct vec r = line_ray(map, x, n), l = vec_sub(x, map->centre);
    double q[2] = {vec_dot(r, map->zero), vec_dot(r, map->next)};
    if (field->form == FIELD_AROUND) /* r[2] and r[1] are the cosine and sine of the line's angle */
        return line->r[2] * q[0] + line->r[1] * q[1] < 0;
    double away = line->w[1] - vec_dot(l, map->axis), speed = vec_dot(r, map->axis);
    double outwards = vec_dot(l, map->zero) * q[0] + vec_dot(l, map->next) * q[1];
    double tau = away / speed;
    return tau < 0 || outwards + tau * (q[0] * q[0] + q[1] * q[1]) < 0;
}

/* Whether a ray has no azimuth: within what line_position.h takes for the pole. */
static bool is_at_pole(const struct line_map *map, struct vec x, struct vec n)
{
    struct vec r = line_ray(map, x, n);
    return hypot(vec_dot(r, map->zero), vec_dot(r, map->next)) < 2e-6;
}

double field_residual(const struct line_field *field, const struct field_line *line, struct vec x,
                      struct vec n)
{
    const struct line_map *map = &field->map;
    if (field->form == FIELD_SILHOUETTE) {
        struct vec v = map->eye_is_point ? vec_unit(vec_sub(x, map->eye)) : map->eye;
        return vec_dot(v, n);
    }
    struct line_position at = line_position_at(map, x, n);
    if (!at.met)
        return NAN;
    if (field->form == FIELD_PLANE)
        return cos(field->turn) * (at.s - 0.5) +
               sin(field->turn) * (at.t - 0.5) * map->height / map->width - (line->place - 0.5);
    double own = own_place(field, line->place), unit = field->by_t ? map->height / map->width : 1;
    double d = (field->by_t ? at.t : at.s) - own;
    bool wraps = field->by_t ? map->t_wraps : map->s_wraps;
    d = wraps ? d - round(d) : d;
    if (field->form == FIELD_AZIMUTH) /* F is 0 also at the opposite angle, and at the pole */
        return fabs(d) < 0.25 && !is_at_pole(map, x, n) ? d * unit : NAN;
    if (field->form == FIELD_AROUND || field->form == FIELD_ALONG)
        return comes_from_outside(field, line, x, n) ? NAN : d * unit;
    return d * unit;
}
