#include "server/curves/compare/comparison.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "server/curves/compare/parts.h"

enum phase {
    PHASE_KEEP,   /* makes the points of both surfaces */
    PHASE_DIVIDE, /* counts the pieces of their trees */
    PHASE_FILL,
    PHASE_SORT,
    PHASE_WINDING,
    PHASE_ALIGN,                               /* ALIGN_ROUNDS phases */
    PHASE_REFILL = PHASE_ALIGN + ALIGN_ROUNDS, /* the moved surface's tree once more */
    PHASE_RESORT,
    PHASE_SAMPLE,
    PHASE_REFINE,
    PHASE_FIGURES,
    PHASES,
};
static const char *const STAGES[PHASES + 1] = {
    "surfaces", "trees",    "trees",    "trees",    "winding",  "aligning", "aligning",
    "aligning", "aligning", "aligning", "aligning", "aligning", "aligning", "aligning",
    "aligning", "trees",    "trees",    "samples",  "maxima",   "figures",
};
_Static_assert(ALIGN_ROUNDS == 10, "STAGES names ten rounds");

enum { LEAVES_OF_SLICE = 64, SAMPLES_OF_SLICE = 1000, WINDING_OF_SLICE = 4 };

/* One search among pieces that are all equally near takes as long as thousands of others, so slices of samples end by time
 * as well. */
static const uint64_t TASK_US = 20000;

/* The limit of the distance by which counterparts are chosen, as a multiple: how far along the normal they may lie, and
 * within how much a face that is wound differently counts. */
static const double REACH = 100, COINCIDENT = 10, TOLERANCE = 0.1;

/* Values and weight of a sample, and its share of the list that gives quantiles. */
enum { SAMPLE_BYTES = (COMPARISON_MEASURES + 1) * sizeof(float) * 2, LEAST_SAMPLES_OF_PART = 1 };

static size_t leaf_slices(const struct comparison_part *part)
{
    return (part->surface.n_leaves + LEAVES_OF_SLICE - 1) / LEAVES_OF_SLICE;
}

/* Calls a step for each leaf of a slice, whose number counts the old side's slices first. */
static void for_leaves(struct comparison *comparison, size_t slice,
                       void (*step)(struct comparison_part *part, size_t leaf))
{
    size_t old = leaf_slices(&comparison->part[COMPARISON_OLD]);
    struct comparison_part *part = &comparison->part[slice >= old];
    size_t first = (slice >= old ? slice - old : slice) * LEAVES_OF_SLICE;
    for (size_t leaf = first; leaf < first + LEAVES_OF_SLICE && leaf < part->surface.n_leaves;
         leaf++)
        if (!comparison->base.cancelled)
            step(part, leaf);
}

static void keep_leaf(struct comparison_part *part, size_t leaf)
{
    kept_surface_fill(&part->surface, leaf);
}

static void divide_leaf(struct comparison_part *part, size_t leaf)
{
    surface_tree_divide(&part->tree, leaf);
}

static void fill_leaf(struct comparison_part *part, size_t leaf)
{
    surface_tree_fill(&part->tree, leaf);
}

/* What is left of the memory that the computation may take. */
static size_t bytes_left(const struct comparison *comparison)
{
    size_t used = 0;
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        const struct comparison_part *part = &comparison->part[k];
        used += part->surface.tables ? kept_surface_bytes(&part->surface) : 0;
        used += part->tree.surface ? surface_tree_bytes(&part->tree) : 0;
    }
    size_t most = comparison->setup.most_bytes;
    return used < most ? most - used : 0;
}

static bool begin_keep(struct comparison *comparison, size_t *n_slices, struct error *error)
{
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        struct comparison_part *part = &comparison->part[k];
        /* The other surface and both trees need memory too. */
        size_t most = bytes_left(comparison) / (k ? 2 : 3);
        if (!kept_surface_init(&part->surface, comparison->setup.tables[k], most, error))
            return false;
        if (part->surface.n_leaves == 0)
            return error_set(error, ERROR_MODEL, "the %s model has no surface", k ? "new" : "old");
        *n_slices += leaf_slices(part);
    }
    return true;
}

static bool begin_divide(struct comparison *comparison, size_t *n_slices, struct error *error)
{
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        struct comparison_part *part = &comparison->part[k];
        if (!surface_tree_init(&part->tree, &part->surface, error))
            return false;
        part->tree.computation = &comparison->base;
        *n_slices += leaf_slices(part);
    }
    return true;
}

static bool begin_fill(struct comparison *comparison, size_t *n_slices, struct error *error)
{
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        struct comparison_part *part = &comparison->part[k];
        /* The other tree needs memory too, and the samples of both sides. */
        size_t samples = comparison->setup.n_samples * SAMPLE_BYTES, left = bytes_left(comparison);
        size_t most = (left > samples ? left - samples : 0) / (k ? 1 : 2);
        if (!surface_tree_allocate(&part->tree, most, error))
            return false;
        *n_slices += leaf_slices(part);
    }
    return true;
}

static void begin_sort(struct comparison *comparison, size_t *n_slices)
{
    for (int k = 0; k < COMPARISON_SIDES; k++)
        *n_slices += surface_tree_split(&comparison->part[k].tree);
}

static void sort_subtree(struct comparison *comparison, size_t slice)
{
    size_t old = (size_t)1 << comparison->part[COMPARISON_OLD].tree.top_depth;
    surface_tree_sort(&comparison->part[slice >= old].tree, slice >= old ? slice - old : slice);
}

static size_t n_winding(const struct comparison *comparison)
{
    size_t n = comparison->part[COMPARISON_OLD].surface.n_leaves;
    return n < WINDING_SAMPLES ? n : WINDING_SAMPLES;
}

static void begin_winding(struct comparison *comparison, size_t *n_slices)
{
    for (int k = 0; k < COMPARISON_SIDES; k++)
        surface_tree_join(&comparison->part[k].tree);
    *n_slices = (n_winding(comparison) + WINDING_OF_SLICE - 1) / WINDING_OF_SLICE;
}

/* Whether the new surface is wound the other way around at the samples of a slice, each in the middle of a leaf. */
static void find_winding(struct comparison *comparison, size_t slice)
{
    const struct kept_surface *old = &comparison->part[COMPARISON_OLD].surface;
    size_t n = n_winding(comparison), first = slice * WINDING_OF_SLICE;
    for (size_t i = first; i < first + WINDING_OF_SLICE && i < n; i++) {
        struct limit_point at;
        struct closest to;
        kept_surface_evaluate(old, i * old->n_leaves / n, 0.5, 0.5, &at);
        if (!at.has_normal)
            continue;
        closest_nearest(&comparison->part[COMPARISON_NEW].tree, at.s, &to);
        if (to.kind != CLOSEST_NONE && to.at.has_normal)
            comparison->winding[i] = vec_dot(at.n, to.at.n) < 0 ? -1 : 1;
    }
}

static void sum_winding(struct comparison *comparison)
{
    int agree = 0;
    for (size_t i = 0; i < WINDING_SAMPLES; i++)
        agree += comparison->winding[i];
    comparison->rules.winding = agree < 0 ? -1 : 1;
    comparison->result.is_rewound = agree < 0;
}

/* Between two rounds: uses the pairs of the round before. */
static bool begin_align(struct comparison *comparison, unsigned round, size_t *n_slices,
                        struct error *error)
{
    struct alignment *alignment = &comparison->alignment;
    if (round == 0)
        sum_winding(comparison);
    if (!comparison->setup.is_aligned || alignment->is_done)
        return true;
    if (round == 0 && !alignment_init(alignment, comparison->result.size, error))
        return false;
    if (round > 0)
        alignment_solve(alignment);
    struct kept_surface *moved = &comparison->part[COMPARISON_NEW].surface;
    moved->is_moved = true;
    moved->motion = alignment->motion;
    *n_slices =
        round < ALIGN_ROUNDS && !alignment->is_done ? ALIGN_PAIRS / ALIGN_PAIRS_OF_SLICE : 0;
    return true;
}

static bool begin_refill(struct comparison *comparison, size_t *n_slices, struct error *error)
{
    if (!comparison->setup.is_aligned)
        return true;
    size_t unused = 0;
    if (!begin_align(comparison, ALIGN_ROUNDS, &unused, error))
        return false;
    comparison->result.motion = comparison->alignment.motion;
    comparison->result.rotation_deg = motion_angle_deg(&comparison->alignment.motion);
    comparison->result.rms_before = comparison->alignment.rms_before;
    comparison->result.rms_after = comparison->alignment.rms_after;
    comparison->result.free_directions = comparison->alignment.free_directions;
    *n_slices = leaf_slices(&comparison->part[COMPARISON_NEW]);
    return true;
}

/* Cuts the samples of a side into slices. */
static bool cut_samples(struct comparison_part *part, struct error *error)
{
    const struct surface_samples *samples = &part->samples;
    size_t n_leaves = part->surface.n_leaves,
           most = surface_samples_count(samples) / SAMPLES_OF_SLICE + 1;
    part->slice_first = calloc(most + 2, sizeof *part->slice_first);
    part->sums = calloc(most + 1, sizeof *part->sums);
    part->progress = calloc(most + 1, sizeof *part->progress);
    if (!part->slice_first || !part->sums || !part->progress)
        return error_set(error, ERROR_SERVER, "no memory for the samples of a surface");
    part->n_slices = 0;
    for (size_t leaf = 0; leaf < n_leaves; leaf++) {
        size_t begins = part->slice_first[part->n_slices];
        if (samples->first[leaf] - samples->first[begins] >= SAMPLES_OF_SLICE)
            part->slice_first[++part->n_slices] = leaf;
    }
    part->slice_first[++part->n_slices] = n_leaves;
    return true;
}

static bool begin_part(struct comparison *comparison, enum comparison_side side,
                       struct error *error)
{
    struct comparison_part *part = &comparison->part[side];
    const struct comparison_setup *setup = &comparison->setup;
    const bool asked[COMPARISON_MEASURES] = {
        [COMPARISON_DISTANCE] = true,
        [COMPARISON_NORMAL] = true,
        [COMPARISON_LINES] = setup->n_lights > 0,
        [COMPARISON_LINE_LENGTH] = setup->n_lights > 0,
        [COMPARISON_CURVATURE] = setup->has_curvature,
    };
    if (!surface_samples_init(&part->samples, &part->surface, setup->n_samples / 2, error))
        return false;
    size_t n = surface_samples_count(&part->samples);
    if (n * SAMPLE_BYTES > bytes_left(comparison))
        return error_set(error, ERROR_SERVER,
                         "%zu samples need more memory than the %zu MB that a computation may take",
                         n, setup->most_bytes >> 20);
    bool is_complete = (part->weights = calloc(n + 1, sizeof *part->weights)) != NULL;
    for (int k = 0; k < COMPARISON_MEASURES; k++)
        if (asked[k])
            is_complete &= (part->values[k] = calloc(n + 1, sizeof *part->values[k])) != NULL;
    return is_complete ? cut_samples(part, error)
                       : error_set(error, ERROR_SERVER, "no memory for the samples of a surface");
}

/* The tables' points are rounded to 2^-24 of the coordinates of a patch's net about its middle; a net is three times as wide
 * as the patch. */
static void set_floors(struct comparison *comparison)
{
    double area = 0;
    for (int k = 0; k < COMPARISON_SIDES; k++)
        for (size_t i = 0; i < comparison->part[k].surface.n_leaves; i++)
            area = fmax(area, comparison->part[k].surface.leaves[i].area);
    comparison->result.distance_floor = 6e-8 * 3 * sqrt(area);
    comparison->result.normal_floor_deg = 2e-5;
}

/* Lists the slices of samples that are not done. */
static void list_open(struct comparison *comparison)
{
    size_t slice = 0;
    comparison->n_open = 0;
    for (int k = 0; k < COMPARISON_SIDES; k++)
        for (size_t i = 0; i < comparison->part[k].n_slices; i++, slice++)
            if (!comparison->part[k].progress[i].is_done)
                comparison->open[comparison->n_open++] = slice;
}

static bool begin_sample(struct comparison *comparison, size_t *n_slices, struct error *error)
{
    size_t n = 0;
    if (comparison->is_repeat) {
        list_open(comparison);
        *n_slices = comparison->n_open;
        return true;
    }
    if (comparison->setup.is_aligned)
        surface_tree_join(&comparison->part[COMPARISON_NEW].tree);
    set_floors(comparison);
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        if (!begin_part(comparison, (enum comparison_side)k, error))
            return false;
        n += comparison->part[k].n_slices;
    }
    comparison->open = calloc(n + 1, sizeof *comparison->open);
    if (!comparison->open)
        return error_set(error, ERROR_SERVER, "no memory for the samples of a surface");
    list_open(comparison);
    *n_slices = comparison->n_open;
    return true;
}

static bool begin(struct computation *computation, unsigned phase, size_t *n_slices,
                  struct error *error)
{
    struct comparison *comparison = (struct comparison *)computation;
    *n_slices = 0;
    comparison->is_repeat = comparison->phase == phase;
    comparison->phase = phase;
    if (phase >= PHASE_ALIGN && phase < PHASE_REFILL)
        return begin_align(comparison, phase - PHASE_ALIGN, n_slices, error);
    switch (phase) {
    case PHASE_KEEP:
        return begin_keep(comparison, n_slices, error);
    case PHASE_DIVIDE:
        return begin_divide(comparison, n_slices, error);
    case PHASE_FILL:
        return begin_fill(comparison, n_slices, error);
    case PHASE_SORT:
        begin_sort(comparison, n_slices);
        return true;
    case PHASE_WINDING:
        begin_winding(comparison, n_slices);
        return true;
    case PHASE_REFILL:
        return begin_refill(comparison, n_slices, error);
    case PHASE_RESORT:
        if (comparison->setup.is_aligned)
            *n_slices = surface_tree_split(&comparison->part[COMPARISON_NEW].tree);
        return true;
    case PHASE_SAMPLE:
        return begin_sample(comparison, n_slices, error);
    case PHASE_REFINE:
        for (int k = 0; k < COMPARISON_SIDES && !comparison->is_repeat; k++)
            comparison_choose_worst(comparison, (enum comparison_side)k);
        *n_slices = COMPARISON_SIDES * COMPARISON_MEASURES * WORST;
        return true;
    default:
        for (int k = 0; k < COMPARISON_SIDES; k++)
            comparison_sum_side(comparison, (enum comparison_side)k);
        *n_slices = COMPARISON_SIDES * COMPARISON_MEASURES;
        return true;
    }
}

static void slice(struct computation *computation, size_t slice)
{
    struct comparison *comparison = (struct comparison *)computation;
    struct comparison_part *part = comparison->part;
    if (comparison->phase >= PHASE_ALIGN && comparison->phase < PHASE_REFILL) {
        alignment_pair(&comparison->alignment, &part[COMPARISON_NEW].surface,
                       &part[COMPARISON_OLD].tree, &comparison->rules, slice);
        return;
    }
    switch (comparison->phase) {
    case PHASE_KEEP:
        for_leaves(comparison, slice, keep_leaf);
        break;
    case PHASE_DIVIDE:
        for_leaves(comparison, slice, divide_leaf);
        break;
    case PHASE_FILL:
        for_leaves(comparison, slice, fill_leaf);
        break;
    case PHASE_SORT:
        sort_subtree(comparison, slice);
        break;
    case PHASE_WINDING:
        find_winding(comparison, slice);
        break;
    case PHASE_REFILL:
        for_leaves(comparison, leaf_slices(&part[COMPARISON_OLD]) + slice, fill_leaf);
        break;
    case PHASE_RESORT:
        surface_tree_sort(&part[COMPARISON_NEW].tree, slice);
        break;
    case PHASE_SAMPLE: {
        size_t open = comparison->open[slice], n_old = part[COMPARISON_OLD].n_slices;
        bool is_new = open >= n_old;
        comparison_sample(comparison, is_new ? COMPARISON_NEW : COMPARISON_OLD,
                          is_new ? open - n_old : open);
        break;
    }
    case PHASE_REFINE: {
        size_t list = slice / WORST;
        comparison_refine(comparison, (enum comparison_side)(list / COMPARISON_MEASURES),
                          (enum comparison_measure)(list % COMPARISON_MEASURES), slice % WORST);
        break;
    }
    default:
        comparison_compute_figures(comparison, (enum comparison_side)(slice / COMPARISON_MEASURES),
                                   (enum comparison_measure)(slice % COMPARISON_MEASURES));
    }
}

static void destroy(struct computation *computation)
{
    struct comparison *comparison = (struct comparison *)computation;
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        struct comparison_part *part = &comparison->part[k];
        free(part->weights);
        for (int i = 0; i < COMPARISON_MEASURES; i++)
            free(part->values[i]);
        free(part->slice_first);
        free(part->sums);
        free(part->progress);
        surface_samples_finish(&part->samples);
        surface_tree_finish(&part->tree);
        kept_surface_finish(&part->surface);
    }
    alignment_finish(&comparison->alignment);
    free(comparison->open);
    free(comparison);
}

static double diagonal_of(const struct limit_tables *tables)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double side = tables->box_max[k] - tables->box_min[k];
        sum += side * side;
    }
    return sqrt(sum);
}

size_t comparison_bytes(const struct limit_tables *const tables[COMPARISON_SIDES], size_t n_samples)
{
    enum { PIECES_OF_PART = 4 }; /* the car needs 1 on average; a part has 64 at most */
    const size_t piece = sizeof(struct tree_piece) + sizeof(struct tree_box);
    size_t sum = 0, n_parts;
    for (int k = 0; k < COMPARISON_SIDES; k++) {
        size_t kept = kept_surface_most_bytes(tables[k], &n_parts);
        /* begin_keep() leaves as much for the other surface and for the trees. */
        sum += (k ? 2 : 3) * kept +
               n_parts * (PIECES_OF_PART * piece + LEAST_SAMPLES_OF_PART * SAMPLE_BYTES) +
               tables[k]->count[LIMIT_CORNER] * sizeof(struct corner_sector);
    }
    return sum + n_samples * SAMPLE_BYTES;
}

struct computation *comparison_create(const struct comparison_setup *setup, struct error *error)
{
    static const struct computation_kind kind = {STAGES, begin, slice, destroy};
    struct comparison *comparison = calloc(1, sizeof *comparison);
    if (!comparison) {
        error_set(error, ERROR_SERVER, "no memory for a comparison");
        return NULL;
    }
    double limit = setup->limit[COMPARISON_DISTANCE],
           size = diagonal_of(setup->tables[COMPARISON_OLD]);
    comparison->base.kind = &kind;
    comparison->phase = PHASES; /* none yet */
    comparison->setup = *setup;
    if (setup->task_us == 0)
        comparison->setup.task_us = TASK_US;
    comparison->rules = (struct closest_rules){1, fmin(REACH * limit, 0.1 * size),
                                               COINCIDENT * limit, TOLERANCE * limit};
    comparison->result.size = size;
    return &comparison->base;
}

const struct comparison_result *comparison_read(const struct computation *computation)
{
    return &((const struct comparison *)computation)->result;
}
