/* What a thread has of the tile that it draws: what is seen, and lists of its pixels. Internal to
 * the folder. */
#ifndef SHEEN_RENDER_NATIVE_TILE_H
#define SHEEN_RENDER_NATIVE_TILE_H

#include "server/render/native/frame.h"

/* A sub-patch of a node: its parameters are x 2^scale_x - origin_x and y 2^scale_y - origin_y. */
struct native_part_of_node {
    uint32_t index; /* patches.h */
    int8_t scale_x, scale_y, origin_x, origin_y;
    bool at_vertex; /* where all levels of a CORNER end */
};
/* A ray and a place on the surface near which it may meet that (shaders/walk.glsl). */
struct native_task {
    uint32_t asker; /* an index of the caller's */
    uint32_t node;
    struct native_part_of_node part;
    const struct native_patch *patch; /* of that part; NULL: not kept */
    float s, t;                       /* on it */
    float before;                     /* how far the guess is before the far depth */
    double at_px[2];                  /* where the ray runs, px of the picture */
};

/* A place that a ray meets. */
struct native_met {
    bool found;
    uint32_t node;
    struct native_part_of_node part;
    float s, t;  /* on the part; at a vertex: on its tangent plane */
    double x, y; /* on the node */
    float before;
};

/* A pixel that asks those around it. */
struct native_asking {
    uint16_t pixel;
    bool has_hit; /* the planes hold what it shows unless something lies in front */
    struct native_met best;
};

/* What is met at the pixels of a tile (native.h), x + TILE_WIDTH * y each, with room for a vector
 * that begins before the first one or ends behind the last. */
enum { TILE_PLANE = TILE_PX + 32, TILE_PLANE_FIRST = 16 };
struct native_tile_planes {
    float before[TILE_PLANE]; /* how far before the far depth; below 0: nothing is met */
    float depth[TILE_PLANE], normal[3][TILE_PLANE], shape[3][TILE_PLANE];
    float u[TILE_PLANE], v[TILE_PLANE];
    int32_t face[TILE_PLANE], border[TILE_PLANE], node[TILE_PLANE], where[TILE_PLANE];
};

/* Patches that their native_model has no room for, as a thread has come across them. */
enum { TILE_PATCHES = 256 };
struct native_found_patch {
    uint32_t node, index; /* node: UINT32_MAX where there is none */
    struct native_patch patch;
};

struct native_tile_room {
    struct tile tile;   /* px of the picture */
    int x0, y0, x1, y1; /* of those of what is seen that are looked at at all, inclusive */
    /* Of each pixel and those around: nearness (0: nothing is seen), the piece (an index of
     * `local`; -1: none) and the place on it, s | t << 16 in 1/65535. */
    float nearness[SEEN_PX];
    int32_t piece[SEEN_PX], place[SEEN_PX];
    struct native_tile_planes planes;
    struct native_found_patch patch[TILE_PATCHES];
    /* The tile's pieces, in the order in which they are drawn. */
    const struct native_piece **local;
    const struct native_quad **quad;
    uint32_t *count; /* [n_local + 2]: where each piece's pixels begin in pixel[] */
    uint32_t *order;
    size_t n_local, local_capacity;
    uint16_t pixel[TILE_PX + 16]; /* x + TILE_WIDTH * y, sorted by piece */
    int32_t guess[TILE_PX + 16];  /* the place of each */
    uint16_t stray[TILE_PX]; /* pixels whose guess does not lead to a place on its own sub-patch */
    struct native_asking asking[TILE_PX];
    uint32_t n_strays, n_asking;
    struct native_task *task;
    struct native_met *met; /* of each task */
    uint32_t *active;       /* tasks that are not done */
    size_t n_tasks, task_capacity;
};

/* Of a pixel of the tile in what is seen. */
static inline int native_seen_at(uint32_t pixel)
{
    return ((int)(pixel / TILE_WIDTH) + APRON) * SEEN_PITCH + (int)(pixel % TILE_WIDTH) + APRON;
}

/* A place of a piece, s and t in [0,1], on its node. */
void native_place(const struct limit_tables *tables, const struct native_piece *piece, double s,
                  double t, double *x, double *y);
/* Where a step to (x,y) leads from a node, over its borders if need be (shaders/neighbours.glsl).
 * False where there is no surface. */
bool native_walk(const struct limit_tables *tables, uint32_t *node, double *x, double *y);

/* A sub-patch: kept by the model, else the thread's own until it asks for others. */
const struct native_patch *native_patch_of(const struct native_frame *frame,
                                           struct native_tile_room *room, uint32_t node,
                                           uint32_t index);
/* That of a PIECE_OF_PATCH. */
const struct native_patch *native_patch_of_piece(const struct native_frame *frame,
                                                 struct native_tile_room *room,
                                                 const struct native_piece *piece);

/* The sub-patch of a node that holds a place. */
struct native_part_of_node native_patch_at(const struct limit_node *node, double x, double y);

/* Lets a task begin at a place of its node. */
void native_begin_at(const struct native_model *model, struct native_task *task, double x,
                     double y);
/* Or at a place of a piece: native_tile_room.place. */
void native_begin_on(const struct native_model *model, struct native_task *task,
                     const struct native_piece *piece, int32_t place);

/* The place on its node as shaders/visibility.frag.glsl packs it. */
uint32_t native_guess_of(const struct native_part_of_node *part, const struct limit_node *node,
                         double x, double y);
/* (u,v) on the Ptex face of a place on a node. */
void native_ptex(const struct limit_node *node, double x, double y, float uv[2]);

#endif
