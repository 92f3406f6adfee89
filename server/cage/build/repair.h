/* Takes damaged elements out of a cage and keeps the rest. All damage of one kind gets one
 * warning. Internal to server/cage; any thread. */
#ifndef SHEEN_CAGE_BUILD_REPAIR_H
#define SHEEN_CAGE_BUILD_REPAIR_H

#include "server/cage/build/builder.h"

/* Takes out of a cage that has been read to its end what cannot be evaluated: corners that repeat a
 * neighbour, faces with fewer than three different corners, faces with a vertex at corners that are
 * no neighbours, creases on no edge, corner tags on no vertex, holes of no face. Warns of each kind
 * with cage_found(). It is called once for a cage.
 *
 * On entry holes name faces by their number in the file, on return by their index among the faces
 * that stay, which keep their order. Vertex indices of faces must be in range; those of tags may be
 * any numbers. `name` is the file's, for texts. Linear in the size of the cage.
 *
 * False, and the builder may only be freed: ERROR_MODEL when the file has faces and none of them can
 * stay, ERROR_SERVER when memory is short. A cage without faces is left as it is. */
bool cage_repair(struct cage_builder *builder, const char *name, struct error *error);

#endif
