/* The leading modes of a dart's ring under subdivision: how its limit position and its two slowest
 * directions follow from its points.
 *
 * A dart is an interior vertex where one infinitely sharp edge ends. There subdivision has no
 * symmetry and no masks in closed form. The masks are the leading left eigenvectors of the ring's
 * own subdivision matrix (server/surface/README.md 4.5), found by subspace iteration. */
#ifndef SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H
#define SHEEN_SURFACE_SUBDIVISION_DART_MASKS_H

#include "server/surface/subdivision/ring.h"

enum { DART_MAX_VALENCE = 64 };

/* Weights of the vertex, its edges, its faces, in that order. tangent[0] is the slowest mode; the
 * two are right-handed along the winding. */
struct dart_masks {
    double position[2 * DART_MAX_VALENCE + 2];
    double tangent[2][2 * DART_MAX_VALENCE + 2];
};

/* Not where the vertex is sharp as well, or follows a foreign crease: those have limits of their
 * own. */
static inline bool ring_is_dart(const struct ring *settled)
{
    return settled->creases.edge && !(settled->sharpness > 0) && !ring_has_foreign_crease(settled);
}

/* The ring is a dart's, of at most DART_MAX_VALENCE quads. Takes a few rings of arena. */
void dart_masks_find(struct dart_masks *modes, const struct ring *ring, struct arena *arena);

struct vec dart_mask_apply(const double *mask, const struct ring *ring);

#endif
