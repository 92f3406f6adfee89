/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n (from 1) holds the 24 control points of the n times refined net that the L-shaped band of
 * three sub-patches 2^-n <= max(u,v) <= 2^(1-n) needs: the 5x5 grid (i,j) in -1..3 without (-1,-1).
 * Coordinates are in an orthonormal frame, relative to the vertex's limit position, divided by the
 * level's scale (server/surface/README.md 3.3). The limit position is moved back to zero at every
 * level, in double: otherwise precision would be lost, since points that differ by 2^-n would be
 * stored at their full distance from it. How the points lie in texels is said in texels.h.
 *
 * The frame's third axis is the limit normal. Where the vertex has none (ring_has_one_normal()) it
 * is the normal of the quad's own corner of the net at level 28, and the first axis lies along the
 * sum of that corner's two edges.
 *
 * Thread: any, as long as no other thread uses the arena or rings that are kept for several corners
 * (ring_cache.h). */
#ifndef SHEEN_SURFACE_SUBDIVISION_CORNER_H
#define SHEEN_SURFACE_SUBDIVISION_CORNER_H

#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/quad.h"
#include "server/surface/tables.h"

/* How many levels a settled extraordinary ring takes, LIMIT_MIN_LEVELS to LIMIT_MAX_LEVELS. Bands
 * shrink by the larger of the ring's subdominant eigenvalues (Stam 1998, appendix A) from level to
 * level, and the part of the surface that no band covers must be less than a pixel, where a pixel
 * is 2^-24 of the face. */
unsigned corner_levels(const struct ring *ring);

/* Makes the table of a quad whose corner 0 is the extraordinary vertex and which has no semi-sharp
 * tags. Writes LIMIT_CORNER_TEXELS(levels) texels, bounds[0, levels) and the origin, which is the
 * vertex's limit position in world units; the caller owns all three. `known` are modes of darts
 * that have been computed already; NULL is the empty list, and a dart's modes are then computed
 * here. Never fails: plans size the arena beforehand. Returns whether the vertex has a limit
 * normal. */
bool corner_table(const struct quad *quad, unsigned levels, const struct dart_mask_list *known,
                  struct arena *arena, float (*texels)[4], struct limit_bound *bounds,
                  double origin[3]);

#endif
