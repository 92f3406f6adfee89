/* The meshes of polygons that the device keeps: put there chunk by chunk, the oldest making room.
 * GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_MESHES_H
#define SHEEN_RENDER_GL_POLYGON_MESHES_H

#include "server/base/error.h"
#include "server/render/gl/polygon_kept.h"

struct gl_model;
struct gl_renderer;

/* Are they on the device, wholly? */
bool polygons_have(struct polygon_meshes *meshes, uint64_t model_serial, uint32_t level);
bool polygons_are_whole(const struct polygon_mesh *mesh);
/* The mesh, after putting the next chunks of it on the device, about so many bytes, from r->made,
 * unless it is whole. NULL on failure. */
struct polygon_mesh *polygons_put(struct gl_renderer *r, const struct gl_model *model,
                                  uint32_t level, size_t most, struct error *error);
/* Drops the meshes of a model that goes. */
void polygons_forget(struct polygon_meshes *meshes, uint64_t model_serial);
/* Drops all after the context that they were in. */
void polygons_lose(struct polygon_meshes *meshes);

#endif
