#include "server/curves/fields/field.h"

#include <math.h>

/* The same formula is computed with four kinds of numbers: with nets; with jets, which are a value and its derivatives by u
 * and v; with intervals, which are a middle and a radius; and with bounds of absolute values. Each is a struct net: a jet has
 * degrees 0 and 2, an interval 0 and 1, a bound 0 and 0, and these use c alone. */
struct numbers {
    struct net (*product)(struct net_room *room, const struct net *a, const struct net *b);
    struct net (*sum)(struct net_room *room, double x, const struct net *a, double y,
                      const struct net *b);
    struct net (*constant)(struct net_room *room, double value);
};

static struct net net_constant(struct net_room *room, double value)
{
    struct net out = net_take(room, 0, 0);
    out.c[0] = value;
    return out;
}

static struct net jet_product(struct net_room *room, const struct net *a, const struct net *b)
{
    struct net out = net_take(room, 0, 2);
    out.c[0] = a->c[0] * b->c[0];
    out.c[1] = a->c[1] * b->c[0] + a->c[0] * b->c[1];
    out.c[2] = a->c[2] * b->c[0] + a->c[0] * b->c[2];
    return out;
}

static struct net jet_sum(struct net_room *room, double x, const struct net *a, double y,
                          const struct net *b)
{
    struct net out = net_take(room, 0, 2);
    for (int k = 0; k < 3; k++)
        out.c[k] = x * a->c[k] + y * b->c[k];
    return out;
}

static struct net jet_constant(struct net_room *room, double value)
{
    struct net out = net_take(room, 0, 2);
    out.c[0] = value;
    out.c[1] = out.c[2] = 0;
    return out;
}

static struct net bound_product(struct net_room *room, const struct net *a, const struct net *b)
{
    return net_constant(room, a->c[0] * b->c[0]);
}

static struct net bound_sum(struct net_room *room, double x, const struct net *a, double y,
                            const struct net *b)
{
    return net_constant(room, fabs(x) * a->c[0] + fabs(y) * b->c[0]);
}

static struct net bound_constant(struct net_room *room, double value)
{
    return net_constant(room, fabs(value));
}

static struct net interval_product(struct net_room *room, const struct net *a, const struct net *b)
{
    struct net out = net_take(room, 0, 1);
    double x = a->c[0], y = b->c[0];
    out.c[0] = x * y;
    out.c[1] = fabs(x) * b->c[1] + fabs(y) * a->c[1] + a->c[1] * b->c[1];
    return out;
}

static struct net interval_sum(struct net_room *room, double x, const struct net *a, double y,
                               const struct net *b)
{
    struct net out = net_take(room, 0, 1);
    out.c[0] = x * a->c[0] + y * b->c[0];
    out.c[1] = fabs(x) * a->c[1] + fabs(y) * b->c[1];
    return out;
}

static struct net interval_constant(struct net_room *room, double value)
{
    struct net out = net_take(room, 0, 1);
    out.c[0] = value;
    out.c[1] = 0;
    return out;
}

static const struct numbers NETS = {net_product, net_sum, net_constant};
static const struct numbers JETS = {jet_product, jet_sum, jet_constant};
static const struct numbers INTERVALS = {interval_product, interval_sum, interval_constant};
static const struct numbers BOUNDS = {bound_product, bound_sum, bound_constant};

/* What the formulas start from. */
struct terms {
    const struct numbers *numbers;
    struct net_room *room;
    const struct line_field *field;
    struct net l[3];   /* the place relative to the light's centre */
    struct net v[3];   /* the view */
    struct net n[3];   /* the normal */
    struct net nn, vn; /* N.N, V.N; not set where R is N */
    bool along_normal; /* R is N */
};

static struct net product(const struct terms *t, struct net a, struct net b)
{
    /* cppcheck-suppress returnDanglingLifetime ; the result points to the room */
    return t->numbers->product(t->room, &a, &b);
}

static struct net sum(const struct terms *t, double x, struct net a, double y, struct net b)
{
    /* cppcheck-suppress returnDanglingLifetime ; the result points to the room */
    return t->numbers->sum(t->room, x, &a, y, &b);
}

static struct net dot(const struct terms *t, const struct net a[3], const struct net b[3])
{
    struct net xy = sum(t, 1, product(t, a[0], b[0]), 1, product(t, a[1], b[1]));
    return sum(t, 1, xy, 1, product(t, a[2], b[2]));
}

static struct net along(const struct terms *t, const struct net a[3], struct vec e)
{
    return sum(t, 1, sum(t, e.x, a[0], e.y, a[1]), e.z, a[2]);
}

/* The part of R along e. */
static struct net ray_along(const struct terms *t, struct vec e)
{
    struct net n = along(t, t->n, e);
    if (t->along_normal)
        return n;
    return sum(t, 1, product(t, t->nn, along(t, t->v, e)), -2, product(t, t->vn, n));
}

static void relative_to(const struct numbers *numbers, struct net_room *room, const struct net s[3],
                        struct vec from, struct net out[3])
{
    const double at[3] = {from.x, from.y, from.z};
    for (int d = 0; d < 3; d++) {
        struct net c = numbers->constant(room, at[d]);
        out[d] = numbers->sum(room, 1, &s[d], -1, &c);
    }
}

static void start(struct terms *t, struct vec origin, const struct net s[3], const struct net n[3])
{
    const struct line_map *map = &t->field->map;
    relative_to(t->numbers, t->room, s, vec_sub(map->centre, origin), t->l);
    const double view[3] = {map->eye.x, map->eye.y, map->eye.z};
    if (map->eye_is_point)
        relative_to(t->numbers, t->room, s, vec_sub(map->eye, origin), t->v);
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

static int plane_terms(const struct terms *t, struct net g[FIELD_TERMS])
{
    struct vec e = t->field->across, m = t->field->map.axis;
    struct net mr = ray_along(t, m), er = ray_along(t, e);
    g[0] = sum(t, 1, product(t, along(t, t->l, e), mr), -1, product(t, along(t, t->l, m), er));
    g[1] = mr;
    return 2;
}

static int around_terms(const struct terms *t, struct net g[FIELD_TERMS])
{
    struct vec e1 = t->field->map.zero, e2 = t->field->map.next;
    struct net x = along(t, t->l, e1), y = along(t, t->l, e2);
    g[1] = ray_along(t, e2);
    g[2] = ray_along(t, e1);
    g[0] = sum(t, -1, product(t, x, g[1]), 1, product(t, y, g[2]));
    return 3;
}

static int along_terms(const struct terms *t, struct net g[FIELD_TERMS])
{
    const struct line_map *map = &t->field->map;
    struct net q[2] = {ray_along(t, map->zero), ray_along(t, map->next)};
    struct net x[2] = {along(t, t->l, map->zero), along(t, t->l, map->next)};
    struct net a = ray_along(t, map->axis), z = along(t, t->l, map->axis), w[2];
    for (int k = 0; k < 2; k++)
        w[k] = sum(t, 1, product(t, a, x[k]), -1, product(t, z, q[k]));
    struct net ww = sum(t, 1, product(t, w[0], w[0]), 1, product(t, w[1], w[1]));
    struct net wq = sum(t, 1, product(t, w[0], q[0]), 1, product(t, w[1], q[1]));
    g[0] = sum(t, 1, ww, -map->radius * map->radius, product(t, a, a));
    g[1] = sum(t, 2, wq, 0, wq);
    g[2] = sum(t, 1, product(t, q[0], q[0]), 1, product(t, q[1], q[1]));
    return 3;
}

static int elevation_terms(const struct terms *t, struct net g[FIELD_TERMS])
{
    struct net a = ray_along(t, t->field->map.axis);
    g[0] = product(t, a, a);
    if (t->along_normal)
        g[1] = dot(t, t->n, t->n);
    else
        g[1] = product(t, product(t, t->nn, t->nn), dot(t, t->v, t->v)); /* |R| = |N|^2 |V| */
    return 2;
}

static int isophote_terms(const struct terms *t, struct net g[FIELD_TERMS])
{
    bool has_direction = t->field->map.has_direction, is_90 = t->field->form == FIELD_ISOPHOTE_90;
    struct net towards = has_direction ? along(t, t->n, t->field->map.direction) : t->vn;
    g[0] = is_90 ? towards : product(t, towards, towards);
    if (is_90)
        return 1;
    g[1] = has_direction ? t->nn : product(t, t->nn, dot(t, t->v, t->v));
    return 2;
}

static int terms_of(const struct terms *t, struct net g[FIELD_TERMS])
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
    case FIELD_LEVEL:
        g[0] = ray_along(t, t->field->map.axis);
        return 1;
    case FIELD_ISOPHOTE:
    case FIELD_ISOPHOTE_90:
        return isophote_terms(t, g);
    case FIELD_SILHOUETTE:
        g[0] = dot(t, t->v, t->n);
        return 1;
    }
    return 0;
}

/* The sign of a scaled net if all its coefficients have the same. */
static double sign_of(const struct net *net)
{
    return net_sign(net);
}

/* The factor of field_line.r for the whole net. */
static double facing_of(const struct terms *t)
{
    const struct line_field *field = t->field;
    if (field->form == FIELD_PLANE && !t->along_normal) {
        struct net m = along(t, t->l, field->map.axis);
        return -sign_of(&m);
    }
    if (field->form != FIELD_AROUND && field->form != FIELD_AZIMUTH)
        return 0;
    if (!t->along_normal)
        return 1;
    struct net vn = dot(t, t->v, t->n);
    return -sign_of(&vn);
}

void field_find_bounds(const struct line_field *field, struct vec origin, double reach,
                       struct field_nets *nets)
{
    double memory[400], one = 1;
    struct net_room room = {memory, 0};
    struct net s[3], n[3], g[FIELD_TERMS];
    for (int d = 0; d < 3; d++) {
        s[d] = (struct net){0, 0, &reach};
        n[d] = (struct net){0, 0, &one};
    }
    struct terms t = {.numbers = &BOUNDS, .room = &room, .field = field};
    start(&t, origin, s, n);
    nets->n_terms = terms_of(&t, g);
    for (int k = 0; k < nets->n_terms; k++)
        nets->bound[k] = g[k].c[0];
}

void field_make_nets(const struct line_field *field, struct net_room *room, struct vec origin,
                     const struct bezier_nets *patch, struct field_nets *nets)
{
    struct terms t = {.numbers = &NETS, .room = room, .field = field};
    struct net g[FIELD_TERMS];
    start(&t, origin, patch->s, patch->n);
    nets->n_terms = terms_of(&t, g);
    nets->facing = facing_of(&t);
    int m = 0, n = 0;
    for (int k = 0; k < nets->n_terms; k++) {
        m = g[k].m > m ? g[k].m : m;
        n = g[k].n > n ? g[k].n : n;
    }
    for (int k = 0; k < nets->n_terms; k++) {
        /* A copy, because two terms may share their coefficients. */
        struct net raised = net_raised(room, &g[k], m, n);
        nets->g[k] = net_take(room, m, n);
        for (size_t i = 0; i < net_size(&raised); i++)
            nets->g[k].c[i] = raised.c[i];
        net_unscale(&nets->g[k]);
    }
    field_find_bounds(field, origin, patch->reach, nets);
}

void field_make_box(const struct line_field *field, struct vec origin,
                    const struct bezier_box *patch, struct field_box *box)
{
    double memory[800], from_s[3][2], from_n[3][2];
    struct net_room room = {memory, 0};
    struct net s[3], n[3], g[FIELD_TERMS];
    for (int d = 0; d < 3; d++) {
        for (int k = 0; k < 2; k++) {
            from_s[d][k] = patch->s[d][k];
            from_n[d][k] = patch->n[d][k];
        }
        s[d] = (struct net){0, 1, from_s[d]};
        n[d] = (struct net){0, 1, from_n[d]};
    }
    struct terms t = {.numbers = &INTERVALS, .room = &room, .field = field};
    start(&t, origin, s, n);
    box->n_terms = terms_of(&t, g);
    for (int i = 0; i < box->n_terms; i++)
        for (int k = 0; k < 2; k++)
            box->g[i][k] = g[i].c[k];
}

int field_box_sign(const struct field_box *box, const struct field_line *line)
{
    double middle = 0, radius = 0, size = 0;
    for (int k = 0; k < box->n_terms; k++) {
        middle += line->w[k] * box->g[k][0];
        radius += fabs(line->w[k]) * box->g[k][1];
        size += fabs(line->w[k] * box->g[k][0]);
    }
    /* Where the rounding of the middle may count, nothing is known. */
    bool is_known = fabs(middle) > radius + 1e-9 * size;
    return !is_known ? 0 : middle > 0 ? 1 : -1;
}

double field_bound(const struct field_nets *nets, const struct field_line *line)
{
    double bound = 0;
    for (int k = 0; k < nets->n_terms; k++)
        bound += fabs(line->w[k]) * nets->bound[k];
    return bound;
}

void field_jet(const struct line_field *field, const struct field_line *line, struct vec origin,
               const struct bezier_jet *at, double out[3])
{
    double memory[1200], start_s[3][3], start_n[3][3];
    struct net_room room = {memory, 0};
    struct net s[3], n[3], g[FIELD_TERMS];
    for (int k = 0; k < 3; k++) {
        const double from_s[3] = {at->s[k].x, at->s[k].y, at->s[k].z};
        const double from_n[3] = {at->n[k].x, at->n[k].y, at->n[k].z};
        for (int d = 0; d < 3; d++) {
            start_s[d][k] = from_s[d];
            start_n[d][k] = from_n[d];
        }
    }
    for (int d = 0; d < 3; d++) {
        s[d] = (struct net){0, 2, start_s[d]};
        n[d] = (struct net){0, 2, start_n[d]};
    }
    struct terms t = {.numbers = &JETS, .room = &room, .field = field};
    start(&t, origin, s, n);
    int count = terms_of(&t, g);
    for (int k = 0; k < 3; k++) {
        out[k] = 0;
        for (int i = 0; i < count; i++)
            out[k] += line->w[i] * g[i].c[k];
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

bool line_field_init(struct line_field *field, const struct line_map *map, double place)
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
        bool is_90 = own_place(field, place) == 0.5;
        field->form = is_90 ? FIELD_ISOPHOTE_90 : FIELD_ISOPHOTE;
        return !field->by_t;
    }
    bool by_elevation = (map->family == LINES_ZEBRA) != field->by_t;
    if (is_light && map->kind == LIGHT_TUNNEL)
        field->form = field->by_t ? FIELD_ALONG : FIELD_AROUND;
    else if (by_elevation)
        field->form = own_place(field, place) == 0.5 ? FIELD_LEVEL : FIELD_ELEVATION;
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
    case FIELD_ELEVATION: {
        double sine = sin(M_PI * own);
        line->w[1] = -sine * sine;
        break;
    }
    case FIELD_ISOPHOTE: {
        double cosine = sin(M_PI * own); /* of the angle, with the other sign */
        line->w[1] = -cosine * cosine;
        break;
    }
    case FIELD_LEVEL:
    case FIELD_ISOPHOTE_90:
    case FIELD_SILHOUETTE:
        break;
    }
    bool is_open = field->form == FIELD_PLANE || field->form == FIELD_ALONG;
    bool has_poles = field->form == FIELD_ELEVATION || field->form == FIELD_ISOPHOTE;
    return is_open || (has_poles ? fabs(own) < 0.5 : fabs(own) <= 0.5);
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
    if (field->form == FIELD_AROUND || field->form == FIELD_AZIMUTH)
        return fabs(d) < 0.25 ? d * unit : NAN;
    if (field->form == FIELD_ALONG) /* F is 0 also where the ray comes from outside */
        return fabs(d) < 0.01 ? d * unit : NAN;
    bool is_opposite = field->form == FIELD_ELEVATION || field->form == FIELD_ISOPHOTE;
    return is_opposite && fabs(d) > fabs(d + 2 * own - 1) ? NAN : d * unit;
}
