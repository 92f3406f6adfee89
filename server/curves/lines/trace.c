#include "server/curves/lines/trace.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/curves/lines/march.h"
#include "server/surface/evaluate.h"

/* A square that was halved so often is 1e-6 of its patch. */
enum { MOST_DEPTH = 20 };
/* For one line on one patch: beyond these, undecided squares are marked. */
enum { MOST_CELLS = 4096, MOST_ROOTS = 4096 };

struct cell_root {
    double t;
    uint64_t node;
};

struct cell_side {
    const struct cell_root *root;
    int n;
};

/* A square of a patch for one line. */
struct cell {
    struct net f; /* with the noise added, so that signs are those of the borders */
    struct march_square square;
    bool sign[4];
    struct cell_side side[4];
    int depth;
};

/* One line on one patch. */
struct cells {
    struct march march;
    double r[FIELD_TERMS]; /* where r G < 0 nothing is met; all 0: not known */
    struct cell_root *pool;
    int n_pool;
    int n_cells;
    bool overflows; /* one of the limits above was reached */
};

void region_finish(struct region *region)
{
    for (int k = 0; k < 4; k++)
        root_list_finish(&region->side[k]);
}

/* The place of a crossing in the patch. */
static struct march_end end_at(const struct march_square *square, int side,
                               const struct cell_root *root)
{
    double t = root->t;
    const double u[4] = {t, 1, 1 - t, 0}, v[4] = {0, t, 1, 1 - t};
    return (struct march_end){
        {square->at[0] + square->size * u[side], square->at[1] + square->size * v[side]},
        !(side & 1),
        root->node};
}

static int n_roots(const struct cell *cell)
{
    return cell->side[0].n + cell->side[1].n + cell->side[2].n + cell->side[3].n;
}

/* Joins crossings that only rounding made, or that are too many to be told apart: always the two neighbours on the border
 * that are nearest to each other, so that arcs do not cross. */
static void join_nearest(struct cells *cells, const struct cell *cell)
{
    struct march_end ends[64];
    int n = 0;
    for (int s = 0; s < 4; s++)
        for (int k = 0; k < cell->side[s].n && n < 64; k++)
            ends[n++] = end_at(&cell->square, s, &cell->side[s].root[k]);
    while (n > 1) {
        int best = 0;
        double least = INFINITY;
        for (int k = 0; k < n; k++) {
            const struct march_end *a = &ends[k], *b = &ends[(k + 1) % n];
            double d = fabs(a->at[0] - b->at[0]) + fabs(a->at[1] - b->at[1]);
            if (d < least) {
                least = d;
                best = k;
            }
        }
        int next = (best + 1) % n, low = best < next ? best : next,
            high = best < next ? next : best;
        march_straight(&cells->march, &ends[best], &ends[next]);
        memmove(ends + high, ends + high + 1, (size_t)(n - high - 1) * sizeof *ends);
        n--;
        memmove(ends + low, ends + low + 1, (size_t)(n - low - 1) * sizeof *ends);
        n--;
    }
}

/* Marks the square, and lets all arcs at its border end in the mark. */
static void mark(struct cells *cells, const struct cell *cell)
{
    struct tracer *tracer = cells->march.tracer;
    const struct march_square *square = &cell->square;
    double middle[2] = {square->at[0] + 0.5 * square->size, square->at[1] + 0.5 * square->size};
    struct march_end end = {{middle[0], middle[1]}, -1, tracer->work.next_node++};
    struct traced_point at = march_point(&cells->march, middle);
    if (isnan(at.residual) && n_roots(cell) == 0)
        return; /* no ray meets it */
    march_mark(tracer, MARK_SINGULAR, cells->march.line, end.node, &at);
    for (int s = 0; s < 4; s++) {
        for (int k = 0; k < cell->side[s].n; k++) {
            struct march_end from = end_at(square, s, &cell->side[s].root[k]);
            march_straight(&cells->march, &from, &end);
        }
    }
}

/* Adds the arcs of a square where F has one slope along the parameter that is not `axis`. The square is swept along the axis: the
 * line is there while the signs on both sides, `near` and `far`, differ. */
static void trace_graph(struct cells *cells, const struct cell *cell, int axis, int slope)
{
    /* Along u: from side 3 to side 1, between sides 0 (run through forwards) and 2 (backwards). Along v: from side 0 to 2,
     * between sides 1 (forwards) and 3 (backwards). */
    int near = axis ? 1 : 0, far = axis ? 3 : 2, start = axis ? 0 : 3, end = axis ? 2 : 1;
    const struct cell_side *a = &cell->side[near], *b = &cell->side[far];
    bool is_there = cell->sign[near] != cell->sign[(far + 1) & 3];
    if (cell->side[start].n != is_there || cell->side[end].n > 1) {
        join_nearest(cells, cell);
        return;
    }
    struct march_end from = {{0, 0}, -1, 0};
    if (is_there)
        from = end_at(&cell->square, start, cell->side[start].root);
    for (int i = 0, k = b->n; i < a->n || k > 0;) {
        double ta = i < a->n ? a->root[i].t : 2, tb = k > 0 ? 1 - b->root[k - 1].t : 2;
        struct march_end at = ta <= tb ? end_at(&cell->square, near, &a->root[i++])
                                       : end_at(&cell->square, far, &b->root[--k]);
        if (is_there)
            march_arc(&cells->march, &cell->square, axis, slope, &from, &at);
        from = at;
        is_there = !is_there;
    }
    if (is_there) {
        struct march_end at = end_at(&cell->square, end, cell->side[end].root);
        march_arc(&cells->march, &cell->square, axis, slope, &from, &at);
    }
}

static struct cell_root *take_roots(struct cells *cells, int n)
{
    if (cells->n_pool + n > MOST_ROOTS) {
        cells->overflows = true;
        return NULL;
    }
    cells->n_pool += n;
    return cells->pool + cells->n_pool - n;
}

/* The roots of a side between t = a and t = b, as seen from there. */
static struct cell_side part_of(struct cells *cells, const struct cell_side *side, double a,
                                double b)
{
    int first = 0, last = side->n;
    while (first < last && side->root[first].t < a)
        first++;
    while (last > first && b < 1 && side->root[last - 1].t >= b)
        last--;
    struct cell_root *roots = take_roots(cells, last - first);
    for (int k = first; roots && k < last; k++)
        roots[k - first] = (struct cell_root){(side->root[k].t - a) / (b - a), side->root[k].node};
    return (struct cell_side){roots, roots ? last - first : 0};
}

static struct cell_side reversed(struct cells *cells, const struct cell_side *side)
{
    struct cell_root *roots = take_roots(cells, side->n);
    for (int k = 0; roots && k < side->n; k++)
        roots[side->n - 1 - k] = (struct cell_root){1 - side->root[k].t, side->root[k].node};
    return (struct cell_side){roots, roots ? side->n : 0};
}

static bool sign_at_middle(const struct cell *cell, int side)
{
    bool sign = cell->sign[side];
    for (int k = 0; k < cell->side[side].n && cell->side[side].root[k].t < 0.5; k++)
        sign = !sign;
    return sign;
}

/* The crossings on the border from the middle of a side to the middle of the square. c has the n + 1 coefficients there. */
static struct cell_side spoke(struct cells *cells, const double *c, int n, bool start, bool end)
{
    double t[NET_MOST_DEGREE + 2];
    int count = 0;
    bool sign = c[0] < 0;
    if (sign != start)
        t[count++] = 0;
    int found = curve_roots(c, n, t + count);
    sign ^= found & 1;
    count += found;
    if (sign != end)
        t[count++] = 1;
    struct cell_root *roots = take_roots(cells, count);
    for (int k = 0; roots && k < count; k++)
        roots[k] = (struct cell_root){t[k], cells->march.tracer->work.next_node++};
    return (struct cell_side){roots, roots ? count : 0};
}

static void trace_cell(struct cells *cells, const struct cell *cell);

/* The coefficients of F on spoke e, from the middle of side e to the middle, out of the quarters of the net. */
static int spoke_coefficients(const struct net quarter[4], int e, double *c)
{
    /* Spokes 0 and 3 run upwards along the first and last row of quarters 1 and 0, spokes 1 and 2 the other way. */
    const struct net *net = &quarter[e == 3 ? 0 : e == 2 ? 2 : 1];
    bool along_v = e == 0 || e == 2, backwards = e == 1 || e == 2;
    int n = along_v ? net->n : net->m, width = net->n + 1;
    for (int k = 0; k <= n; k++)
        c[backwards ? n - k : k] = along_v ? net->c[k] : net->c[k * width + net->n];
    return n;
}

static void split(struct cells *cells, const struct cell *cell)
{
    struct net_room *room = &cells->march.tracer->work.room;
    size_t mark_room = room->used;
    int mark_pool = cells->n_pool, m = cell->f.m, n = cell->f.n;
    struct net half[2], quarter[4];
    for (int k = 0; k < 4; k++)
        quarter[k] = net_take(room, m, n);
    for (int k = 0; k < 2; k++)
        half[k] = net_take(room, m, n);
    net_halve(&cell->f, 0, &half[0], &half[1]);
    net_halve(&half[0], 1, &quarter[0], &quarter[3]);
    net_halve(&half[1], 1, &quarter[1], &quarter[2]);
    bool centre = quarter[2].c[0] < 0, middle[4];
    struct cell_side spokes[4];
    for (int e = 0; e < 4; e++) {
        double c[NET_MOST_DEGREE + 1];
        int degree = spoke_coefficients(quarter, e, c);
        middle[e] = sign_at_middle(cell, e);
        spokes[e] = spoke(cells, c, degree, middle[e], centre);
    }
    for (int k = 0; k < 4; k++) {
        int next = (k + 1) & 3, before = (k + 3) & 3, mark_child = cells->n_pool;
        double size = 0.5 * cell->square.size;
        struct cell child = {.f = quarter[k],
                             .square = {{cell->square.at[0] + (k == 1 || k == 2 ? size : 0),
                                         cell->square.at[1] + (k >= 2 ? size : 0)},
                                        size},
                             .depth = cell->depth + 1};
        child.sign[k] = cell->sign[k];
        child.sign[next] = middle[k];
        child.sign[(k + 2) & 3] = centre;
        child.sign[before] = middle[before];
        child.side[k] = part_of(cells, &cell->side[k], 0, 0.5);
        child.side[next] = spokes[k];
        child.side[(k + 2) & 3] = reversed(cells, &spokes[before]);
        child.side[before] = part_of(cells, &cell->side[before], 0.5, 1);
        trace_cell(cells, &child);
        cells->n_pool = mark_child;
    }
    cells->n_pool = mark_pool;
    room->used = mark_room;
}

static void trace_cell(struct cells *cells, const struct cell *cell)
{
    struct tracer *tracer = cells->march.tracer;
    int roots = n_roots(cell);
    tracer->n_cells++;
    if ((size_t)cell->depth > tracer->n_deepest)
        tracer->n_deepest = (size_t)cell->depth;
    if (net_sign(&cell->f)) {
        if (roots)
            join_nearest(cells, cell);
        return;
    }
    int by_u = net_slope_sign(&cell->f, 0), by_v = net_slope_sign(&cell->f, 1);
    if (by_v && (!by_u || cell->side[3].n + cell->side[1].n >= cell->side[0].n + cell->side[2].n))
        trace_graph(cells, cell, 0, by_v);
    else if (by_u)
        trace_graph(cells, cell, 1, by_u);
    else if (cell->depth == MOST_DEPTH || ++cells->n_cells > MOST_CELLS || cells->overflows)
        mark(cells, cell);
    else
        split(cells, cell);
}

/* F's net of a line, with the noise added. */
static void combine(const struct field_nets *nets, const struct field_line *line, struct net *f)
{
    double noise = LINE_NOISE * field_bound(nets, line);
    size_t size = net_size(f);
    for (size_t k = 0; k < size; k++)
        f->c[k] = noise + line->w[0] * nets->g[0].c[k];
    for (int g = 1; g < nets->n_terms; g++)
        for (size_t k = 0; k < size; k++)
            f->c[k] += line->w[g] * nets->g[g].c[k];
}

/* True if no ray meets the line anywhere on the patch. */
static bool is_never_met(const struct field_nets *nets, const struct field_line *line)
{
    if (nets->facing == 0)
        return false;
    size_t size = net_size(&nets->g[0]);
    for (size_t k = 0; k < size; k++) {
        double sum = 0;
        for (int g = 0; g < nets->n_terms; g++)
            sum += line->r[g] * nets->g[g].c[k];
        if (!(sum * nets->facing < 0))
            return false;
    }
    return true;
}

/* Marks a patch that the line covers: F does not differ from 0. */
static bool is_flat(const struct field_nets *nets, const struct field_line *line,
                    const struct net *f)
{
    double noise = LINE_NOISE * field_bound(nets, line);
    for (size_t k = 0; k < net_size(f); k++)
        if (fabs(f->c[k] - noise) > 0.5 * noise)
            return false;
    return true;
}

static bool is_finite(const struct net *f)
{
    double sum = 0;
    for (size_t k = 0; k < net_size(f); k++)
        sum += fabs(f->c[k]);
    return isfinite(sum);
}

/* The first root of a line in a side's list, which is in the order of lines. */
static size_t first_of(const struct root_list *list, uint32_t line)
{
    size_t low = 0, high = list->n;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (list->root[middle].line < line)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool has_roots(const struct region *region, uint32_t line)
{
    for (int k = 0; k < 4; k++) {
        const struct root_list *list = &region->side[k];
        size_t first = first_of(list, line);
        if (first < list->n && list->root[first].line == line)
            return true;
    }
    return false;
}

static struct cell_side side_of(struct cells *cells, const struct root_list *list, uint32_t line)
{
    size_t first = first_of(list, line), last = first;
    while (last < list->n && list->root[last].line == line)
        last++;
    struct cell_root *roots = take_roots(cells, (int)(last - first));
    for (size_t k = first; roots && k < last; k++)
        roots[k - first] = (struct cell_root){list->root[k].t, list->root[k].node};
    return (struct cell_side){roots, roots ? (int)(last - first) : 0};
}

static void trace_line(struct cells *cells, const struct field_nets *nets,
                       const struct region *region, struct net f)
{
    struct tracer *tracer = cells->march.tracer;
    uint32_t line = cells->march.line;
    const struct field_line *at = &tracer->work.set->line[line];
    struct cell cell = {.f = f, .square = {{0, 0}, 1}};
    cells->n_pool = cells->n_cells = 0;
    cells->overflows = false;
    for (int k = 0; k < 4; k++) {
        cell.sign[k] = line_sign(&region->sign[k], line);
        cell.side[k] = side_of(cells, &region->side[k], line);
    }
    combine(nets, at, &f);
    if (!is_finite(&f))
        return; /* light or eye are so far away that numbers overflow */
    if (is_flat(nets, at, &f)) {
        const double middle[2] = {0.5, 0.5};
        struct traced_point point = march_point(&cells->march, middle);
        if (!isnan(point.residual))
            march_mark(tracer, MARK_FLAT, line, tracer->work.next_node++, &point);
        return;
    }
    if (n_roots(&cell) == 0 && net_sign(&f))
        return;
    if (!is_never_met(nets, at))
        trace_cell(cells, &cell);
}

void trace_patch(struct tracer *tracer, const struct limit_patch *patch,
                 const struct patch_place *place, const struct region *region)
{
    const struct line_set *set = tracer->work.set;
    struct net_room *room = &tracer->work.room;
    struct cell_root pool[MOST_ROOTS];
    struct bezier bezier;
    struct bezier_nets surface;
    struct bezier_box surface_box;
    size_t mark = room->used;
    bezier_of_patch(&bezier, tracer->work.tables, patch);
    bezier_make_nets(&bezier, room, &surface);
    bezier_box_of(&surface, &surface_box);
    for (uint32_t f = 0; f < set->n_fields; f++) {
        size_t before = room->used;
        struct cells cells = {.march = {tracer, &bezier, place, &set->field[f], 0}, .pool = pool};
        struct field_nets nets;
        struct net net = {0};
        struct field_box box;
        field_make_box(&set->field[f], bezier.origin, &surface_box, &box);
        for (uint32_t i = set->first_line[f]; i < set->first_line[f + 1]; i++) {
            if (*tracer->cancelled || tracer->work.failed)
                break;
            if (field_box_sign(&box, &set->line[i]) && !has_roots(region, i))
                continue;
            if (!net.c) { /* the first line that needs them */
                field_make_nets(&set->field[f], room, bezier.origin, &surface, &nets);
                net = net_take(room, nets.g[0].m, nets.g[0].n);
            }
            cells.march.line = i;
            trace_line(&cells, &nets, region, net);
        }
        room->used = before;
    }
    room->used = mark;
}

/* The surface's point at a crossing on a side of a region; the side's place in the node is that of a square at local
 * (0,0). */
static struct traced_point point_on_side(const struct tracer *tracer,
                                         const struct patch_place *place, int side, double t)
{
    const double x[4] = {t, 1, 1 - t, 0}, y[4] = {0, t, 1, 1 - t};
    struct traced_point point = {.residual = 0};
    struct limit_point at;
    trace_face_place(tracer->work.tables, place->node, place->x0 + place->width * x[side],
                     place->y0 + place->height * y[side], &point);
    if (limit_evaluate(tracer->work.tables, point.face, point.u, point.v, &at)) {
        point.p = at.s;
        point.n = at.n;
    }
    return point;
}

void trace_vertex(struct tracer *tracer, const struct patch_place *place,
                  const struct region *region)
{
    const struct line_set *set = tracer->work.set;
    for (uint32_t f = 0; f < set->n_fields; f++) {
        for (uint32_t i = set->first_line[f]; i < set->first_line[f + 1]; i++) {
            struct traced_point ends[64];
            uint64_t node[64];
            int n = 0;
            for (int s = 0; s < 4; s++) {
                const struct root_list *list = &region->side[s];
                for (size_t k = first_of(list, i); k < list->n && list->root[k].line == i && n < 64;
                     k++) {
                    ends[n] = point_on_side(tracer, place, s, list->root[k].t);
                    ends[n].residual =
                        field_residual(&set->field[f], &set->line[i], ends[n].p, ends[n].n);
                    node[n++] = list->root[k].node;
                }
            }
            if (n > 2) {
                struct traced_point at = point_on_side(tracer, place, 0, 0);
                uint64_t vertex = tracer->work.next_node++;
                march_mark(tracer, MARK_SINGULAR, i, vertex, &at);
                for (int k = 0; k < n; k++) {
                    struct traced_point piece[2] = {ends[k], at};
                    if (!isnan(ends[k].residual))
                        march_add(tracer, i, node[k], vertex, piece, 2);
                }
            } else if (n == 2 && (!isnan(ends[0].residual) || !isnan(ends[1].residual))) {
                march_add(tracer, i, node[0], node[1], ends, 2);
            }
        }
    }
}
