#include "server/curves/lines/march.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Grows an array for one more member; false when memory is short. */
static bool grow(void **array, size_t n, size_t *room, size_t size)
{
    if (n < *room)
        return true;
    size_t wanted = *room ? 2 * *room : 256;
    void *grown = realloc(*array, wanted * size);
    if (!grown)
        return false;
    *array = grown;
    *room = wanted;
    return true;
}

static bool add_point(struct tracer *tracer, const struct traced_point *point)
{
    struct traced *out = &tracer->out;
    void *array = out->point;
    if (out->n_points >= tracer->most_points) {
        tracer->is_over = true;
        return false;
    }
    if (!grow(&array, out->n_points, &out->room_points, sizeof *point))
        return false;
    out->point = array;
    out->point[out->n_points++] = *point;
    return true;
}

void march_add(struct tracer *tracer, uint32_t line, uint64_t from, uint64_t to,
               const struct traced_point *points, size_t n)
{
    struct traced *out = &tracer->out;
    struct traced_arc arc = {{from, to}, line, (uint32_t)out->n_points, (uint32_t)n};
    void *array = out->arc;
    bool ok = grow(&array, out->n_arcs, &out->room_arcs, sizeof arc);
    out->arc = array;
    for (size_t k = 0; ok && k < n; k++)
        ok = add_point(tracer, &points[k]);
    if (ok)
        out->arc[out->n_arcs++] = arc;
    else
        tracer->work.failed = true;
}

void march_mark(struct tracer *tracer, enum traced_mark_kind kind, uint32_t line, uint64_t node,
                const struct traced_point *at)
{
    struct traced *out = &tracer->out;
    void *array = out->mark;
    if (!grow(&array, out->n_marks, &out->room_marks, sizeof *out->mark)) {
        tracer->work.failed = true;
        return;
    }
    out->mark = array;
    out->mark[out->n_marks++] = (struct traced_mark){kind, line, node, *at};
}

static const struct field_line *line_of(const struct march *march)
{
    return &march->tracer->work.set->line[march->line];
}

/* The point at (u,v), where F has the derivatives jet[1] and jet[2]. */
static struct traced_point point_of(const struct march *march, const double at[2],
                                    const struct bezier_jet *surface, const double jet[3])
{
    const struct patch_place *place = march->place;
    struct traced_point point = {.p = vec_add(march->on->bezier->origin, surface->s[0])};
    trace_face_place(march->tracer->work.tables, place->node, place->x0 + place->width * at[0],
                     place->y0 + place->height * at[1], &point);
    point.n = vec_unit(surface->n[0]);
    double steepest = fmax(fabs(jet[1]), fabs(jet[2]));
    if (steepest > 0)
        point.along = vec_unit(vec_mad(vec_scale(surface->s[1], jet[2] / steepest),
                                       -jet[1] / steepest, surface->s[2]));
    point.residual = field_residual(march->on->field, line_of(march), point.p, point.n);
    return point;
}

static void jet_at(const struct march *march, const double at[2], struct bezier_jet *surface,
                   double jet[3])
{
    patch_field_jet(march->on, line_of(march), at, surface, jet);
}

/* Moves an end along its border to where F is 0: roots of borders are found in nets, which round more than the surface, and
 * with noise added. An end that this would move farther is where rounding made it, and stays. */
static void polish(const struct march *march, struct march_end *end)
{
    static const double MOST = 1e-3;
    double at[2] = {end->at[0], end->at[1]}, step = 1;
    int moved = 1 - end->fixed;
    if (end->fixed < 0)
        return;
    for (int i = 0; i < 8 && fabs(step) > 0x1p-50; i++) {
        struct bezier_jet surface;
        double jet[3];
        jet_at(march, at, &surface, jet);
        step = jet[0] == 0 ? 0 : -jet[0] / jet[1 + moved];
        at[moved] += step;
        if (!(fabs(at[moved] - end->at[moved]) <= MOST && at[moved] >= 0 && at[moved] <= 1))
            return;
    }
    end->at[moved] = at[moved];
}

struct traced_point march_point(const struct march *march, const double at[2])
{
    struct bezier_jet surface;
    double jet[3];
    jet_at(march, at, &surface, jet);
    return point_of(march, at, &surface, jet);
}

/* Steps of Newton's method that a point of a smooth line takes. More of them count as work. */
enum { USUAL_STEPS = 12 };

/* A march over one parameter. */
struct over {
    const struct march *march;
    const struct march_square *square;
    int axis, slope;
    double way;  /* 1 or -1: the sign of the steps along the axis */
    bool failed; /* memory was short */
    bool is_cut; /* the patch's limit of work was reached, so points are missing */
    struct traced_point *point;
    double (*at)[2]; /* the patch's parameters of each point */
    size_t n, room;
};

/* Sets at[] of the other parameter so that F is 0: Newton's method within a bracket, from `guess`. */
static struct traced_point solve(const struct over *over, double x, double guess, double at[2])
{
    const struct march_square *square = over->square;
    int other = 1 - over->axis;
    double low = square->at[other], high = low + square->size, y = guess;
    struct bezier_jet surface;
    double jet[3];
    at[over->axis] = x;
    for (int i = 0;; i++) {
        over->march->tracer->n_work += i > USUAL_STEPS;
        at[other] = y;
        jet_at(over->march, at, &surface, jet);
        double step = -jet[0] / jet[1 + other], to = y + step;
        if (jet[0] == 0 || fabs(step) <= 0x1p-47 || i == 100)
            break;
        *(jet[0] * over->slope < 0 ? &low : &high) = y;
        if (!(to > low && to < high))
            to = 0.5 * (low + high);
        if (to == y || high - low <= 0x1p-52)
            break;
        y = to;
    }
    return point_of(over->march, at, &surface, jet);
}

static void turn_along(const struct over *over, struct traced_point *point)
{
    /* F's derivatives by (u,v) are the slope's direction turned by a quarter: by sign, along the axis the tangent (F_v,
     * -F_u) has the sign of F_v, or the other sign of F_u. */
    bool runs_up = (over->axis == 0) == (over->slope > 0);
    if (runs_up != (over->way > 0))
        point->along = vec_scale(point->along, -1);
}

static void put(struct over *over, const struct traced_point *point, const double at[2])
{
    if (over->n >= over->march->tracer->most_points) {
        over->march->tracer->is_over = over->failed = true;
        return;
    }
    if (over->n == over->room) {
        size_t room = over->room ? 2 * over->room : 16;
        struct traced_point *points = realloc(over->point, room * sizeof *points);
        if (points)
            over->point = points;
        double(*places)[2] = realloc(over->at, room * sizeof *places);
        if (places)
            over->at = places;
        if (!points || !places) {
            over->failed = true;
            return;
        }
        over->room = room;
    }
    over->point[over->n] = *point;
    memcpy(over->at[over->n++], at, 2 * sizeof *at);
}

/* How far the line may be from the chord between two points: exact for a circle that is met at the same angle at
 * both ends. */
static double sagitta(const struct traced_point *a, const struct traced_point *b)
{
    struct vec chord = vec_sub(b->p, a->p);
    double length = vec_length(chord);
    if (!(length > 0))
        return 0;
    double sines[2];
    for (int k = 0; k < 2; k++) {
        struct vec along = k ? b->along : a->along;
        bool forward = vec_dot(along, chord) > 0;
        sines[k] = forward ? vec_length(vec_cross(along, chord)) / length : 1;
    }
    return 0.25 * length * fmax(sines[0], sines[1]);
}

static double distance_from_chord(struct vec p, struct vec a, struct vec b)
{
    struct vec chord = vec_sub(b, a), to = vec_sub(p, a);
    double length = vec_length(chord);
    return length > 0 ? vec_length(vec_cross(chord, to)) / length : vec_length(to);
}

enum { MOST_HALVINGS = 24 };

/* Puts the points between a and b, and b. */
static void refine(struct over *over, struct traced_point a, const double from[2],
                   struct traced_point b, const double to[2], int depth)
{
    double tolerance = over->march->tracer->tolerance;
    bool is_straight = sagitta(&a, &b) <= tolerance;
    struct tracer *tracer = over->march->tracer;
    over->is_cut |= tracer->n_work > TRACE_MOST_WORK;
    if (over->failed || over->is_cut || computation_is_cancelled(tracer->work.computation) ||
        depth == MOST_HALVINGS || (depth > 0 && is_straight)) {
        put(over, &b, to);
        return;
    }
    int other = 1 - over->axis;
    double middle[2];
    struct traced_point m = solve(over, 0.5 * (from[over->axis] + to[over->axis]),
                                  0.5 * (from[other] + to[other]), middle);
    turn_along(over, &m);
    if (is_straight && distance_from_chord(m.p, a.p, b.p) <= tolerance) {
        put(over, &b, to);
        return;
    }
    refine(over, a, from, m, middle, depth + 1);
    refine(over, m, middle, b, to, depth + 1);
}

/* The place between points k and k + 1, of which one is met, where the line begins or ends to be met. */
static struct traced_point find_end(const struct over *over, size_t k)
{
    int other = 1 - over->axis;
    double a[2], b[2], at[2];
    bool first_met = !isnan(over->point[k].residual);
    struct traced_point met = over->point[first_met ? k : k + 1], point;
    memcpy(a, over->at[first_met ? k : k + 1], sizeof a);
    memcpy(b, over->at[first_met ? k + 1 : k], sizeof b);
    for (int i = 0; i < 60; i++) {
        double x = 0.5 * (a[over->axis] + b[over->axis]);
        if (x == a[over->axis] || x == b[over->axis])
            break;
        point = solve(over, x, 0.5 * (a[other] + b[other]), at);
        bool is_met = !isnan(point.residual);
        memcpy(is_met ? a : b, at, sizeof at);
        if (is_met)
            met = point;
    }
    turn_along(over, &met);
    return met;
}

/* Adds the parts of the points that rays meet. */
static void add_met(struct over *over, uint64_t from, uint64_t to)
{
    struct tracer *tracer = over->march->tracer;
    uint32_t line = over->march->line;
    struct traced_point *part = malloc((over->n + 2) * sizeof *part);
    size_t n = 0;
    uint64_t start = from;
    tracer->work.failed |= !part;
    for (size_t k = 0; part && k < over->n; k++) {
        bool met = !isnan(over->point[k].residual);
        bool was_met = k > 0 && !isnan(over->point[k - 1].residual);
        if (k > 0 && met != was_met) {
            uint64_t end = tracer->work.next_node++;
            part[n++] = find_end(over, k - 1);
            if (was_met && n > 1)
                march_add(tracer, line, start, end, part, n);
            start = end;
            n = was_met ? 0 : n;
        }
        if (met)
            part[n++] = over->point[k];
    }
    if (n > 1)
        march_add(tracer, line, start, to, part, n);
    free(part);
}

void march_arc(const struct march *march, const struct march_square *square, int axis, int slope,
               const struct march_end *start, const struct march_end *end)
{
    struct march_end ends[2] = {*start, *end}, *from = &ends[0], *to = &ends[1];
    struct over over = {.march = march, .square = square, .axis = axis, .slope = slope};
    if (from->at[axis] == to->at[axis]) {
        march_straight(march, from, to);
        return;
    }
    polish(march, from);
    polish(march, to);
    over.way = to->at[axis] > from->at[axis] ? 1 : -1;
    struct traced_point first = march_point(march, from->at), last = march_point(march, to->at);
    turn_along(&over, &first);
    turn_along(&over, &last);
    put(&over, &first, from->at);
    if (!over.failed)
        refine(&over, first, from->at, last, to->at, 0);
    if (over.failed)
        march->tracer->work.failed = true;
    else
        add_met(&over, from->node, to->node);
    if (over.is_cut)
        march_mark(march->tracer, MARK_SINGULAR, march->line, to->node, &last);
    free(over.point);
    free(over.at);
}

void march_straight(const struct march *march, const struct march_end *start,
                    const struct march_end *end)
{
    struct march_end ends[2] = {*start, *end}, *from = &ends[0], *to = &ends[1];
    polish(march, from);
    polish(march, to);
    struct traced_point points[2] = {march_point(march, from->at), march_point(march, to->at)};
    points[0].along = points[1].along = (struct vec){0, 0, 0};
    if (!isnan(points[0].residual) || !isnan(points[1].residual))
        march_add(march->tracer, march->line, from->node, to->node, points, 2);
}
