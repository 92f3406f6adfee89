/* The leading modes of a ring under subdivision: how its limit position and its two slowest
 * directions follow from its points.
 *
 * Where subdivision has no rotational symmetry there are no masks in closed form: at a dart (an
 * interior vertex where one infinitely sharp edge ends), at a sharp vertex of several quads and at
 * one of a foreign crease (ring.h). The masks are the leading left eigenvectors of the ring's own
 * subdivision matrix (limit-surface 4.5), found by subspace iteration. */
#ifndef SHEEN_LIMIT_MODES_H
#define SHEEN_LIMIT_MODES_H

#include "server/limit/ring.h"

enum { MODES_MAX_VALENCE = 64, MODES_MAX_POINTS = 2 * MODES_MAX_VALENCE + 4 };

/* Weights of the vertex, its edges, its faces, the ends of a foreign crease, in that order.
 * tangent[0] is the slowest mode; at a dart the two are right-handed along the winding. */
struct ring_modes {
    double position[MODES_MAX_POINTS];
    double tangent[2][MODES_MAX_POINTS];
};

static inline bool ring_is_dart(const struct ring *settled)
{
    return settled->creases.edge;
}

/* The ring is settled, of at most MODES_MAX_VALENCE quads. Takes a few rings of arena. */
void ring_modes_init(struct ring_modes *modes, const struct ring *ring, struct arena *arena);

struct vec ring_mode_apply(const double *mask, const struct ring *ring);

#endif
