/* A step of Catmull and Clark's subdivision of a ring. */
#ifndef SHEEN_SURFACE_SUBDIVISION_REFINE_H
#define SHEEN_SURFACE_SUBDIVISION_REFINE_H

#include "server/surface/subdivision/ring.h"

/* One Catmull-Clark step: `out` was taken for as many faces and with_creases as `in`, and gets the
 * rest of its fields. in and out may not share memory. */
void ring_refine(const struct ring *in, struct ring *out);

/* The same where the faces around the vertex are no quads: out->face holds their face points
 * already, and in->face is not read. */
void ring_refine_around(const struct ring *in, struct ring *out);

#endif
