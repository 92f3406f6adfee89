/* A dart: an interior vertex where one infinitely sharp edge ends. Its subdivision has no
 * rotational symmetry and so no masks in closed form; they are the leading left eigenvectors of the
 * ring's own subdivision matrix (limit-surface 4.5), found by subspace iteration. */
#ifndef SHEEN_LIMIT_DART_H
#define SHEEN_LIMIT_DART_H

#include "server/limit/ring.h"

enum { DART_MAX_VALENCE = 64 };

/* Weights for the limit position and two tangents, right-handed along the winding: of the vertex,
 * its edges, its faces, in that order. */
struct dart_masks {
    double position[2 * DART_MAX_VALENCE + 1];
    double tangent[2][2 * DART_MAX_VALENCE + 1];
};

static inline bool ring_is_dart(const struct ring *settled)
{
    return settled->creases.edge;
}

/* The ring is settled, a dart of at most DART_MAX_VALENCE faces. Takes a few rings of arena. */
void dart_masks_init(struct dart_masks *masks, const struct ring *ring, struct arena *arena);

struct vec dart_apply(const double *mask, const struct ring *ring);

#endif
