#include "server/curves/compare/samples.h"

#include <math.h>
#include <stdlib.h>

enum { LEAST_SIDE = 4, MOST_SIDE = 2048 };

void surface_samples_grid(const struct surface_samples *samples, size_t leaf,
                          const struct kept_part *part, unsigned *nx, unsigned *ny)
{
    unsigned side = samples->sides[leaf];
    unsigned x = (unsigned)ceil(side * part->width), y = (unsigned)ceil(side * part->height);
    *nx = part->is_rest ? 1 : x > samples->least ? x : samples->least;
    *ny = part->is_rest ? 1 : y > samples->least ? y : samples->least;
}

static size_t count_leaf(const struct surface_samples *samples, size_t leaf)
{
    struct kept_part parts[KEPT_PARTS];
    unsigned n = kept_surface_parts(samples->surface, leaf, parts), nx, ny;
    size_t sum = 0;
    for (unsigned k = 0; k < n; k++) {
        surface_samples_grid(samples, leaf, &parts[k], &nx, &ny);
        sum += (size_t)nx * ny;
    }
    return sum;
}

/* Gives each leaf its samples for a density, in samples for each unit of area. Returns their number. */
static size_t spread(struct surface_samples *samples, double density)
{
    size_t total = 0;
    for (size_t leaf = 0; leaf < samples->surface->n_leaves; leaf++) {
        double side = ceil(sqrt(density * samples->surface->leaves[leaf].area));
        samples->sides[leaf] = (uint16_t)fmin(fmax(side, 1), MOST_SIDE);
        samples->first[leaf] = total;
        total += count_leaf(samples, leaf);
    }
    samples->first[samples->surface->n_leaves] = total;
    return total;
}

bool surface_samples_init(struct surface_samples *samples, const struct kept_surface *surface,
                          size_t n_samples, struct error *error)
{
    *samples = (struct surface_samples){.surface = surface, .least = LEAST_SIDE};
    samples->sides = calloc(surface->n_leaves + 1, sizeof *samples->sides);
    samples->first = calloc(surface->n_leaves + 1, sizeof *samples->first);
    if (!samples->sides || !samples->first) {
        surface_samples_finish(samples);
        return error_set(error, ERROR_SERVER, "no memory for the samples of a surface");
    }
    while (samples->least > 1 && spread(samples, 0) > n_samples)
        samples->least /= 2;
    double area = 0;
    for (size_t leaf = 0; leaf < surface->n_leaves; leaf++)
        area += surface->leaves[leaf].area;
    /* The number grows with the density, from the least number on: bisection of its logarithm. */
    double low = 0, high = area > 0 ? 4 * (double)n_samples / area : 0, density = high / 4;
    for (int step = 0; step < 8 && high > 0; step++) {
        size_t n = spread(samples, density);
        *(n > n_samples ? &high : &low) = density;
        density = low > 0 ? sqrt(low * high) : high / 4;
    }
    spread(samples, low);
    return true;
}

void surface_samples_finish(struct surface_samples *samples)
{
    free(samples->sides);
    free(samples->first);
    *samples = (struct surface_samples){0};
}
