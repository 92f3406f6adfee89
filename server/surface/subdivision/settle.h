/* What is left of a ring once only infinite sharpness remains. */
#ifndef SHEEN_SURFACE_SUBDIVISION_SETTLE_H
#define SHEEN_SURFACE_SUBDIVISION_SETTLE_H

#include "server/surface/subdivision/ring.h"

/* A ring without semi-sharp tags, cut to the sector that holds the quad at ring->at: beyond an
 * infinitely sharp edge nothing matters. What stays is open, or closed and smooth, or closed with
 * one sharp edge (a dart), or closed with a sharp vertex, or has a foreign crease (ring.h). Rings
 * with semi-sharp tags stay whole. */
struct ring ring_settle(const struct ring *ring, struct arena *arena);

/* Settled, and with its quads plain B-spline patches (phantom points beyond a sector's end). Not so
 * the plain sectors of an extraordinary vertex: one patch carries 2^-24 of itself, and a camera
 * that looks at the whole vertex from nearby wants more. */
bool ring_is_regular(const struct ring *settled);

/* Whether the surface ends, as a sector, at the quad's first (0) or second (1) edge. */
bool ring_ends_at(const struct ring *settled, int edge);

#endif
