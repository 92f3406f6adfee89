/* Reduces a ring with only infinite sharpness to the sector of one quad. */
#ifndef SHEEN_SURFACE_SUBDIVISION_SETTLE_H
#define SHEEN_SURFACE_SUBDIVISION_SETTLE_H

#include "server/surface/subdivision/ring.h"

/* Cuts a ring without semi-sharp tags to the sector with the quad at ring->at: nothing beyond an
 * infinitely sharp edge influences the quad. The result is called "settled". It is one of: an open
 * ring; a closed, smooth one; a closed one with one sharp edge (a dart); a closed one with a sharp
 * vertex; one with an outside crease (ring.h). A ring with semi-sharp tags is returned unchanged.
 * Cannot fail. Thread: that of the arena and of the ring cache. */
struct ring ring_settle(const struct ring *ring, struct arena *arena);

/* True if the quads of a settled ring are plain B-spline patches, with phantom points where the
 * sector ends. Sectors of an extraordinary vertex are excluded, even if they are plain by
 * themselves: one patch in single precision is exact to 2^-24 of its size, which a camera that
 * looks at the whole vertex from nearby would see. */
bool ring_is_regular(const struct ring *settled);

/* True if the sector ends at the quad's first (0) or second (1) edge. */
bool ring_ends_at(const struct ring *settled, int edge);

#endif
