/* Samples of the comparison, slice by slice, and the choice of the worst ones. */
#include <math.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/curves/compare/parts.h"

/* Enters a sample in a list that is sorted by magnitude, worst first. */
static void enter_worst(struct worst_sample *list, size_t room, const struct worst_sample *sample)
{
    size_t i = room;
    if (!(sample->magnitude > list[room - 1].magnitude))
        return;
    while (i > 0 && sample->magnitude > list[i - 1].magnitude)
        i--;
    memmove(list + i + 1, list + i, (room - 1 - i) * sizeof *list);
    list[i] = *sample;
}

struct leaf_samples {
    struct comparison *comparison;
    enum comparison_side side;
    struct sample_sums *sums;
    struct sample_progress *progress;
    uint64_t end_us; /* when the task ends, by clock_now_us() */
};

static void add_measures(struct leaf_samples *to, const struct comparison_values *at, double weight,
                         double x, double y, double step)
{
    const struct comparison_part *part = &to->comparison->part[to->side];
    for (int k = 0; k < COMPARISON_MEASURES; k++) {
        double value = at->value[k], magnitude = fabs(value);
        if (!part->values[k])
            continue;
        part->values[k][to->progress->index] = (float)magnitude;
        if (!isfinite(value))
            continue;
        to->sums->weight[k] += weight;
        to->sums->square[k] += weight * value * value;
        if (magnitude > to->comparison->setup.limit[k])
            to->sums->out[k] += weight;
        if (magnitude > to->progress->worst[k].magnitude)
            to->progress->worst[k] = (struct worst_sample){magnitude,
                                                           value,
                                                           to->progress->leaf,
                                                           x,
                                                           y,
                                                           step,
                                                           {at->to.leaf, at->to.x, at->to.y}};
    }
}

/* Adds area that the other surface does not cover, about a place of the leaf. */
static void add_uncovered(struct leaf_samples *to, double area, double x, double y,
                          struct vec position)
{
    to->sums->uncovered += area;
    if (area <= to->sums->largest_uncovered)
        return;
    to->sums->largest_uncovered = area;
    to->sums->uncovered_at = comparison_place_of(&to->comparison->part[to->side].surface,
                                                 to->progress->leaf, x, y, position);
}

/* True if the other surface covers the place. */
static bool add_sample(struct leaf_samples *to, double x, double y, double step, double area)
{
    struct comparison *comparison = to->comparison;
    const struct comparison_part *part = &comparison->part[to->side],
                                 *other = &comparison->part[!to->side];
    struct comparison_values at;
    /* Revisions mostly keep their numbers: the search begins at the same place, until that was wrong. */
    struct closest_start start = {to->progress->leaf, x, y};
    if (part->surface.n_leaves != other->surface.n_leaves ||
        (to->progress->last.leaf != SIZE_MAX && to->progress->last.leaf != to->progress->leaf))
        start = to->progress->last;
    comparison_measure_at(comparison, to->side, to->progress->leaf, x, y, &start, &at);
    double weight = area > 0 ? area : vec_length(vec_cross(at.from.su, at.from.sv)) * -area;
    if (!isfinite(weight))
        weight = 0;
    part->weights[to->progress->index] = (float)weight;
    to->sums->area += weight;
    if (at.is_covered) {
        to->progress->last = (struct closest_start){at.to.leaf, at.to.x, at.to.y};
        to->sums->rewound += at.is_rewound ? weight : 0;
        to->sums->unlit += at.is_unlit ? weight : 0;
    } else {
        add_uncovered(to, weight, x, y, at.from.s);
    }
    add_measures(to, &at, weight, x, y, step);
    to->progress->index++;
    return at.is_covered;
}

/* Edges of a leaf: its sides y = 0, x = 1, y = 1, x = 0. */
enum { EDGES = 4 };

/* Sets for each edge of the leaf whether the surface ends there. */
static void find_borders(const struct kept_surface *surface, size_t leaf, bool is_border[EDGES])
{
    static const double middles[EDGES][2] = {{0.5, 0}, {1, 0.5}, {0.5, 1}, {0, 0.5}};
    for (int edge = 0; edge < EDGES; edge++)
        is_border[edge] = kept_surface_at_border(surface, leaf, middles[edge][0], middles[edge][1]);
}

/* A sample on the border beside a covered sample, `width` long in the leaf's parameter. If the other surface ends
 * farther aside than the limit of the distance, the strip between both borders is uncovered. */
static void add_border_sample(struct leaf_samples *to, int edge, double x, double y, double width)
{
    struct comparison_values at;
    struct closest_start start = to->progress->last;
    comparison_measure_at(to->comparison, to->side, to->progress->leaf, x, y, &start, &at);
    if (at.is_covered || at.to.kind != CLOSEST_BORDER)
        return;
    double length = width * vec_length(edge % 2 ? at.from.sv : at.from.su);
    double strip = length * vec_length(vec_sub(at.to.at.s, at.from.s));
    if (isfinite(strip))
        add_uncovered(to, strip, x, y, at.from.s);
}

/* The border beside sample (i,j) of a part, of nx * ny samples, if that sample lies beside one. */
static void add_border(struct leaf_samples *to, const struct kept_part *part,
                       const bool is_border[EDGES], unsigned nx, unsigned ny, unsigned i,
                       unsigned j)
{
    double dx = part->width / nx, dy = part->height / ny;
    double x = part->x + (i + 0.5) * dx, y = part->y + (j + 0.5) * dy;
    if (is_border[0] && j == 0 && part->y == 0)
        add_border_sample(to, 0, x, 0, dx);
    if (is_border[1] && i == nx - 1 && part->x + part->width == 1)
        add_border_sample(to, 1, 1, y, dy);
    if (is_border[2] && j == ny - 1 && part->y + part->height == 1)
        add_border_sample(to, 2, x, 1, dx);
    if (is_border[3] && i == 0 && part->x == 0)
        add_border_sample(to, 3, 0, y, dy);
}

static void begin_leaf(struct leaf_samples *to)
{
    struct sample_progress *at = to->progress;
    const struct comparison_part *part = to->comparison->part;
    for (int k = 0; k < COMPARISON_MEASURES; k++)
        at->worst[k].magnitude = -1;
    if (part[COMPARISON_OLD].surface.n_leaves == part[COMPARISON_NEW].surface.n_leaves)
        at->last.leaf = SIZE_MAX;
    at->before = to->sums->area;
    at->part = at->sample = 0;
    at->is_in_leaf = true;
}

/* True if the task must end: its time is over, or nobody waits for the result. */
static bool is_interrupted(const struct leaf_samples *to)
{
    return to->comparison->base.cancelled || clock_now_us() >= to->end_us;
}

/* The samples of a part of the leaf, from where they were interrupted. False if they are interrupted again. */
static bool sample_part(struct leaf_samples *to, const struct kept_part *of,
                        const bool is_border[EDGES])
{
    struct sample_progress *at = to->progress;
    unsigned nx, ny;
    surface_samples_grid(&to->comparison->part[to->side].samples, at->leaf, of, &nx, &ny);
    double dx = of->width / nx, dy = of->height / ny;
    while (at->sample < nx * ny) {
        unsigned i = at->sample % nx, j = at->sample / nx;
        if (add_sample(to, of->x + (i + 0.5) * dx, of->y + (j + 0.5) * dy, 0.5 * fmax(dx, dy),
                       -dx * dy))
            add_border(to, of, is_border, nx, ny, i, j);
        at->sample++;
        if (is_interrupted(to))
            return false;
    }
    return true;
}

/* False if the samples of the leaf are interrupted. */
static bool sample_leaf(struct leaf_samples *to)
{
    struct sample_progress *at = to->progress;
    const struct kept_surface *surface = &to->comparison->part[to->side].surface;
    struct kept_part parts[KEPT_PARTS];
    unsigned n = kept_surface_parts(surface, at->leaf, parts);
    bool is_border[EDGES];
    find_borders(surface, at->leaf, is_border);
    if (!at->is_in_leaf)
        begin_leaf(to);
    for (; at->part < n; at->part++, at->sample = 0) {
        const struct kept_part *of = &parts[at->part];
        if (at->part + 4 == n && at->sample == 0) /* the three patches before the rest */
            at->before = to->sums->area;
        double last_level = to->sums->area - at->before;
        if (of->is_rest) /* each level is three times what lies inside of it */
            add_sample(to, 0, 0, 0.5 * of->width, fmax(last_level / 3, 1e-300));
        else if (!sample_part(to, of, is_border))
            return false;
    }
    for (int k = 0; k < COMPARISON_MEASURES; k++)
        enter_worst(to->sums->worst[k], WORST_OF_SLICE, &at->worst[k]);
    at->is_in_leaf = false;
    return true;
}

static void begin_samples(const struct comparison_part *part, size_t slice)
{
    struct sample_sums *sums = &part->sums[slice];
    *sums = (struct sample_sums){0};
    for (int k = 0; k < COMPARISON_MEASURES; k++)
        for (int i = 0; i < WORST_OF_SLICE; i++)
            sums->worst[k][i].magnitude = -1;
    size_t leaf = part->slice_first[slice];
    part->progress[slice] = (struct sample_progress){.is_begun = true,
                                                     .leaf = leaf,
                                                     .index = part->samples.first[leaf],
                                                     .last = {.leaf = SIZE_MAX}};
}

void comparison_sample(struct comparison *comparison, enum comparison_side side, size_t slice)
{
    struct comparison_part *part = &comparison->part[side];
    struct sample_progress *at = &part->progress[slice];
    struct leaf_samples to = {comparison, side, &part->sums[slice], at,
                              clock_now_us() + comparison->setup.task_us};
    if (!at->is_begun)
        begin_samples(part, slice);
    for (; at->leaf < part->slice_first[slice + 1]; at->leaf++) {
        if (comparison->base.cancelled)
            return;
        if (!sample_leaf(&to)) {
            comparison->base.repeats = true;
            return;
        }
    }
    at->is_done = true;
}

void comparison_choose_worst(struct comparison *comparison, enum comparison_side side)
{
    struct comparison_part *part = &comparison->part[side];
    for (int k = 0; k < COMPARISON_MEASURES; k++) {
        for (int i = 0; i < WORST; i++)
            part->worst[k][i].magnitude = -1;
        for (size_t slice = 0; slice < part->n_slices; slice++)
            for (int i = 0; i < WORST_OF_SLICE; i++)
                enter_worst(part->worst[k], WORST, &part->sums[slice].worst[k][i]);
    }
}
