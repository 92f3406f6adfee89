/* One step of Catmull and Clark's subdivision (1978) of a ring, with OpenSubdiv's creases
 * (server/surface/README.md 3.1 and 5). Pure, any thread, cannot fail. */
#ifndef SHEEN_SURFACE_SUBDIVISION_REFINE_H
#define SHEEN_SURFACE_SUBDIVISION_REFINE_H

#include "server/surface/subdivision/ring.h"

/* Refines `in`. `out` comes from ring_take(), with the same number of faces and the same closed and
 * with_creases as `in`; its other members are set here. The two share no memory. */
void ring_refine(const struct ring *in, struct ring *out);

/* As ring_refine(), if the faces around the vertex need not be quads: the caller has set out->face
 * to their face points, and in->face is not used. */
void ring_refine_around(const struct ring *in, struct ring *out);

#endif
