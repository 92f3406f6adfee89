/* Reads Wavefront OBJ with OpenSubdiv's "t" tags. Internal to server/cage/read. Any thread. */
#ifndef SHEEN_CAGE_READ_OBJ_H
#define SHEEN_CAGE_READ_OBJ_H

#include "server/cage/build/builder.h"

/* Reads a whole file into an empty builder, in one pass. On success the indices of faces are in
 * range and coordinates are finite; cage_repair() checks the rest. False with ERROR_MODEL, which
 * names `name` and the line, or with ERROR_SERVER when memory is short. */
bool obj_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error);

#endif
