/* One step of Catmull and Clark's subdivision (1978) of a ring, with creases as OpenSubdiv has them
 * (server/surface/README.md 3.1 and 5). Pure; no failure. */
#ifndef SHEEN_SURFACE_SUBDIVISION_REFINE_H
#define SHEEN_SURFACE_SUBDIVISION_REFINE_H

#include "server/surface/subdivision/ring.h"

/* `out` has been taken (ring_take()) for as many faces, as closed and with_creases as `in`; its other
 * fields are set here. The two share no memory. */
void ring_refine(const struct ring *in, struct ring *out);

/* The same where the faces around the vertex need not be quads: the caller has set out->face to their
 * face points, and in->face is not read. */
void ring_refine_around(const struct ring *in, struct ring *out);

#endif
