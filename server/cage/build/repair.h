/* Removes damaged elements from a cage and keeps the rest. All damage of one kind gets one warning.
 * Internal to server/cage. Any thread. */
#ifndef SHEEN_CAGE_BUILD_REPAIR_H
#define SHEEN_CAGE_BUILD_REPAIR_H

#include "server/cage/build/builder.h"

/* Removes from a completely read cage what cannot be evaluated: corners equal to a neighbour, faces
 * with fewer than three different corners, faces with one vertex at two corners that are not
 * adjacent, creases on no edge, corner tags on no vertex, holes of no face. Reports each kind by
 * cage_found(). Call it once for a cage.
 *
 * Before the call, holes name faces by their number in the file; afterwards by their index among
 * the remaining faces, which keep their order. Vertex indices of faces must be in range; those of
 * tags may be any numbers. `name` is the file's, for messages. Linear in the size of the cage.
 *
 * False with ERROR_MODEL if the file has faces but none remains, and with ERROR_SERVER when memory
 * is short; then the builder can only be freed. A cage without faces is unchanged. */
bool cage_repair(struct cage_builder *builder, const char *name, struct error *error);

#endif
