/* Looks for properties that can be drawn but are probably mistakes. Each kind gets one warning, for
 * every file format. Internal to server/cage. Any thread. */
#ifndef SHEEN_CAGE_BUILD_INSPECT_H
#define SHEEN_CAGE_BUILD_INSPECT_H

#include "server/cage/build/builder.h"

/* Inspects a cage that has passed cage_check() and reports by cage_found():
 *
 * - positions that repeat, in a cage whose faces share no vertices;
 * - plain triangles, if builder->plain_triangles;
 * - edges that two faces traverse in the same direction; the place is the face with most of them;
 * - faces with the same vertices as an earlier face in the same cyclic order, in either direction. A face
 *   with the opposite direction is reported only if one of its edges has more than two faces: two
 *   faces alone are a pillow, which is a body;
 * - closed bodies with a negative volume, except probable hollows (bodies.h).
 *
 * Of a model of patches: boundary curves that two patches traverse in the same direction.
 *
 * Does not change the cage's elements. Takes n log n time in the number of corners and about 30
 * bytes for each. When memory is short, one warning says so. */
void cage_inspect(struct cage_builder *builder, const char *name);

#endif
