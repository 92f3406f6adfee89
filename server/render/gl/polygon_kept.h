/* What the device keeps of polygons between the steps of frames: meshes, and the tiles that have been
 * drawn in part. Data; polygon_meshes.h and paused_tiles.h change it. GL thread, where nothing else is
 * said. */
#ifndef SHEEN_RENDER_GL_POLYGON_KEPT_H
#define SHEEN_RENDER_GL_POLYGON_KEPT_H

#include <epoxy/gl.h>

#include <stdatomic.h>
#include <stdint.h>

#include "server/render/gl/context/context.h"
#include "server/render/gl/planes.h"
#include "server/render/mesh.h"

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

/* What a frame of polygons has drawn of its tile, while others are drawn between its steps. */
enum { MAX_PAUSED_TILES = 24 };
struct paused_tile {
    struct planes planes;
    context_number context; /* of the planes */
    uint64_t model_serial;  /* the device must keep this model's mesh of this level meanwhile */
    uint32_t level;
    atomic_bool is_taken; /* by a frame, which gives it back on any thread */
    struct paused_tiles *set;
};

/* On the heap, since a frame may give its tile back when the renderer has gone. */
struct paused_tiles {
    atomic_uint holders; /* the renderer, and the frames with a paused tile; the last one frees the
                            set */
    struct paused_tile paused[MAX_PAUSED_TILES];
};

#endif
