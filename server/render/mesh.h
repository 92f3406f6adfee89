/* Makes the polygons of the conventional picture (Yasui and Kanai 2004, figure 7): the cage
 * subdivided LEVEL times, with vertices at their limit positions and with limit normals. Contains
 * no GL. Pure, any thread.
 *
 * Every Ptex face becomes a grid of cells x cells quads: 2^level for a quad of the cage,
 * 2^(level-1) for a Ptex face of an n-gon, because one subdivision step divides an n-gon into its
 * Ptex faces. At level 0 an n-gon stays whole: a fan about the middle of its limit corners (the
 * mean of positions and normals). The parts of the fan's triangles beside corner k are drawn as
 * Ptex face k.
 *
 * Neighbouring Ptex faces have separate vertices along their common edge, so that creases stay
 * creases. */
#ifndef SHEEN_RENDER_MESH_H
#define SHEEN_RENDER_MESH_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "server/render/frame_watch.h"
#include "server/render/view.h"
#include "server/surface/tables.h"

/* The largest mesh: 256 MiB of vertices and 192 MiB of indices. */
#define MESH_MAX_VERTICES ((uint64_t)8 << 20)
#define MESH_IS_FAN 0x80000000u

/* 32 bytes; read by shaders/polygon.vert.glsl. */
struct mesh_vertex {
    float position[3]; /* relative to the mesh's centre */
    float normal[3];   /* zero: no normal */
    /* Ptex face; with MESH_IS_FAN only the edges at its (0,0) are edges of the polygon. */
    uint32_t face;
    uint8_t x, y; /* place in the grid: u = x / cells, v = y / cells */
    uint8_t cells, unused;
};

/* A run of triangles that lie close together and are drawn or skipped as a whole. */
#define MESH_PART_INDICES 6144u /* at most, for a block of 32 x 32 cells */
struct mesh_part {
    uint32_t first, n;            /* indices */
    uint32_t chunk;               /* the chunk that contains it */
    float box_min[3], box_max[3]; /* relative to the mesh's centre */
};

/* A chunk: whole parts and the vertices that only they use. It is put on the device at once. */
#define MESH_CHUNK_BYTES ((size_t)512 << 10) /* or a face more */
struct mesh_chunk {
    uint32_t first_vertex, n_vertices, first_index, n_indices;
};

struct mesh {
    struct mesh_vertex *vertex;
    /* Two triangles for each cell, split from (0,0) to (1,1), block by block. */
    uint32_t *index;
    struct mesh_part *part;   /* all indices, in order */
    struct mesh_chunk *chunk; /* all vertices and indices, in order */
    size_t n_vertices, n_indices, n_parts, n_chunks;
    double centre[3]; /* world */
};

struct renderer_polygons {
    struct mesh mesh;
    atomic_uint holders;
};

/* A device may keep polygons after the frame for which they were made. Each holder releases them,
 * and the last one frees them. Any thread. */
void polygons_hold(struct renderer_polygons *polygons);
void polygons_release(struct renderer_polygons *polygons); /* NULL is safe */

/* Makes a mesh. False with ERROR_REQUEST if the level has more than MESH_MAX_VERTICES, which names
 * the finest possible level, or with ERROR_SERVER when memory is short or nobody waits. */
bool mesh_init(struct mesh *mesh, const struct limit_tables *tables, uint32_t level,
               const struct frame_watch *watch, struct error *error);
void mesh_finish(struct mesh *mesh);

/* True if no triangle of a part reaches the tile with these sides, or a pixel next to it. `centre`
 * is the mesh's. */
bool mesh_part_is_outside(const struct mesh_part *part, const double centre[3],
                          const struct view *view, const struct view_sides *sides);

#endif
