/* A frame of the native device while its threads draw it: the data that the threads share, and the
 * data of each thread. Internal to the folder; lanes/ is compiled once for each instruction set
 * (sets.h).
 *
 * Depths are compared by "nearness": far / z - 1 in perspective, else far - z, where z is along the
 * axis and `far` is behind the model. Nearness is linear in the picture, larger for what is nearer,
 * and 0 for nothing. `before` is the difference far - z itself. Both are differences to a plane
 * close to the model, so that a model far away keeps its digits. */
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

/* The pixels that one thread draws at a time, without those around them (APRON) that it also looks
 * at. */
enum { TILE_WIDTH = 128, TILE_HEIGHT = 128, TILE_PX = TILE_WIDTH * TILE_HEIGHT, APRON = 1 };
/* A thread's array for a tile: with the apron, and room for a vector's end. */
enum {
    SEEN_PITCH = TILE_WIDTH + 2 * APRON + 14,
    SEEN_ROWS = TILE_HEIGHT + 2 * APRON,
    SEEN_PX = SEEN_PITCH * (SEEN_ROWS + 2)
};
/* The clusters of a model are divided into at most this many parts, whatever the number of threads,
 * so that the order of drawing does not depend on it. */
enum { MAX_PARTS = 64 };

/* The camera as lanes read it (shaders/view.glsl). */
struct native_rays {
    float axis[3][3];         /* right, down, forward */
    float slope_px, start_px; /* ray at q px from the centre: (q start, 0) + z (q slope, 1) */
    float centre_px[2];
    float far;
    bool perspective;
    float nearest, farthest; /* nearness of the view's near and far depths */
};

void native_rays_init(struct native_rays *rays, const struct view *view);

/* Which part of its node a piece is. */
enum piece_kind {
    PIECE_OF_PATCH, /* one sub-patch or a part of it */
    PIECE_REST,     /* CORNER: all from the vertex to 2^-level */
    PIECE_STRIP,    /* a whole STRIP */
};

/* A piece of the surface that covers at least one pixel's centre. */
struct native_piece {
    const struct native_patch *patch; /* PIECE_OF_PATCH; NULL: not found yet, or not kept */
    uint32_t node;
    float s, t, size;        /* the part, in the patch's parameters */
    uint16_t x0, y0, x1, y1; /* px of the picture that it may cover, inclusive */
    uint8_t kind, level, square;
};

/* The patch of a piece, which any thread of the frame may have found; NULL: none has yet. */
static inline const struct native_patch *native_piece_patch(const struct native_piece *piece)
{
    return __atomic_load_n(&piece->patch, __ATOMIC_ACQUIRE);
}

/* A piece in the form in which it is drawn, in one cache line. */
struct native_quad {
    float x[4], y[4]; /* QUAD_CELL: px of the corners (0,0) (1,0) (0,1) (1,1) */
    float nearness[4];
    uint16_t x0, y0, x1, y1;
    uint16_t grid;        /* QUAD_CELL, QUAD_TRIANGLES, or a grid's number in patch_grids.h */
    uint16_t n_triangles; /* QUAD_TRIANGLES only */
    uint32_t first;       /* first of its vertices or triangles */
};
enum { QUAD_CELL = UINT16_MAX, QUAD_TRIANGLES = UINT16_MAX - 1 };

/* A triangle of a piece that the near plane or the picture's border cuts, or that extends far
 * beyond. */
struct native_triangle {
    float x[3], y[3], nearness[3];
    float s[3], t[3], inverse_z[3]; /* s and t in the piece, in [0,1] */
};

/* An entry of a tile's list of quads. */
struct native_entry {
    float nearest; /* nearness */
    uint32_t quad;
    uint8_t x0, y0, x1, y1; /* px of the tile that it may touch, inclusive */
};

struct native_thread {
    unsigned number;
    struct patch_grids grids;
    /* Pieces and quads of the parts that this thread has done, in order. */
    struct native_piece *piece;
    struct native_quad *quad;
    float *nearest; /* largest nearness of each quad */
    size_t n_quads, quad_capacity;
    float *vertex; /* vertices of grids: x, y, nearness, each with room for one vector more */
    size_t n_vertices, vertex_capacity;
    struct native_triangle *triangle;
    size_t n_triangles, triangle_capacity;
    struct native_entry *entry;
    size_t n_entries, entry_capacity;
    struct native_tile_room *tile; /* tile.h */
    struct native_ray_room *rays;  /* rays/rays.h; NULL until needed */
    uint32_t *gap; /* pixels that may be in gaps, x | y << 16 in the requested tile */
    size_t n_gaps, gap_capacity;
    struct native_times times; /* in nanoseconds */
};
/* Drops the patches that a thread keeps in addition to its model's. */
void native_forget_patches(struct native_thread *thread);
/* The most pixels in gaps of one tile. */
enum { NATIVE_MAX_GAPS = 512 };

/* A part of the model: the thread that has done it, and where the entries of each tile begin. */
struct native_part {
    unsigned thread;
    uint32_t *first_entry; /* [n_tiles + 1] */
};

struct native_frame {
    struct native_model *model;
    const struct native_set *set;
    const struct view *view;
    struct tile tile;   /* the part of the picture to draw */
    struct tile around; /* the same with the pixels around it that are looked at */
    struct native_rays rays;
    const struct native_planes *planes;
    struct native_thread *thread;
    unsigned n_threads;
    uint32_t first_x, first_y; /* number of the first tile of TILE_WIDTH x TILE_HEIGHT */
    uint32_t tiles_x, tiles_y;
    struct native_part part[MAX_PARTS];
    uint32_t n_parts;
    size_t clusters_per_part;
    const float *const *grid_s, *const *grid_t; /* vertices of each grid (native.c) */
    uint32_t next_part, next_tile;              /* from which threads take work */
    uint64_t n_vertices;
    bool out_of_memory, too_many;
    bool left_gaps; /* there were more than NATIVE_MAX_GAPS */
};

/* 2^n, for an exponent of normal doubles. */
static inline double native_power(int n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

/* The size of a pixel in units at depth z in camera space. */
static inline float native_pixel_units(const struct native_rays *rays, float z)
{
    return z * rays->slope_px + rays->start_px;
}

/* Allocates memory aligned to cache lines, in huge pages if it is large. NULL when memory is
 * short. */
void *native_allocate(size_t bytes);
/* Makes room for n elements of `size` bytes and keeps the present ones. False when memory is
 * short. */
bool native_grow(void *pointer, size_t *capacity, size_t n, size_t size);

/* A node in camera space. */
struct native_seen_node {
    double at[3];       /* its origin */
    double before;      /* distance of the origin from the far depth */
    bool is_turned;     /* its frame is not the world's (CORNER) */
    float axes[3][3];   /* the frame; columns are its axes in the world */
    float camera[3][3]; /* right, down, forward in the frame */
};
void native_see_node(const struct native_frame *frame, const struct limit_node *node,
                     struct native_seen_node *seen);

/* The four edges of a node, in its local coordinates: whether its Ptex face has a border there, how
 * many of the node's cells lie in between, and the width of the rounding, in the node's size. */
struct native_borders {
    float is[4], beyond[4], rounding[4];
};
void native_borders_of(const struct limit_node *node, struct native_borders *borders);

/* Adds the triangles of a piece's cells, clipped to what can be drawn, to those of the thread.
 * Returns their number, or -1 when memory is short; adds the vertices that it computes to
 * frame->n_vertices, and nothing else if that is too many. With the patch of a PIECE_OF_PATCH, cells
 * far outside the picture are not computed (NULL: all are). Sets `box`, the pixels whose centres the
 * triangles may cover, and the largest nearness. */
int native_cut_piece(struct native_frame *frame, struct native_thread *thread,
                     const struct native_piece *piece, const struct native_patch *patch,
                     uint32_t grid, int box[4], float *nearest);

#endif
