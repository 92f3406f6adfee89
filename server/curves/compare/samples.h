/* How many samples each part of a surface gets: about equally many for each unit of area, and a least number for each
 * patch. A sample stands for a rectangle of a leaf, and lies in its middle; further ones on
 * borders (sampling.c) are not counted here. Plain data of one thread; read-only
 * afterwards. */
#ifndef SHEEN_CURVES_COMPARE_SAMPLES_H
#define SHEEN_CURVES_COMPARE_SAMPLES_H

#include "server/curves/compare/kept_surface.h"

struct surface_samples {
    const struct kept_surface *surface;
    uint16_t *sides; /* [n_leaves]: samples along each side of the leaf */
    size_t *first;   /* [n_leaves + 1]: index of the leaf's first sample */
    unsigned least;  /* samples along each side of a patch */
};

/* Distributes about n_samples, more if there are more patches. The areas of the leaves are known. False with
 * ERROR_SERVER when memory is short. */
bool surface_samples_init(struct surface_samples *samples, const struct kept_surface *surface,
                          size_t n_samples, struct error *error);
void surface_samples_finish(struct surface_samples *samples);

static inline size_t surface_samples_count(const struct surface_samples *samples)
{
    return samples->first[samples->surface->n_leaves];
}

/* The number of samples of a part of a leaf along x and along y; 1 for the rest of a CORNER, whose sample is the
 * vertex. */
void surface_samples_grid(const struct surface_samples *samples, size_t leaf,
                          const struct kept_part *part, unsigned *nx, unsigned *ny);

#endif
