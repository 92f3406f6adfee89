/* Moves the worst samples to local maxima of their measure, by compass search: steps in eight directions, halved where
 * none leads upwards. It needs no derivatives, and measures have kinks. */
#include <math.h>

#include "server/base/clock.h"
#include "server/curves/compare/parts.h"

/* Each halving adds a binary digit; a measure that is smooth at its maximum gets two. */
enum { HALVINGS = 14, MOST_TRIES = 400 };

/* How far from the border of a leaf a measure of normals stays: beside a crease that lies elsewhere by less than the
 * limit of the distance, the counterpart of a place is on the crease's other side. */
static void set_range(const struct comparison *comparison, enum comparison_side side,
                      enum comparison_measure measure, const struct worst_sample *worst,
                      double margin[2])
{
    margin[0] = margin[1] = 0;
    if (measure == COMPARISON_DISTANCE)
        return;
    struct limit_point at;
    kept_surface_evaluate(&comparison->part[side].surface, worst->leaf, worst->x, worst->y, &at);
    double away = 2 * comparison->setup.limit[COMPARISON_DISTANCE];
    const struct vec *by[2] = {&at.su, &at.sv};
    for (int k = 0; k < 2; k++)
        margin[k] = fmin(away / vec_length(*by[k]), 0.4);
}

/* One step of the search: to the best of the eight places around, or to half the step. */
static void step_up(const struct comparison *comparison, enum comparison_side side,
                    enum comparison_measure measure, struct worst_sample *worst,
                    struct refine_progress *progress)
{
    const double *margin = progress->margin, step = progress->step;
    struct worst_sample best = *worst;
    for (int way = 0; way < 9; way++) {
        double x = worst->x + (way % 3 - 1) * step, y = worst->y + (way / 3 - 1) * step;
        x = fmin(fmax(x, margin[0]), 1 - margin[0]);
        y = fmin(fmax(y, margin[1]), 1 - margin[1]);
        if (way == 4 || (x == worst->x && y == worst->y) || comparison->base.cancelled)
            continue;
        struct comparison_values at;
        comparison_measure_at(comparison, side, worst->leaf, x, y, &worst->to, &at);
        progress->tries++;
        double magnitude = fabs(at.value[measure]);
        if (magnitude > best.magnitude)
            best = (struct worst_sample){magnitude,
                                         at.value[measure],
                                         worst->leaf,
                                         x,
                                         y,
                                         step,
                                         {at.to.leaf, at.to.x, at.to.y}};
    }
    if (best.magnitude > worst->magnitude) {
        *worst = best;
    } else {
        progress->step *= 0.5;
        progress->halved++;
    }
}

void comparison_refine(struct comparison *comparison, enum comparison_side side,
                       enum comparison_measure measure, size_t i)
{
    struct worst_sample *worst = &comparison->part[side].worst[measure][i];
    struct refine_progress *progress = &comparison->part[side].refined[measure][i];
    uint64_t end_us = clock_now_us() + comparison->setup.task_us;
    if (!(worst->magnitude > 0))
        return;
    if (!progress->is_begun) {
        set_range(comparison, side, measure, worst, progress->margin);
        progress->step = worst->step;
        progress->is_begun = true;
    }
    while (progress->halved < HALVINGS && progress->tries < MOST_TRIES) {
        step_up(comparison, side, measure, worst, progress);
        if (comparison->base.cancelled)
            return;
        if (clock_now_us() >= end_us) {
            comparison->base.repeats = true;
            return;
        }
    }
}
