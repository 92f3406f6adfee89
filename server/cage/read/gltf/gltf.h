/* Reads glTF 2.0 and GLB by tinygltf, in C++. Internal to server/cage/read. Any thread. */
#ifndef SHEEN_CAGE_READ_GLTF_GLTF_H
#define SHEEN_CAGE_READ_GLTF_GLTF_H

#ifdef __cplusplus
extern "C" {
#endif

#include "server/cage/build/builder.h"

/* Reads the default scene into an empty builder: the triangles of all its nodes' meshes; polygons
 * where FB_ngon_encoding marks them; each mesh of each node as a separate surface, its vertices
 * welded by position; subdivision tags from `extras`. No file is opened. False with ERROR_MODEL,
 * which names `name` and the mesh, or with ERROR_SERVER when memory is short. No exception leaves
 * the function. */
bool gltf_read(struct cage_builder *builder, const void *bytes, size_t size, const char *name,
               struct error *error);

#ifdef __cplusplus
}
#endif

#endif
