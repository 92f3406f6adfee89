/* Wavefront OBJ with OpenSubdiv's "t" tags. Internal to server/cage/read. */
#ifndef SHEEN_CAGE_READ_OBJ_H
#define SHEEN_CAGE_READ_OBJ_H

#include "server/cage/build/builder.h"

/* Reads a whole file into an empty builder, in one pass. On success the indices of faces are in
 * range and coordinates finite; cage_repair() sees to the rest. False: ERROR_MODEL, which says
 * `name` and the line; ERROR_SERVER when memory is short. Any thread. */
bool obj_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error);

#endif
