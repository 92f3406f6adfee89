/* The meshes of polygons that the device keeps: put there chunk by chunk, the oldest making room.
 * GL thread. */
#ifndef SHEEN_RENDER_GL_POLYGON_MESHES_H
#define SHEEN_RENDER_GL_POLYGON_MESHES_H

#include <epoxy/gl.h>

#include "server/render/mesh.h"

struct gl_model;
struct gl_renderer;

/* One chunk of a mesh. Meshes are cut into chunks because some drivers clear a new buffer, which
 * takes long for a large one. */
struct polygon_chunk {
    GLuint array, buffer[2]; /* vertices, indices */
    struct mesh_chunk of;
};

/* One mesh of polygons on the device. */
struct polygon_mesh {
    uint64_t model_serial; /* 0: a free place */
    uint32_t level;
    struct mesh_part *part; /* owned, as the chunks are */
    struct polygon_chunk *chunk;
    size_t n_parts, n_chunks;
    size_t n_put;  /* chunks that the device has */
    size_t bytes;  /* on the device, once all chunks are there */
    uint64_t used; /* by the cache's clock */
    double centre[3];
};

enum { MAX_POLYGON_MESHES = 32 };

/* All zero: none. */
struct polygon_meshes {
    struct polygon_mesh mesh[MAX_POLYGON_MESHES];
    size_t bytes; /* of all */
    uint64_t clock;
};

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
