/* What the device keeps of polygons between the steps of frames: meshes, and partly drawn tiles.
 * Data; polygon_meshes.h and paused_tiles.h change it. GL thread, except where noted. */
#ifndef SHEEN_RENDER_GL_POLYGON_KEPT_H
#define SHEEN_RENDER_GL_POLYGON_KEPT_H

#include <epoxy/gl.h>

#include <stdatomic.h>
#include <stdint.h>

#include "server/render/gl/context/context.h"
#include "server/render/gl/planes.h"
#include "server/render/mesh.h"

/* One chunk of a mesh. Meshes are divided into chunks because some drivers clear a new buffer,
 * which takes long for a large one. */
struct polygon_chunk {
    GLuint array, buffer[2]; /* vertices, indices */
    struct mesh_chunk of;
};

/* One mesh of polygons on the device. */
struct polygon_mesh {
    uint64_t model_serial; /* 0: unused */
    uint32_t level;
    struct mesh_part *part; /* owned, like the chunks */
    struct polygon_chunk *chunk;
    size_t n_parts, n_chunks;
    size_t n_put;  /* chunks on the device */
    size_t bytes;  /* bytes on the device when all chunks are there */
    uint64_t used; /* time of the last use, by the clock of struct polygon_meshes */
    double centre[3];
};

enum { MAX_POLYGON_MESHES = 32 };

/* All zero: no meshes. */
struct polygon_meshes {
    struct polygon_mesh mesh[MAX_POLYGON_MESHES];
    size_t bytes; /* bytes of all meshes */
    uint64_t clock;
};

/* The drawn part of a frame's tile of polygons, while other frames are drawn between its steps. */
enum { MAX_PAUSED_TILES = 24 };
struct paused_tile {
    struct planes planes;
    context_number context; /* GL context of the planes */
    uint64_t model_serial;  /* the device must keep this model's mesh of this level meanwhile */
    uint32_t level;
    atomic_bool is_taken; /* used by a frame, which releases it on any thread */
    struct paused_tiles *set;
};

/* On the heap, because a frame may release its tile after the renderer was destroyed. */
struct paused_tiles {
    /* The renderer, and the frames with a paused tile; the last one frees the set. */
    atomic_uint holders;
    struct paused_tile paused[MAX_PAUSED_TILES];
};

#endif
