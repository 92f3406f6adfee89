/* Looks for what can be drawn and is probably not meant. Each kind gets one warning, whatever
 * the file's format. Internal to server/cage; any thread. */
#ifndef SHEEN_CAGE_BUILD_INSPECT_H
#define SHEEN_CAGE_BUILD_INSPECT_H

#include "server/cage/build/builder.h"

/* Looks through a cage that has passed cage_check() and reports (cage_found())
 * - that no face shares a vertex with another although positions are repeated;
 * - plain triangles, where the builder says so;
 * - edges that two faces run along in the same direction, at the face with the most of them;
 * - faces with the vertices of an earlier face in the same order, either way round. With the opposite
 *   winding a face is reported only where an edge has more than two faces: a pillow of two faces is a
 *   body;
 * - closed bodies with a negative volume, without those whose box lies inside the box of one of the
 *   16 largest outward bodies, which are taken for its hollows (bodies.h).
 * The cage itself stays as it is. Takes n log n steps in its corners and about 30 bytes for each. When
 * memory is short, one warning says so. */
void cage_inspect(struct cage_builder *builder, const char *name);

#endif
