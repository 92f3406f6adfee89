/* What a damaged element of a file costs: itself and one warning of its kind, never the cage.
 * Internal to server/cage/read; any thread. */
#ifndef SHEEN_CAGE_READ_MEND_H
#define SHEEN_CAGE_READ_MEND_H

#include "server/cage/read/builder.h"

/* Takes out of a whole cage what cannot be evaluated: corners that repeat a neighbour, faces with
 * fewer than three different corners, faces with a vertex at corners that are no neighbours,
 * creases on no edge, corner tags on no vertex, holes of no face. What stays keeps its order, and
 * tags their faces, which they name by the file's own numbers. Vertex indices of faces must be in
 * range, those of tags may be any numbers. Linear in the size of the cage.
 *
 * ERROR_MODEL when the file has faces and none can stay; ERROR_SERVER when memory is short. */
bool cage_mend(struct cage_builder *builder, const char *name, struct error *error);

#endif
