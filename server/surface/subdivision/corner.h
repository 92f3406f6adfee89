/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n (from 1) holds the 24 control points of the n times refined net that the three patches of the
 * L-shaped band 2^-n <= max(u,v) <= 2^(1-n) need: the 5x5 grid (i,j) in -1..3 without (-1,-1)
 * (server/surface/README.md 3.2). Coordinates are in an orthonormal frame of the vertex, relative to its
 * limit position, divided by the level's scale. The limit position is moved back to zero at every level,
 * in double (README.md 3.3 says why). How the points lie in texels: server/surface/texels.h.
 *
 * The frame's third axis is the limit normal. Where the vertex has none (ring_has_one_normal()) it is the
 * normal of the quad's own corner of the net at level 28, and the first axis lies along the sum of that
 * corner's two edges. */
#ifndef SHEEN_SURFACE_SUBDIVISION_CORNER_H
#define SHEEN_SURFACE_SUBDIVISION_CORNER_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/quad.h"
#include "server/surface/tables.h"

/* How many levels the table of a settled extraordinary ring has, LIMIT_MIN_LEVELS to LIMIT_MAX_LEVELS
 * (README.md eq. 8). */
unsigned corner_levels(const struct ring *ring);

/* Makes the table of a quad whose corner 0 is the extraordinary vertex and which has no semi-sharp tags.
 * Writes LIMIT_CORNER_TEXELS(levels) texels, bounds[0, levels) and the origin, which is the vertex's limit
 * position in world units; the caller owns all three. `known` are the masks of darts that have been found
 * before; those of another dart are found here. Returns whether the vertex has a limit normal. Never
 * fails: the arena has been sized for it. Thread: the arena's, and that of the ring cache which holds the
 * quad's rings. */
bool corner_table(const struct quad *quad, unsigned levels, const struct dart_mask_list *known,
                  struct arena *arena, float (*texels)[4], struct limit_bound *bounds,
                  double origin[3]);

#endif
