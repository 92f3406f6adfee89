/* Stage 1 of polygons: which triangle of a mesh (server/render/mesh.h) each pixel of a tile shows, a part of the mesh at a
 * time. Triangles are placed in the picture by all threads; then the threads take tiles of it, and draw what lies there in
 * the order of the mesh, so that neither threads nor slices decide what is seen. Internal to the folder; the thread that
 * has the device. lanes/ is compiled once for each instruction set (sets.h). */
#ifndef SHEEN_RENDER_NATIVE_POLYGONS_FILL_H
#define SHEEN_RENDER_NATIVE_POLYGONS_FILL_H

#include "server/render/mesh.h"
#include "server/render/native/clip.h"
#include "server/render/native/frame.h"

struct native_device;

/* What the pixels of a tile show. Kept by a frame between its steps. All zero: nothing, and no memory. */
struct native_seen_triangles {
    float *nearness; /* frame.h; 0: nothing */
    int32_t *number; /* of the triangle, -1: none */
    size_t pitch;    /* elements a row */
    uint32_t width, height;
    size_t n_nearness, n_number; /* elements that there is memory for */
};

/* A triangle in the picture, px. */
struct native_placed_triangle {
    float x[3], y[3], nearness[3];
    uint16_t x0, y0, x1, y1; /* px of the tile that it may cover, inclusive */
    int32_t number;
};

/* What one thread has placed, part by part of the mesh; memory stays from slice to slice. */
struct native_placed_part {
    uint32_t *first_entry; /* [n_tiles + 2]: where the entries of each tile begin */
    const struct native_polygon_thread *thread;
};
struct native_polygon_thread {
    struct native_placed_triangle *triangle;
    uint32_t *entry; /* triangles as tiles find them */
    size_t n_triangles, triangle_capacity, n_entries, entry_capacity;
};

/* All zero before the first use. */
struct native_polygon_stage {
    struct native_polygon_thread thread[NATIVE_MAX_THREADS];
    uint32_t *part; /* of the mesh, those of the slice that the tile may show */
    struct native_placed_part *placed;
    uint32_t *first_entry;
    size_t part_capacity, placed_capacity, first_entry_capacity;
};

/* A slice of a tile in the making. */
struct native_slice {
    struct native_polygon_stage *stage;
    const struct native_set *set;
    const struct mesh *mesh;
    const struct view *view;
    struct native_seen_triangles *seen;
    struct tile tile;          /* the part of the picture that is drawn */
    uint32_t tiles_x, tiles_y; /* of TILE_WIDTH x TILE_HEIGHT, the last ones smaller */
    bool is_first;             /* nothing has been drawn yet */
    float
        slack_px; /* how far beyond its edges a triangle covers pixels, since neighbours round shared vertices apart */
    struct native_rays rays;
    struct native_clip clip;
    float centre[3], before; /* of the mesh in camera space; how far that is before the far depth */
    uint32_t n_parts;
    uint32_t next_part, next_tile; /* counters that threads take from */
    bool out_of_memory;
};

/* A drawn tile's next slice: parts of the mesh from *part on that have about `most` triangles, beginning with part 0.
 * *part becomes the next one. ERROR_SERVER when memory is short. */
bool native_polygons_fill(struct native_polygon_stage *stage, struct native_device *device,
                          const struct mesh *mesh, const struct view *view, const struct tile *tile,
                          struct native_seen_triangles *seen, size_t *part, size_t most,
                          struct error *error);
/* Memory of a tile of that size. */
uint64_t native_seen_bytes(uint32_t width_px, uint32_t height_px);
void native_seen_finish(struct native_seen_triangles *seen);
void native_polygon_stage_finish(struct native_polygon_stage *stage);

#endif
