/* Stage 1 for polygons: finds the triangle of a mesh (server/render/mesh.h) that each pixel of a tile shows, one part
 * of the mesh at a time. First all threads place triangles in the picture; then threads take tiles and draw their
 * triangles in the order of the mesh, so that the result depends neither on threads nor on slices. Internal to the
 * folder; the thread that has the device. lanes/ is compiled once for each instruction set (sets.h). */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_FILL_H
#define SHEEN_RENDER_NATIVE_POLYGONS_FILL_H

#include "server/render/mesh.h"
#include "server/render/native/clip/clip.h"
#include "server/render/native/frame.h"

struct native_device;

/* What the pixels of a tile show; a frame keeps it between its steps. All zero: nothing, and no memory. */
struct native_seen_triangles {
    float *nearness; /* frame.h; 0: nothing */
    int32_t *number; /* number of the triangle; -1: none */
    size_t pitch;    /* elements of a row */
    uint32_t width, height;
    size_t n_nearness, n_number; /* elements allocated */
};

/* A triangle placed in the picture, px. */
struct native_placed_triangle {
    float x[3], y[3], nearness[3];
    uint16_t x0, y0, x1, y1; /* px of the tile that it may cover, inclusive */
    int32_t number;
};

/* What one thread has placed, for each part of the mesh; the memory is kept between slices. */
struct native_placed_part {
    uint32_t *first_entry; /* [n_tiles + 2]: first entry of each tile */
    const struct native_polygon_thread *thread;
};
struct native_polygon_thread {
    struct native_placed_triangle *triangle;
    uint32_t *entry; /* lists of triangles for tiles */
    size_t n_triangles, triangle_capacity, n_entries, entry_capacity;
};

/* Zero it before the first use. */
struct native_polygon_stage {
    struct native_polygon_thread thread[NATIVE_MAX_THREADS];
    uint32_t *part; /* parts of the mesh in the slice that the tile may show */
    struct native_placed_part *placed;
    uint32_t *first_entry;
    size_t part_capacity, placed_capacity, first_entry_capacity;
};

/* A slice of a tile while it is drawn. */
struct native_slice {
    struct native_polygon_stage *stage;
    const struct native_set *set;
    const struct mesh *mesh;
    const struct view *view;
    struct native_seen_triangles *seen;
    struct tile tile; /* the part of the picture to draw */
    uint32_t tiles_x,
        tiles_y;   /* number of tiles of TILE_WIDTH x TILE_HEIGHT; the last may be smaller */
    bool is_first; /* nothing was drawn yet */
    float
        /* Distance beyond its edges in which a triangle covers pixels, because neighbours round shared vertices
         * differently. */
        slack_px;
    struct native_rays rays;
    struct native_clip clip;
    float centre[3],
        before; /* centre of the mesh in camera space, and its distance from the far depth */
    uint32_t n_parts;
    uint32_t next_part, next_tile; /* counters from which threads take work */
    bool out_of_memory;
};

/* Draws a tile's next slice: parts of the mesh from *part on with about `most` triangles, and advances *part. The
 * first slice begins with part 0. False with ERROR_SERVER when memory is short. */
bool native_polygons_fill(struct native_polygon_stage *stage, struct native_device *device,
                          const struct mesh *mesh, const struct view *view, const struct tile *tile,
                          struct native_seen_triangles *seen, size_t *part, size_t most,
                          struct error *error);
/* The memory of a tile of this size, in bytes. */
uint64_t native_seen_bytes(uint32_t width_px, uint32_t height_px);
void native_seen_finish(struct native_seen_triangles *seen);
void native_polygon_stage_finish(struct native_polygon_stage *stage);

#endif
