/* The limit surface at the vertex of a settled ring (settle.h): position, tangents, frame
 * (server/surface/README.md 4). Pure, any thread. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_LIMIT_H
#define SHEEN_SURFACE_SUBDIVISION_RING_LIMIT_H

#include "server/surface/subdivision/ring.h"

/* The vertex's limit position (README.md eq. 9). Not for darts, which have masks of their own
 * (dart_masks.h). */
struct vec ring_limit(const struct ring *ring);

/* The factor by which a subdivision step shrinks a wave cos(angle k) or sin(angle k) over the edges
 * of a ring: the larger of its two eigenvalues (Stam 1998, appendix A; README.md eq. 7). */
double ring_eigenvalue(double angle);

/* True if the surface has a single normal at the vertex:
 *
 * - Closed and smooth, also darts: true.
 * - Sharp with more than one quad, or with an outside crease: false, the vertex is a tip.
 * - Crease sector of 2 or 3 quads, and sharp corner of one: true.
 * - Crease sector of 4 quads: false. Its two slowest directions both shrink by 1/2 and are coupled (a
 *   Jordan block), so that normals near the vertex differ from their limit by an error that falls only as
 *   1/level: a degree where single precision ends.
 * - Crease sector of 5 quads and more: false. The wave sin(2 pi k / n) shrinks more slowly than the
 *   crease's own direction (ring_eigenvalue() > 1/2): normals inside the sector and beside the crease have
 *   different limits.
 * - Smooth corner of one quad: true, as an approximation. Its normals converge as 1/level too, but to the
 *   same direction from everywhere. The one used is within 0.1 degrees of those from level 30 on, for rough
 *   cages. */
bool ring_has_one_normal(const struct ring *ring);

/* Two tangents at the limit position, of any length (README.md 4.2, 4.3); not for darts. Their
 * cross product is along the limit normal, on the side from which the faces are counter-clockwise.
 * In a crease sector the first one has the larger eigenvalue. Returns ring_has_one_normal(); if
 * false, the cross product has no meaning. */
bool ring_tangents(const struct ring *ring, struct vec *t1, struct vec *t2);

/* The right-handed orthonormal frame of two tangents: axis[0] along t1, axis[2] along t1 x t2. If
 * t1 x t2 vanishes, the mean of the quads' normals replaces it. False if that vanishes too; the
 * frame is orthonormal in any case. */
bool ring_frame(const struct ring *ring, struct vec t1, struct vec t2, struct vec axis[3]);

#endif
