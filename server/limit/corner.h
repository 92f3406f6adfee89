/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n holds the 24 control points of the n times refined net that the ring of sub-patches
 * 2^-n <= max(u,v) <= 2^(1-n) needs: the 5x5 grid (i,j) in -1..3 without (-1,-1), point (i,j) at
 * 5 (j + 1) + (i + 1) - 1. Coordinates are in the vertex's orthonormal frame, relative to its limit
 * position (re-centred in double at every level, or the refinement itself would lose it), divided
 * by a power of two that is their w (limit-surface 4.4 to 4.6). */
#ifndef SHEEN_LIMIT_CORNER_H
#define SHEEN_LIMIT_CORNER_H

#include "server/limit/quad.h"
#include "server/limit/tables.h"

/* Writes LIMIT_CORNER_TEXELS texels (the last is the frame as a quaternion x y z w that turns
 * frame coordinates into world directions), the bounds of every level and the origin (the limit
 * position, world). The extraordinary vertex is corner 0; nothing is semi-sharp. Returns whether
 * the vertex has a limit normal. */
bool corner_table(const struct quad *quad, struct arena *arena, float (*texels)[4],
                  struct limit_bound bounds[LIMIT_LEVELS], double origin[3]);

#endif
