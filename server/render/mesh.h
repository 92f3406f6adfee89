/* The conventional picture's polygons (Yasui and Kanai 2004, figure 7): the cage subdivided LEVEL
 * times, its vertices moved to their limit positions, with their limit normals. Pure: no GL here.
 *
 * Every Ptex face becomes a grid of cells x cells quads: a quad of the cage 2^level, a Ptex face of
 * an n-gon 2^(level-1), since one step of subdivision cuts an n-gon into those. At level 0 an n-gon
 * stays whole: a fan round the middle of its limit corners (the mean of positions and normals). The
 * half of the fan's triangles beside corner k is drawn as Ptex face k.
 *
 * Neighbouring Ptex faces each have their own vertices along the edge between them: so creases stay
 * creases. */
#ifndef SHEEN_RENDER_MESH_H
#define SHEEN_RENDER_MESH_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "server/render/frame_watch.h"
#include "server/render/view.h"
#include "server/surface/tables.h"

/* Of one mesh: 256 MiB of vertices, and 192 MiB of indices. */
#define MESH_MAX_VERTICES ((uint64_t)8 << 20)
#define MESH_IS_FAN 0x80000000u

/* 32 bytes, as shaders/polygon.vert.glsl reads it. */
struct mesh_vertex {
    float position[3]; /* relative to the mesh's centre */
    float normal[3];   /* zero where there is none */
    uint32_t face;     /* Ptex face, plus MESH_IS_FAN where only the edges at its (0,0) are edges */
    uint8_t x, y;      /* of the grid: u = x / cells, v = y / cells */
    uint8_t cells, unused;
};

/* Triangles that follow each other and lie together: what is drawn, or left out, at once. */
#define MESH_PART_INDICES 6144u /* at most: a block of 32 x 32 cells */
struct mesh_part {
    uint32_t first, n;            /* indices */
    uint32_t chunk;               /* the chunk that it is in */
    float box_min[3], box_max[3]; /* relative to the mesh's centre */
};

/* Whole parts, and the vertices that they alone have: what comes to the device at once. */
#define MESH_CHUNK_BYTES ((size_t)512 << 10) /* or a face more */
struct mesh_chunk {
    uint32_t first_vertex, n_vertices, first_index, n_indices;
};

struct mesh {
    struct mesh_vertex *vertex;
    uint32_t *index;          /* two triangles a cell, split from (0,0) to (1,1), block by block */
    struct mesh_part *part;   /* all indices, in order */
    struct mesh_chunk *chunk; /* all vertices and indices, in order */
    size_t n_vertices, n_indices, n_parts, n_chunks;
    double centre[3]; /* world */
};

struct renderer_polygons {
    struct mesh mesh;
    atomic_uint holders;
};

/* A device may hold polygons on after the frame that they were made for. Whoever holds them releases them; the last one
 * frees them. Any thread. */
void polygons_hold(struct renderer_polygons *polygons);
void polygons_release(struct renderer_polygons *polygons); /* NULL is safe */

/* ERROR_REQUEST when the level has more than MESH_MAX_VERTICES, naming the finest that has not;
 * ERROR_SERVER when memory is short or the watch says that nobody waits. */
bool mesh_init(struct mesh *mesh, const struct limit_tables *tables, uint32_t level,
               const struct frame_watch *watch, struct error *error);
void mesh_finish(struct mesh *mesh);

/* No triangle of a part reaches the tile that the sides are those of, or a pixel beside it. `centre` is the mesh's. */
bool mesh_part_is_outside(const struct mesh_part *part, const double centre[3],
                          const struct view *view, const struct view_sides *sides);

#endif
