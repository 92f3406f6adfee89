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

/* A square of a patch, for all lines of a field: what is found once is kept for the lines that follow. */
struct trace_square {
    struct piece piece;
    struct piece_range range;
    struct field_range terms;
    struct crossings spokes[4];    /* from the middles of the sides to the middle */
    struct trace_square *quarters; /* 4, or NULL */
    int field, spoke_field[4]; /* of which field the terms are, and those of each spoke; -1: none */
};

/* Squares down to this depth are kept until the patch is done: 1 + 4 + 16 + 64. Below, 4 squares of each depth are in use. */
enum { KEPT_DEPTH = 3, MOST_SQUARES = 85 + 4 * (MOST_DEPTH - KEPT_DEPTH) };

/* A square of a patch for one line. */
struct cell {
    struct trace_square *at;
    struct march_square square;
    bool sign[4];
    struct cell_side side[4];
    int depth;
};

/* One line on one patch. */
struct cells {
    struct march march;
    int field;
    int *n_squares; /* of the tracer's, which are in use */
    double noise;
    size_t first_mark; /* of the patch, in the tracer's marks */
    struct cell_root *pool;
    int n_pool;
    int n_cells;
    bool overflows; /* one of the line's limits above was reached */
};

struct trace_square *trace_squares_take(void)
{
    return malloc(MOST_SQUARES * sizeof(struct trace_square));
}

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

/* Whether rays meet the line at the middle or at a corner of a square. */
static bool is_met_anywhere(const struct cells *cells, const struct march_square *square)
{
    for (int k = 0; k < 5; k++) {
        const double share[5][2] = {{0.5, 0.5}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const double at[2] = {square->at[0] + square->size * share[k][0],
                              square->at[1] + square->size * share[k][1]};
        if (!isnan(march_point(&cells->march, at).residual))
            return true;
    }
    return false;
}

/* The node of the line's mark within the tolerance of a point; 0 if there is none. Around a point where the surface has no normal
 * many squares are undecided. */
static uint64_t node_of_mark(const struct cells *cells, const struct traced_point *at)
{
    const struct tracer *tracer = cells->march.tracer;
    for (size_t k = cells->first_mark; k < tracer->out.n_marks; k++) {
        const struct traced_mark *mark = &tracer->out.mark[k];
        if (mark->line == cells->march.line && mark->kind == MARK_SINGULAR &&
            vec_length(vec_sub(mark->at.p, at->p)) <= tracer->tolerance)
            return mark->node;
    }
    return 0;
}

/* Marks the square, and lets all arcs at its border end in the mark. */
static void mark(struct cells *cells, const struct cell *cell)
{
    struct tracer *tracer = cells->march.tracer;
    const struct march_square *square = &cell->square;
    double middle[2] = {square->at[0] + 0.5 * square->size, square->at[1] + 0.5 * square->size};
    if (cell->depth == MOST_DEPTH && n_roots(cell) == 0 && !is_met_anywhere(cells, square))
        return;
    struct traced_point at = march_point(&cells->march, middle);
    struct march_end end = {{middle[0], middle[1]}, -1, node_of_mark(cells, &at)};
    if (!end.node) {
        end.node = tracer->work.next_node++;
        march_mark(tracer, MARK_SINGULAR, cells->march.line, end.node, &at);
    }
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

static struct trace_square *take_squares(struct cells *cells, int n)
{
    struct trace_square *squares = cells->march.tracer->squares + *cells->n_squares;
    *cells->n_squares += n;
    for (int k = 0; k < n; k++) {
        squares[k].quarters = NULL;
        squares[k].field = -1;
        for (int e = 0; e < 4; e++)
            squares[k].spoke_field[e] = -1;
    }
    return squares;
}

/* Makes what a square needs for a field. */
static void find_terms(const struct cells *cells, struct trace_square *square)
{
    const struct patch_field *on = cells->march.on;
    if (square->field < 0)
        piece_find_range(&square->piece, &square->range);
    if (square->field != cells->field)
        field_find_range(on->field, on->bezier->origin, &square->range, &square->terms);
    square->field = cells->field;
}

static void find_quarters(struct cells *cells, struct trace_square *square)
{
    if (!square->quarters) {
        struct piece pieces[4];
        square->quarters = take_squares(cells, 4);
        piece_quarter(&square->piece, pieces);
        for (int k = 0; k < 4; k++)
            square->quarters[k].piece = pieces[k];
    }
    for (int k = 0; k < 4; k++)
        find_terms(cells, &square->quarters[k]);
}

/* Finds the crossings on spoke e, which lies between quarters e and e + 1, where the line's signs are `negative` at its ends. */
static int find_on_spoke(struct cells *cells, struct trace_square *square, int e,
                         double range[4][RANGE_SIZE], const bool negative[2],
                         double at[MOST_CROSSINGS])
{
    const struct patch_field *on = cells->march.on;
    const struct field_line *line = &cells->march.tracer->work.set->line[cells->march.line];
    const double *beside[2] = {range[e], range[(e + 1) & 3]};
    int axis = !(e & 1);
    struct segment segment;
    for (int k = 0; k < 2; k++) {
        bool is_known = line_range_sign(beside[k], cells->noise) ||
                        range_slope_sign(beside[k], axis, cells->noise);
        if (is_known && negative[0] == negative[1])
            return 0;
        if (is_known) {
            piece_side(&square->quarters[e].piece, (e + 1) & 3, &segment);
            at[0] = crossings_only(&segment, on, line, negative[0]);
            return 1;
        }
    }
    if (square->spoke_field[e] != cells->field) {
        piece_side(&square->quarters[e].piece, (e + 1) & 3, &segment);
        crossings_init(&square->spokes[e], on, &segment);
        square->spoke_field[e] = cells->field;
    }
    return crossings_find(&square->spokes[e], on, line, negative, at, &cells->march.tracer->n_work);
}

static struct cell_side spoke(struct cells *cells, struct trace_square *square, int e,
                              double range[4][RANGE_SIZE], bool start, bool end)
{
    double at[MOST_CROSSINGS];
    const bool negative[2] = {start, end};
    int n = find_on_spoke(cells, square, e, range, negative, at);
    struct cell_root *roots = take_roots(cells, n);
    for (int k = 0; roots && k < n; k++)
        roots[k] = (struct cell_root){at[k], cells->march.tracer->work.next_node++};
    return (struct cell_side){roots, roots ? n : 0};
}

/* Whether F has the same sign in all of a square, by its quarters and theirs. */
static bool is_empty(struct cells *cells, struct trace_square *square, int sign, int depth)
{
    double range[RANGE_SIZE];
    const struct field_line *line = &cells->march.tracer->work.set->line[cells->march.line];
    if (field_quick_sign(&square->terms, line) == sign || field_is_never_met(&square->terms, line))
        return true;
    field_line_range(&square->terms, line, range);
    if (line_range_sign(range, cells->noise) == sign)
        return true;
    if (depth >= KEPT_DEPTH || range[0] * sign < 0)
        return false;
    find_quarters(cells, square);
    for (int k = 0; k < 4; k++)
        if (!is_empty(cells, &square->quarters[k], sign, depth + 1))
            return false;
    return true;
}

static void trace_cell(struct cells *cells, const struct cell *cell);

static void split(struct cells *cells, const struct cell *cell)
{
    int mark_pool = cells->n_pool, mark_squares = *cells->n_squares;
    double size = 0.5 * cell->square.size;
    const double at[2] = {cell->square.at[0] + size, cell->square.at[1] + size};
    const struct field_line *line = &cells->march.tracer->work.set->line[cells->march.line];
    bool middle[4];
    struct cell_side spokes[4];
    double range[4][RANGE_SIZE];
    find_quarters(cells, cell->at);
    if (n_roots(cell) == 0 && is_empty(cells, cell->at, cell->sign[0] ? -1 : 1, cell->depth))
        goto finish;
    bool centre = patch_field_is_negative(cells->march.on, line, at);
    for (int k = 0; k < 4; k++)
        field_line_range(&cell->at->quarters[k].terms, line, range[k]);
    for (int e = 0; e < 4; e++) {
        middle[e] = sign_at_middle(cell, e);
        spokes[e] = spoke(cells, cell->at, e, range, middle[e], centre);
    }
    for (int k = 0; k < 4; k++) {
        int next = (k + 1) & 3, before = (k + 3) & 3, mark_child = cells->n_pool;
        struct cell child = {.at = &cell->at->quarters[k],
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
finish:
    cells->n_pool = mark_pool;
    if (cell->depth >= KEPT_DEPTH) {
        cell->at->quarters = NULL;
        *cells->n_squares = mark_squares;
    }
}

/* Marks a patch that the line covers: F is 0, but for rounding. */
static bool mark_flat(struct cells *cells)
{
    static const double places[7][2] = {{0.5, 0.5},   {0.11, 0.23}, {0.83, 0.17}, {0.71, 0.89},
                                        {0.29, 0.67}, {0.41, 0.05}, {0.97, 0.53}};
    struct tracer *tracer = cells->march.tracer;
    const struct field_line *line = &tracer->work.set->line[cells->march.line];
    for (int k = 0; k < 7; k++) {
        double jet[3];
        patch_field_jet(cells->march.on, line, places[k], NULL, jet);
        if (!(fabs(jet[0]) <= 0.5 * cells->noise))
            return false;
    }
    struct traced_point point = march_point(&cells->march, places[0]);
    if (!isnan(point.residual))
        march_mark(tracer, MARK_FLAT, cells->march.line, tracer->work.next_node++, &point);
    return true;
}

/* Counts a square that is to be halved. False if one of the limits above was reached. */
static bool may_split(struct cells *cells)
{
    return ++cells->n_cells <= MOST_CELLS && ++cells->march.tracer->n_work <= TRACE_MOST_WORK &&
           !cells->overflows;
}

static void trace_cell(struct cells *cells, const struct cell *cell)
{
    struct tracer *tracer = cells->march.tracer;
    if (computation_is_cancelled(tracer->work.computation))
        return;
    const struct field_line *line = &tracer->work.set->line[cells->march.line];
    int roots = n_roots(cell);
    double range[RANGE_SIZE];
    tracer->n_cells++;
    if ((size_t)cell->depth > tracer->n_deepest)
        tracer->n_deepest = (size_t)cell->depth;
    find_terms(cells, cell->at);
    if (!roots &&
        (field_quick_sign(&cell->at->terms, line) || field_is_never_met(&cell->at->terms, line)))
        return;
    field_line_range(&cell->at->terms, line, range);
    if (line_range_sign(range, cells->noise)) {
        if (roots)
            join_nearest(cells, cell);
        return;
    }
    if (field_is_never_met(&cell->at->terms, line))
        return;
    int by_u = range_slope_sign(range, 0, cells->noise);
    int by_v = range_slope_sign(range, 1, cells->noise);
    bool is_overflow = !isfinite(range[0]) || !isfinite(cells->noise);
    if (by_v && (!by_u || cell->side[3].n + cell->side[1].n >= cell->side[0].n + cell->side[2].n))
        trace_graph(cells, cell, 0, by_v);
    else if (by_u)
        trace_graph(cells, cell, 1, by_u);
    else if (is_overflow || cell->depth == MOST_DEPTH || !may_split(cells))
        mark(cells, cell);
    else if (cell->depth > 0 || !mark_flat(cells))
        split(cells, cell);
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

static void trace_line(struct cells *cells, const struct region *region, struct trace_square *whole)
{
    uint32_t line = cells->march.line;
    struct cell cell = {.at = whole, .square = {{0, 0}, 1}};
    cells->n_pool = cells->n_cells = 0;
    cells->overflows = false;
    for (int k = 0; k < 4; k++) {
        cell.sign[k] = line_sign(&region->sign[k], line);
        cell.side[k] = side_of(cells, &region->side[k], line);
    }
    cells->noise = patch_field_noise(cells->march.on, &cells->march.tracer->work.set->line[line]);
    trace_cell(cells, &cell);
}

void trace_patch(struct tracer *tracer, const struct limit_patch *patch,
                 const struct patch_place *place, const struct region *region)
{
    const struct line_set *set = tracer->work.set;
    struct cell_root pool[MOST_ROOTS];
    struct bezier bezier;
    int n_squares = 0;
    bezier_of_patch(&bezier, tracer->work.tables, patch);
    tracer->n_work = 0;
    struct cells cells = {.march = {.tracer = tracer, .place = place},
                          .n_squares = &n_squares,
                          .first_mark = tracer->out.n_marks,
                          .pool = pool};
    struct trace_square *whole = take_squares(&cells, 1);
    piece_of_bezier(&bezier, &whole->piece);
    for (uint32_t f = 0; f < set->n_fields; f++) {
        struct patch_field on;
        patch_field_init(&on, &set->field[f], &bezier);
        cells.march.on = &on;
        cells.field = (int)f;
        find_terms(&cells, whole);
        for (uint32_t i = set->first_line[f]; i < set->first_line[f + 1]; i++) {
            if (computation_is_cancelled(tracer->work.computation) || tracer->work.failed)
                break;
            if (field_quick_sign(&whole->terms, &set->line[i]) && !has_roots(region, i))
                continue;
            cells.march.line = i;
            trace_line(&cells, region, whole);
        }
    }
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
