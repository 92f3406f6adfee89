/* The meshes of polygons on the device. They are put there chunk by chunk; the least recently used
 * make room. GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_MESHES_H
#define SHEEN_RENDER_GL_POLYGON_MESHES_H

#include "server/base/error.h"
#include "server/render/gl/polygon_kept.h"

struct gl_model;
struct gl_renderer;

/* polygons_have(): the mesh is on the device completely. polygons_are_whole(): all chunks are
 * there. */
bool polygons_have(struct polygon_meshes *meshes, uint64_t model_serial, uint32_t level);
bool polygons_are_whole(const struct polygon_mesh *mesh);
/* Puts the next chunks of a mesh on the device, about `most` bytes, from r->made, unless the mesh
 * is complete. Returns the mesh; NULL on failure. */
struct polygon_mesh *polygons_put(struct gl_renderer *r, const struct gl_model *model,
                                  uint32_t level, size_t most, struct error *error);
/* Deletes the meshes of a model that is destroyed. */
void polygons_forget(struct polygon_meshes *meshes, uint64_t model_serial);
/* Forgets all meshes after their context was lost. */
void polygons_lose(struct polygon_meshes *meshes);

#endif
