/* A frame of the native device between its steps: what its threads share, and what each has alone.
 * Internal to the folder; lanes/ is compiled once for each instruction set (sets.h).
 *
 * Nearness stands for depth where depths are compared: far / z - 1 in perspective, far - z without,
 * with z along the axis and `far` behind all of the model. It is linear in the picture, larger for
 * what is nearer, 0 for nothing. `before` is far - z itself: both are differences to a plane beside
 * the model, so that a model that is far away keeps its digits. */
#ifndef SHEEN_RENDER_NATIVE_FRAME_H
#define SHEEN_RENDER_NATIVE_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "server/render/native/planes.h"
#include "server/render/native/patches.h"
#include "server/render/native/sets.h"
#include "server/render/patch_grids.h"
#include "server/render/view.h"

/* Pixels that one thread draws at a time, without those around them that it looks at too. */
enum { TILE_WIDTH = 128, TILE_HEIGHT = 128, TILE_PX = TILE_WIDTH * TILE_HEIGHT, APRON = 1 };
/* Rows of what a thread sees of a tile: with the apron, and room for a vector's end. */
enum {
    SEEN_PITCH = TILE_WIDTH + 2 * APRON + 14,
    SEEN_ROWS = TILE_HEIGHT + 2 * APRON,
    SEEN_PX = SEEN_PITCH * (SEEN_ROWS + 2)
};
/* The clusters of a model are cut into so many parts at most, whatever the number of threads: what
 * is drawn first does not depend on it. */
enum { MAX_PARTS = 64 };

/* The camera as lanes read it (shaders/view.glsl). */
struct native_rays {
    float axis[3][3];         /* right, down, forward */
    float slope_px, start_px; /* the ray of q px from the centre: (q start, 0) + z (q slope, 1) */
    float centre_px[2];
    float far;
    bool perspective;
    float nearest, farthest; /* nearness of the view's near and of its far depth */
};

void native_rays_init(struct native_rays *rays, const struct view *view);

/* What of its node a piece is. */
enum piece_kind {
    PIECE_OF_PATCH, /* a part of one sub-patch, or all of it */
    PIECE_REST,     /* of a CORNER: all from the vertex to 2^-level */
    PIECE_STRIP,    /* all of a STRIP */
};

/* A piece of the surface that covers some pixel's centre. */
struct native_piece {
    const struct native_patch *patch; /* of PIECE_OF_PATCH; NULL: not made yet, or not kept */
    uint32_t node;
    float s, t, size;        /* the part of the patch, in its parameters */
    uint16_t x0, y0, x1, y1; /* px of the picture that it may cover, inclusive */
    uint8_t kind, level, square;
};

/* The same as it is drawn, in one cache line. */
struct native_quad {
    float x[4], y[4]; /* px of the corners (0,0) (1,0) (0,1) (1,1), of one cell */
    float nearness[4];
    uint16_t x0, y0, x1, y1;
    uint16_t grid;        /* QUAD_CELL, QUAD_TRIANGLES, or which grid of patch_grids.h */
    uint16_t n_triangles; /* of QUAD_TRIANGLES */
    uint32_t first;       /* of its vertices or triangles */
};
enum { QUAD_CELL = UINT16_MAX, QUAD_TRIANGLES = UINT16_MAX - 1 };

/* Of a piece that the near plane or the picture's borders cut, or that reaches far beyond them. */
struct native_triangle {
    float x[3], y[3], nearness[3];
    float s[3], t[3], inverse_z[3]; /* s and t of the piece, in [0,1] */
};

/* Quads as a tile finds them. */
struct native_entry {
    float nearest; /* nearness */
    uint32_t quad;
};

struct native_thread {
    unsigned number;
    struct patch_grids grids;
    /* What the parts that it has done hold, one after the other. */
    struct native_piece *piece;
    struct native_quad *quad;
    float *nearest; /* of each quad: nearness */
    size_t n_quads, quad_capacity;
    float *vertex; /* of grids: x, y, nearness, a vector more of each than there are */
    size_t n_vertices, vertex_capacity;
    struct native_triangle *triangle;
    size_t n_triangles, triangle_capacity;
    struct native_entry *entry;
    size_t n_entries, entry_capacity;
    struct native_tile_room *tile; /* tile.h */
    struct native_ray_room *rays;  /* rays/rays.h; NULL until a frame needs it */
    uint32_t *gap; /* pixels that may be in gaps, x | y << 16 in the tile asked for */
    size_t n_gaps, gap_capacity;
    struct native_times times; /* nanoseconds */
};
/* Drops the patches that a thread keeps beside those of its model. */
void native_forget_patches(struct native_thread *thread);
/* Pixels in gaps that one tile may ask for. */
enum { NATIVE_MAX_GAPS = 512 };

/* Of a part: who has done it, and where each tile's entries begin. */
struct native_part {
    unsigned thread;
    uint32_t *first_entry; /* [n_tiles + 1] */
};

struct native_frame {
    struct native_model *model;
    const struct native_set *set;
    const struct view *view;
    struct tile tile;   /* the part of the picture that is asked for */
    struct tile around; /* and what is looked at for it */
    struct native_rays rays;
    const struct native_planes *planes;
    struct native_thread *thread;
    unsigned n_threads;
    uint32_t first_x,
        first_y; /* the tile of TILE_WIDTH x TILE_HEIGHT of the picture that is first */
    uint32_t tiles_x, tiles_y;
    struct native_part part[MAX_PARTS];
    uint32_t n_parts;
    size_t clusters_per_part;
    const float *const *grid_s, *const *grid_t; /* each grid's vertices (native.c) */
    /* Counters that threads take from, and what may go wrong meanwhile. */
    uint32_t next_part, next_tile;
    uint64_t n_vertices;
    bool out_of_memory, too_many;
    bool left_gaps; /* more than NATIVE_MAX_GAPS */
};

/* 2^n, of an exponent that doubles have. */
static inline double native_power(int n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* Of a place in camera space. */
static inline float native_pixel_units(const struct native_rays *rays, float z)
{
    return z * rays->slope_px + rays->start_px;
}

/* Aligned to cache lines, in huge pages where it is large. NULL when memory is short. */
void *native_allocate(size_t bytes);
/* Makes room for n elements of a size; those that there are stay. False when memory is short. */
bool native_grow(void *pointer, size_t *capacity, size_t n, size_t size);

/* A node as the camera sees it. */
struct native_seen_node {
    double at[3];       /* its origin in camera space */
    double before;      /* how far that is before the far depth */
    bool is_turned;     /* a CORNER: its frame is not the world's */
    float axes[3][3];   /* the frame: its axes in the world are the columns */
    float camera[3][3]; /* right, down, forward in the frame */
};
void native_see_node(const struct native_frame *frame, const struct limit_node *node,
                     struct native_seen_node *seen);

/* Of the edges of a node, as its local coordinates number them: whether its Ptex face has a border
 * there, how many of its cells lie between, and how wide the rounding is, in the node's size. */
struct native_borders {
    float is[4], beyond[4], rounding[4];
};
void native_borders_of(const struct limit_node *node, struct native_borders *borders);

/* Adds the triangles of a piece's cells, cut to what can be drawn, to those of the thread. Returns
 * how many; sets the box of the pixels' centres that they may cover and the largest nearness.
 * -1: no memory. */
int native_cut_piece(const struct native_frame *frame, struct native_thread *thread,
                     const struct native_piece *piece, uint32_t grid, int box[4], float *nearest);

#endif
