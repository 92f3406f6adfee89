/* The limit surface at the vertex of a ring: position, tangents, frame. */
#ifndef SHEEN_SURFACE_SUBDIVISION_RING_LIMIT_H
#define SHEEN_SURFACE_SUBDIVISION_RING_LIMIT_H

#include "server/surface/subdivision/ring.h"

/* Where the vertex of a settled ring (settle.h) lies on the limit surface. */
struct vec ring_limit(const struct ring *ring);

/* What a step leaves of a wave cos(angle k) or sin(angle k) over the edges of a ring: its larger
 * eigenvalue (Stam 1998, appendix A). */
double ring_eigenvalue(double angle);

/* Whether the surface has one normal at the vertex of a settled ring:
 *
 * - closed and smooth, darts too: yes.
 * - Sharp with more than one quad, or with a foreign crease: no, the vertex is a tip.
 * - Crease sector of 2 or 3 quads, and sharp corner of one: yes.
 * - Crease sector of 4 quads: no. Its two slowest directions both shrink by 1/2 and are coupled (a
 *   Jordan block), so that normals near the vertex differ from their limit by an error that falls
 *   as 1/level only: a degree where single precision ends.
 * - Crease sector of 5 quads and more: no. The wave sin(2 pi k / n) shrinks more slowly than the
 *   crease's own direction (ring_eigenvalue() > 1/2): normals inside the sector and beside the
 *   crease have different limits.
 * - Smooth corner of one quad: treated as yes. Its normals converge as 1/level too, but alike from
 *   all directions; from level 30 on the one taken is within 0.1 degrees of them on rough cages. */
bool ring_has_one_normal(const struct ring *ring);

/* Two tangents at the limit position of a settled ring that is no dart, of any length. Their cross
 * product points along the limit normal, on the side from which the faces run counter-clockwise. In
 * a crease sector the first is the one with the larger eigenvalue. Returns ring_has_one_normal();
 * where that is false the cross product means nothing. */
bool ring_tangents(const struct ring *ring, struct vec *t1, struct vec *t2);

/* The right-handed orthonormal frame of two tangents: axis[0] along t1, axis[2] along t1 x t2.
 * Where that vanishes, the mean of the quads' normals stands in; false when that vanishes too. */
bool ring_frame(const struct ring *ring, struct vec t1, struct vec t2, struct vec axis[3]);

#endif
