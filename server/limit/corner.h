/* The table of a quad with one extraordinary vertex: P_i(n,k) of Yasui and Kanai (2004), exact in
 * single precision.
 *
 * Level n holds the 24 control points of the n times refined net that the ring of sub-patches
 * 2^-n <= max(u,v) <= 2^(1-n) needs: the 5x5 grid (i,j) in -1..3 without (-1,-1). Coordinates are
 * in an orthonormal frame, relative to the vertex's limit position (re-centred in double at every
 * level, or the refinement itself would lose it), divided by the level's scale (limit-surface 4.4
 * to 4.6). How they lie in texels is said in texels.h.
 *
 * The frame's third axis is the limit normal; where the vertex has none (ring_has_one_normal()),
 * the normal of the quad's own corner at a deep level, the first axis then lies along that corner.
 */
#ifndef SHEEN_LIMIT_CORNER_H
#define SHEEN_LIMIT_CORNER_H

#include "server/limit/known_modes.h"
#include "server/limit/quad.h"
#include "server/limit/tables.h"

/* How many levels a settled extraordinary ring takes: rings shrink by the larger of its subdominant
 * eigenvalues (Stam 1998, appendix A), and what they leave out shall be less than a pixel that is
 * 2^-24 of the face. LIMIT_MIN_LEVELS to LIMIT_MAX_LEVELS. */
unsigned corner_levels(const struct ring *ring);

/* Writes LIMIT_CORNER_TEXELS(levels) texels, the bounds of every level and the origin (the limit
 * position, world). The extraordinary vertex is corner 0; nothing is semi-sharp. `known` may have
 * its modes. Returns whether the vertex has a limit normal. */
bool corner_table(const struct quad *quad, unsigned levels, const struct known_modes *known,
                  struct arena *arena, float (*texels)[4], struct limit_bound *bounds,
                  double origin[3]);

#endif
