/* Computes the limit at a dart from the points of its ring.
 *
 * A dart is an interior vertex at which one infinitely sharp edge ends. Subdivision has no symmetry
 * there, and no masks in closed form are known. The masks are the leading left eigenvectors of the
 * ring's own subdivision matrix, found by subspace iteration (server/surface/README.md 4.5). */
#ifndef SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H
#define SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H

#include "server/surface/subdivision/ring.h"

/* The largest number of quads around a dart. */
enum { DART_MAX_VALENCE = 64 };

/* Weights of the vertex, its edges and its faces, in this order: for the limit position, and for
 * two tangents, the slower one first; t1 x t2 is along the normal. */
struct dart_masks {
    double position[2 * DART_MAX_VALENCE + 2];
    double tangent[2][2 * DART_MAX_VALENCE + 2];
};

/* True for the settled ring of a dart. A vertex that is also sharp, or on an outside crease, is not
 * a dart: ring_limit.h has its limits. */
static inline bool ring_is_dart(const struct ring *settled)
{
    return settled->creases.edge && !(settled->sharpness > 0) && !ring_has_outside_crease(settled);
}

/* Computes the masks of a dart's ring of at most DART_MAX_VALENCE quads. Uses and releases a few
 * rings of arena. Takes 0.3 ms up to 8 quads, 0.1 s at 64. Cannot fail. */
void dart_masks_find(struct dart_masks *masks, const struct ring *ring, struct arena *arena);

/* The sum of a ring's points, weighted by a mask. */
struct vec dart_mask_apply(const double *mask, const struct ring *ring);

#endif
