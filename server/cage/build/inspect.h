/* What can be drawn and is probably not meant: each kind costs one warning, whatever the format.
 * Internal to server/cage/read; any thread. */
#ifndef SHEEN_CAGE_BUILD_INSPECT_H
#define SHEEN_CAGE_BUILD_INSPECT_H

#include "server/cage/build/builder.h"

/* Looks through a cage that has passed cage_check() and warns (cage_found()) of
 * - faces of which none shares a vertex with another though positions are repeated;
 * - plain triangles, where the builder says so;
 * - edges that two faces run along in the same direction, at the face with the most of them;
 * - faces with the vertices of an earlier one in the same order, either way round. The other way
 *   round it counts where an edge has more than two faces: a pillow of two faces is a body;
 * - closed bodies with a negative volume, but for those whose box lies inside the box of one of the
 *   16 largest outward bodies, which are taken for its hollows (bodies.h).
 * Nothing but the warnings changes. n log n in its corners, about 30 bytes for each; when memory is
 * short the one warning says so. */
void cage_inspect(struct cage_builder *builder, const char *name);

#endif
