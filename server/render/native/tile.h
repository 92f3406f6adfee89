/* A thread's data of the tile that it draws: what is visible, and lists of its pixels. Internal to the folder. */
#ifndef SHEEN_RENDER_NATIVE_TILE_H
#define SHEEN_RENDER_NATIVE_TILE_H

#include "server/render/native/frame.h"

/* A sub-patch of a node: its parameters are x 2^scale_x - origin_x and y 2^scale_y - origin_y. */
struct native_part_of_node {
    uint32_t index; /* patches.h */
    int8_t scale_x, scale_y, origin_x, origin_y;
    bool at_vertex; /* beyond all levels of a CORNER */
};
/* A ray, and a place on the surface near which it may meet the surface (shaders/walk.glsl). */
struct native_task {
    uint32_t asker; /* an index for the caller */
    uint32_t node;
    struct native_part_of_node part;
    const struct native_patch *patch; /* patch of that part; NULL: not kept */
    float s, t;                       /* on it */
    float before;                     /* distance of the guess from the far depth */
    double at_px[2];                  /* the ray, px of the picture */
};

/* A hit: a place that a ray meets. */
struct native_met {
    bool found;
    uint32_t node;
    struct native_part_of_node part;
    float s, t;  /* on the part; at a vertex: on the tangent plane */
    double x, y; /* on the node */
    float before;
};

/* A pixel that asks its neighbours for guesses. */
struct native_asking {
    uint16_t pixel;
    bool has_hit; /* the planes have its hit, unless something is in front */
    struct native_met best;
};

/* What is met at the pixels of a tile (native.h), at x + TILE_WIDTH * y, with room for a vector that begins before
 * the first pixel or ends behind the last. */
enum { TILE_PLANE = TILE_PX + 32, TILE_PLANE_FIRST = 16 };
struct native_tile_planes {
    float before[TILE_PLANE]; /* distance from the far depth; below 0: nothing */
    float depth[TILE_PLANE], normal[3][TILE_PLANE], shape[3][TILE_PLANE];
    float u[TILE_PLANE], v[TILE_PLANE];
    int32_t face[TILE_PLANE], border[TILE_PLANE], node[TILE_PLANE], where[TILE_PLANE];
};

/* Patches for which the native_model has no room, kept by a thread. */
enum { TILE_PATCHES = 256 };
struct native_found_patch {
    uint32_t node, index; /* node UINT32_MAX: unused */
    struct native_patch patch;
};

struct native_tile_room {
    struct tile tile;   /* px of the picture */
    int x0, y0, x1, y1; /* the pixels of what is visible that are looked at, inclusive */
    /* For each pixel and those around: nearness (0: nothing), the piece (an index of `local`; -1: none), and the
     * place on it, s | t << 16 in 1/65535. */
    float nearness[SEEN_PX];
    int32_t piece[SEEN_PX], place[SEEN_PX];
    struct native_tile_planes planes;
    struct native_found_patch patch[TILE_PATCHES];
    struct native_piece **local; /* the tile's pieces in the order of drawing */
    const struct native_quad **quad;
    uint32_t *count; /* [n_local + 2]: first pixel of each piece in pixel[] */
    uint32_t *order;
    size_t n_local, local_capacity;
    uint16_t pixel[TILE_PX + 16]; /* x + TILE_WIDTH * y, sorted by piece */
    int32_t guess[TILE_PX + 16];  /* the place of each pixel */
    uint16_t stray[TILE_PX];      /* pixels whose guess does not lead to a place on its sub-patch */
    struct native_asking asking[TILE_PX];
    uint32_t n_strays, n_asking;
    struct native_task *task;
    struct native_met *met; /* hit of each task */
    uint32_t *active;       /* unfinished tasks */
    size_t n_tasks, task_capacity;
};

/* The index of a tile's pixel in the arrays of size SEEN_PX. */
static inline int native_seen_at(uint32_t pixel)
{
    return ((int)(pixel / TILE_WIDTH) + APRON) * SEEN_PITCH + (int)(pixel % TILE_WIDTH) + APRON;
}

/* Converts a place of a piece, s and t in [0,1], to its node. */
void native_place(const struct limit_tables *tables, const struct native_piece *piece, double s,
                  double t, double *x, double *y);
/* Moves from a node to (x,y), across its borders if needed (shaders/neighbours.glsl). False if there is no
 * surface. */
bool native_walk(const struct limit_tables *tables, uint32_t *node, double *x, double *y);

/* Gets a sub-patch: the model's, or one of the thread, which is valid until the thread gets others. */
const struct native_patch *native_patch_of(const struct native_frame *frame,
                                           struct native_tile_room *room, uint32_t node,
                                           uint32_t index);
/* The index of a PIECE_OF_PATCH's sub-patch (patches.h). */
static inline uint32_t native_piece_index(const struct limit_node *node,
                                          const struct native_piece *piece)
{
    bool is_last = node->kind == LIMIT_STRIP && !piece->square; /* comes after all levels */
    return native_patch_index(node, piece->level + is_last, piece->square);
}
/* The sub-patch of a PIECE_OF_PATCH, which the piece then names if the model keeps it. */
const struct native_patch *native_patch_of_piece(const struct native_frame *frame,
                                                 struct native_tile_room *room,
                                                 struct native_piece *piece);

/* The sub-patch of a node at a place. */
struct native_part_of_node native_patch_at(const struct limit_node *node, double x, double y);

/* Starts a task at a place of its node. */
void native_begin_at(const struct native_model *model, struct native_task *task, double x,
                     double y);
/* Starts a task at a place of a piece (native_tile_room.place). */
void native_begin_on(const struct native_model *model, struct native_task *task,
                     const struct native_piece *piece, int32_t place);

/* Packs a place on a node as in shaders/visibility.frag.glsl. */
uint32_t native_guess_of(const struct native_part_of_node *part, const struct limit_node *node,
                         double x, double y);
/* Computes (u,v) on the Ptex face of a place on a node. */
void native_ptex(const struct limit_node *node, double x, double y, float uv[2]);

#endif
