/* The figures of each measure from the samples. */
#include <math.h>
#include <stdlib.h>

#include "server/curves/compare/parts.h"

struct weighted {
    float value, weight;
};

/* Partitions values about a pivot; returns the number of those in front, which are at most as large as the others. */
static size_t partition(struct weighted *list, size_t n)
{
    float a = list[0].value, b = list[n / 2].value, c = list[n - 1].value;
    float pivot = fmaxf(fminf(a, b), fminf(fmaxf(a, b), c));
    size_t i = 0, j = n - 1;
    for (;;) {
        while (list[i].value < pivot)
            i++;
        while (list[j].value > pivot)
            j--;
        if (i >= j)
            break;
        struct weighted swapped = list[i];
        list[i++] = list[j];
        list[j--] = swapped;
    }
    return j + 1 < n ? j + 1 : n - 1;
}

/* The value that a share of the weight does not exceed. Reorders the list. */
static double quantile(struct weighted *list, size_t n, double share)
{
    double total = 0;
    for (size_t i = 0; i < n; i++)
        total += (double)list[i].weight;
    double below = share * total; /* what the answer leaves below it, of list */
    while (n > 1) {
        size_t front = partition(list, n);
        double in_front = 0;
        for (size_t i = 0; i < front; i++)
            in_front += (double)list[i].weight;
        if (below < in_front) {
            n = front;
        } else {
            below -= in_front;
            list += front;
            n -= front;
        }
    }
    return (double)list->value;
}

static void set_quantiles(const struct comparison_part *part, enum comparison_measure measure,
                          struct comparison_figures *figures)
{
    size_t n_samples = surface_samples_count(&part->samples), n = 0;
    struct weighted *list = malloc((n_samples + 1) * sizeof *list);
    figures->p95 = figures->p99 = NAN;
    if (!list)
        return; /* reported as unknown */
    for (size_t i = 0; i < n_samples; i++)
        if (isfinite(part->values[measure][i]))
            list[n++] = (struct weighted){part->values[measure][i], part->weights[i]};
    if (n) {
        figures->p95 = quantile(list, n, 0.95);
        figures->p99 = quantile(list, n, 0.99);
    }
    free(list);
}

static void set_worst(const struct comparison *comparison, enum comparison_side side,
                      enum comparison_measure measure, struct comparison_figures *figures)
{
    const struct comparison_part *part = &comparison->part[side], *other = &comparison->part[!side];
    const struct worst_sample *worst = part->worst[measure];
    for (int i = 1; i < WORST; i++)
        if (part->worst[measure][i].magnitude > worst->magnitude)
            worst = &part->worst[measure][i];
    struct limit_point own, to;
    kept_surface_evaluate(&part->surface, worst->leaf, worst->x, worst->y, &own);
    kept_surface_evaluate(&other->surface, worst->to.leaf, worst->to.x, worst->to.y, &to);
    figures->worst = worst->value;
    figures->at[side] = comparison_place_of(&part->surface, worst->leaf, worst->x, worst->y, own.s);
    figures->at[!side] =
        comparison_place_of(&other->surface, worst->to.leaf, worst->to.x, worst->to.y, to.s);
    /* Distances are positive where the new surface lies on the side of the old one's normal. */
    if (side == COMPARISON_NEW && measure == COMPARISON_DISTANCE && figures->worst != 0)
        figures->worst *= -comparison->rules.winding;
}

void comparison_compute_figures(struct comparison *comparison, enum comparison_side side,
                                enum comparison_measure measure)
{
    const struct comparison_part *part = &comparison->part[side];
    struct comparison_figures *figures = &comparison->result.side[side].figures[measure];
    *figures = (struct comparison_figures){0};
    double weight = 0, square = 0;
    for (size_t slice = 0; slice < part->n_slices; slice++) {
        weight += part->sums[slice].weight[measure];
        square += part->sums[slice].square[measure];
        figures->area_out += part->sums[slice].out[measure];
    }
    if (!part->values[measure] || !(weight > 0) || part->worst[measure][0].magnitude < 0)
        return;
    figures->is_known = true;
    figures->rms = sqrt(square / weight);
    set_worst(comparison, side, measure, figures);
    set_quantiles(part, measure, figures);
}

void comparison_sum_side(struct comparison *comparison, enum comparison_side side)
{
    const struct comparison_part *part = &comparison->part[side];
    struct comparison_result_side *result = &comparison->result.side[side];
    double largest = 0;
    result->n_samples = surface_samples_count(&part->samples);
    for (size_t slice = 0; slice < part->n_slices; slice++) {
        const struct sample_sums *sums = &part->sums[slice];
        result->area += sums->area;
        result->area_uncovered += sums->uncovered;
        result->area_rewound += sums->rewound;
        result->area_unlit += sums->unlit;
        if (sums->largest_uncovered > largest) {
            largest = sums->largest_uncovered;
            result->uncovered_at = sums->uncovered_at;
        }
    }
}
