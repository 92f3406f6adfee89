/* Reads USD's text form, as it is in files named .usda. Internal to server/cage/read. Any
 * thread. */
#ifndef SHEEN_CAGE_READ_USD_USD_H
#define SHEEN_CAGE_READ_USD_USD_H

#include "server/cage/build/builder.h"

/* Reads all meshes of a layer that are drawn into an empty builder, each as a separate surface,
 * with the tags of UsdGeomMesh. On success the indices of faces are in range and coordinates are
 * finite; cage_repair() checks the rest. Nothing outside of the file is read: what composes a stage
 * of several files, and the binary forms (.usdc, .usdz), are refused. False with ERROR_MODEL, which
 * names `name` and the line, or with ERROR_SERVER when memory is short. */
bool usd_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
              struct error *error);

#endif
