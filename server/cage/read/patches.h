/* Reads .patches files: sheen's own text form of Bezier, B-spline, Hermite and Coons patches,
 * described in server/cage/README.md. Internal to server/cage/read. Any thread. */
#ifndef SHEEN_CAGE_READ_PATCHES_H
#define SHEEN_CAGE_READ_PATCHES_H

#include "server/cage/build/builder.h"

/* Reads a whole file into an empty builder. False with ERROR_MODEL, which names `name` and the
 * line, or with ERROR_SERVER when memory is short. */
bool patches_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
                  struct error *error);

#endif
