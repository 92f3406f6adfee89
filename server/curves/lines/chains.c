#include "server/curves/lines/chains.h"

#include <math.h>
#include <stdlib.h>

static const size_t NONE = SIZE_MAX;

/* One end of an arc, sorted by line and node, so that the ends at one node are neighbours. */
struct arc_end {
    uint32_t line;
    uint64_t node;
    size_t arc; /* arc << 1 | end */
};

struct chains {
    const struct traced_arc **arc;
    const struct traced_point **point; /* of each arc */
    size_t n_arcs;
    size_t *mate; /* of each end: the arc end that it is joined with, or NONE */
    bool *used;
    struct curve_set *set;
};

static int compare_ends(const void *left, const void *right)
{
    const struct arc_end *a = left, *b = right;
    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    if (a->node != b->node)
        return a->node < b->node ? -1 : 1;
    return a->arc < b->arc ? -1 : a->arc > b->arc;
}

/* Joins the ends at nodes with exactly two ends. */
static void find_mates(struct chains *chains, struct arc_end *ends)
{
    size_t n = 2 * chains->n_arcs;
    for (size_t k = 0; k < n; k++) {
        const struct traced_arc *arc = chains->arc[k / 2];
        ends[k] = (struct arc_end){arc->line, arc->node[k & 1], k};
        chains->mate[k] = NONE;
    }
    qsort(ends, n, sizeof *ends, compare_ends);
    for (size_t k = 0, next = 0; k < n; k = next) {
        for (next = k + 1; next < n; next++)
            if (ends[next].line != ends[k].line || ends[next].node != ends[k].node)
                break;
        if (next - k == 2) {
            chains->mate[ends[k].arc] = ends[k + 1].arc;
            chains->mate[ends[k + 1].arc] = ends[k].arc;
        }
    }
}

/* Where two arcs meet, each has a point of its own: the one nearer to its line stays. */
static void meet(struct traced_point *last, const struct traced_point *first)
{
    if (isnan(last->residual) || fabs(first->residual) < fabs(last->residual))
        *last = *first;
}

/* Appends the points of an arc, entered at `end`, without what it shares with the points before. */
static void append(struct chains *chains, struct curve *curve, size_t end)
{
    const struct traced_arc *arc = chains->arc[end / 2];
    const struct traced_point *points = chains->point[end / 2];
    for (uint32_t k = 0; k < arc->n; k++) {
        struct traced_point point = points[end & 1 ? arc->n - 1 - k : k];
        if (end & 1)
            point.along = vec_scale(point.along, -1);
        if (k == 0 && curve->n > 0)
            meet(&chains->set->point[chains->set->n_points - 1], &point);
        else {
            chains->set->point[chains->set->n_points++] = point;
            curve->n++;
        }
    }
    chains->used[end / 2] = true;
}

/* Adds the curve that begins with an arc entered at `end`. */
static void follow(struct chains *chains, size_t end)
{
    struct curve_set *set = chains->set;
    struct curve curve = {chains->arc[end / 2]->line, false, set->n_points, 0};
    size_t start = end;
    for (; end != NONE && !chains->used[end / 2]; end = chains->mate[end ^ 1])
        append(chains, &curve, end);
    if (end == start && curve.n > 2) {
        curve.closed = true;
        meet(&set->point[curve.first], &set->point[--set->n_points]);
        curve.n--;
    }
    set->curve[set->n_curves++] = curve;
}

/* Unit tangents where the arcs had none: along the neighbours. */
static void find_tangents(const struct curve_set *set, const struct curve *curve)
{
    struct traced_point *point = set->point + curve->first;
    for (size_t k = 0; k < curve->n; k++) {
        if (vec_dot(point[k].along, point[k].along) > 0)
            continue;
        size_t before = k > 0 ? k - 1 : curve->closed ? curve->n - 1 : 0;
        size_t after = k + 1 < curve->n ? k + 1 : curve->closed ? 0 : k;
        point[k].along = vec_unit(vec_sub(point[after].p, point[before].p));
    }
}

static void find_lengths(const struct curve_set *set, const struct curve *curve)
{
    double sum = 0;
    for (size_t k = curve->first; k < curve->first + curve->n; k++) {
        if (k > curve->first)
            sum += vec_length(vec_sub(set->point[k].p, set->point[k - 1].p));
        set->length[k] = sum;
    }
}

static int compare_curves(const void *left, const void *right)
{
    const struct curve *a = left, *b = right;
    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    return a->first < b->first ? -1 : a->first > b->first;
}

static void link(struct chains *chains)
{
    struct curve_set *set = chains->set;
    /* Open curves begin at an end without a mate; what is left then is closed. */
    for (int closed = 0; closed < 2; closed++)
        for (size_t end = 0; end < 2 * chains->n_arcs; end++)
            if (!chains->used[end / 2] && (closed || chains->mate[end] == NONE))
                follow(chains, end);
    for (size_t k = 0; k < set->n_curves; k++) {
        find_tangents(set, &set->curve[k]);
        find_lengths(set, &set->curve[k]);
    }
    qsort(set->curve, set->n_curves, sizeof *set->curve, compare_curves);
}

static void *array_of(size_t n, size_t size)
{
    return calloc(n ? n : 1, size);
}

bool curve_set_make(struct curve_set *set, const struct traced *parts, size_t n,
                    struct error *error)
{
    struct chains chains = {.set = set};
    size_t n_points = 0;
    *set = (struct curve_set){0};
    for (size_t k = 0; k < n; k++) {
        chains.n_arcs += parts[k].n_arcs;
        n_points += parts[k].n_points;
    }
    struct arc_end *ends = array_of(2 * chains.n_arcs, sizeof *ends);
    chains.arc = array_of(chains.n_arcs, sizeof *chains.arc);
    chains.point = array_of(chains.n_arcs, sizeof *chains.point);
    chains.mate = array_of(2 * chains.n_arcs, sizeof *chains.mate);
    chains.used = array_of(chains.n_arcs, sizeof *chains.used);
    set->curve = array_of(chains.n_arcs, sizeof *set->curve);
    set->point = array_of(n_points, sizeof *set->point);
    set->length = array_of(n_points, sizeof *set->length);
    bool ok = ends && chains.arc && chains.point && chains.mate && chains.used && set->curve &&
              set->point && set->length;
    if (ok) {
        size_t at = 0;
        for (size_t k = 0; k < n; k++) {
            for (size_t i = 0; i < parts[k].n_arcs; i++, at++) {
                chains.arc[at] = &parts[k].arc[i];
                chains.point[at] = parts[k].point + parts[k].arc[i].first;
            }
        }
        find_mates(&chains, ends);
        link(&chains);
    }
    free(ends);
    free(chains.arc);
    free(chains.point);
    free(chains.mate);
    free(chains.used);
    if (!ok) {
        curve_set_finish(set);
        return error_set(error, ERROR_SERVER, "out of memory for the curves of %zu arcs",
                         chains.n_arcs);
    }
    return true;
}

void curve_set_finish(struct curve_set *set)
{
    free(set->curve);
    free(set->point);
    free(set->length);
    *set = (struct curve_set){0};
}
