/* How the limit at a dart follows from the points of its ring.
 *
 * A dart is an interior vertex where one infinitely sharp edge ends. There subdivision has no
 * symmetry, and no masks in closed form are known. The masks are the leading left eigenvectors of the
 * ring's own subdivision matrix, found by subspace iteration (server/surface/README.md 4.5). */
#ifndef SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H
#define SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H

#include "server/surface/subdivision/ring.h"

/* The most quads around a dart. */
enum { DART_MAX_VALENCE = 64 };

/* Weights of the vertex, its edges, its faces, in that order: for the limit position, and for two
 * tangents, the slower one first; t1 x t2 points along the normal. */
struct dart_masks {
    double position[2 * DART_MAX_VALENCE + 2];
    double tangent[2][2 * DART_MAX_VALENCE + 2];
};

/* Whether a settled ring is a dart's: not where the vertex is sharp as well, or on an outside crease,
 * since ring_limit.h has the limits of those. */
static inline bool ring_is_dart(const struct ring *settled)
{
    return settled->creases.edge && !(settled->sharpness > 0) && !ring_has_outside_crease(settled);
}

/* Of a dart's ring of at most DART_MAX_VALENCE quads. Takes and gives back a few rings of arena. Costs
 * 0.3 ms to 8 quads, 0.1 s at 64. Never fails. */
void dart_masks_find(struct dart_masks *masks, const struct ring *ring, struct arena *arena);

/* The sum of a ring's points by one of the masks. */
struct vec dart_mask_apply(const double *mask, const struct ring *ring);

#endif
