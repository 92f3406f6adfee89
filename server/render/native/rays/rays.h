/* Rays spread over pixels that one sample cannot show (shaders/rounded.glsl), and the places where
 * they meet the surface. Internal to the folder.
 *
 * A thread takes at most RAYS_PX pixels of one tile at a time. It draws the tile's pieces, cut
 * finely, at the points of the picture through which these pixels' rays run. The piece at a ray's
 * point gives the place where the ray starts: a task. A drawn piece is not exactly the surface, so
 * a piece beside the point is tried as well where it lies in front, and a ray that misses its piece
 * starts again from the rays beside it. All tasks that start on the same sub-patch form a group,
 * which lanes solve together, because they read the same coefficients. The hit of a ray depends on
 * the other rays only where it misses the piece at its point. */
#ifndef SHEEN_RENDER_NATIVE_RAYS_RAYS_H
#define SHEEN_RENDER_NATIVE_RAYS_RAYS_H

#include "server/base/error.h"
#include "server/render/native/tile.h"

struct native_device;

enum {
    RAYS_PX = 512,
    RAYS_AT_ONCE = RAYS_PX * NATIVE_MAX_RAYS,
    RAYS_END = 16 /* so that a whole vector may be read at the end */
};
enum { RAY_PATCHES = 4 * RAYS_AT_ONCE };

/* A place on a sub-patch: `index` as in patches.h; RAY_AT_VERTEX: beyond all levels of a CORNER. */
enum { RAY_AT_VERTEX = 0x8000 };
struct native_ray_place {
    uint32_t node;
    uint16_t index;
    float s, t;
};

/* A ray that starts at a place, near which a pixel is px units wide. */
struct native_ray_task {
    struct native_ray_place at;
    float px;
    uint32_t ray;
    const struct native_patch *patch; /* of the place; NULL: not known */
};

/* Tasks on one sub-patch: [first, first + n) of the sorted ones. */
struct native_ray_group {
    uint32_t node, first, n;
    uint16_t index;
    const struct native_patch *patch; /* NULL: the model does not keep it yet, or at a vertex */
};

/* A piece that rays may meet: nearness (0: none), an index of native_tile_room.local, and the place
 * on that piece (native_tile_room.place). One for each ray. */
struct native_ray_pieces {
    float nearness[RAYS_AT_ONCE + RAYS_END];
    int32_t piece[RAYS_AT_ONCE + RAYS_END], place[RAYS_AT_ONCE + RAYS_END];
};

/* Columns of a tile that are listed, 64 in a word; and squares of the tile in which any pixel is
 * listed. */
enum { RAY_ROW_WORDS = TILE_WIDTH / 64, RAY_SQUARE = 8, RAY_SQUARES = TILE_HEIGHT / RAY_SQUARE };

/* An entry of the hash table of sub-patches that rays have reached: the group of its tasks in
 * sorting number `sorting`. */
struct native_ray_patch {
    uint32_t node, sorting; /* sorting 0: unused */
    uint16_t index, group;
    const struct native_patch *patch; /* as in native_ray_group */
};

/* A thread's memory for RAYS_PX pixels. */
struct native_ray_room {
    uint32_t tile; /* the frame's tile in which the pixels lie */
    uint32_t n_pixels, n_rays, rays_per_px;
    /* A bit for each pixel of the tile, set if it is among those, and the first ray of each. */
    uint64_t listed[TILE_HEIGHT][RAY_ROW_WORDS];
    uint32_t squares[RAY_SQUARES]; /* of each row of squares, a bit for each column */
    uint16_t first_ray[TILE_PX];
    struct native_ray_pieces on;     /* the nearest piece that each ray's point lies on */
    struct native_ray_pieces beside; /* the nearest one beside it, which may bulge out to it */
    unsigned asks[RAYS_PX];          /* of each pixel, bit k: ray k has no hit and is tried again */
    /* For each ray: its pixel, px of the picture, and its offset from that pixel's centre. */
    float x[RAYS_AT_ONCE], y[RAYS_AT_ONCE];
    float off_x[RAYS_AT_ONCE + RAYS_END], off_y[RAYS_AT_ONCE + RAYS_END];
    /* The nearest hit of each ray, and its depth; RAYS_FARTHEST: none. */
    float z[RAYS_AT_ONCE];
    struct native_ray_place met[RAYS_AT_ONCE];
    struct native_ray_task task[RAYS_AT_ONCE];
    uint32_t n_tasks;
    /* The tasks sorted by sub-patch. */
    struct native_ray_group group[RAYS_AT_ONCE];
    uint32_t n_groups;
    uint16_t group_of[RAYS_AT_ONCE]; /* group of each task */
    float s[RAYS_AT_ONCE + RAYS_END], t[RAYS_AT_ONCE + RAYS_END], px[RAYS_AT_ONCE + RAYS_END];
    int32_t ray[RAYS_AT_ONCE + RAYS_END];
    struct native_ray_patch patch[RAY_PATCHES];
    uint32_t n_patches, sorting;
};
#define RAYS_FARTHEST 1e30f

/* Converts a place (x, y) of a node to its sub-patch. */
void native_ray_begin(const struct limit_node *node, double x, double y,
                      struct native_ray_place *place);
/* The part of a node with this index. */
struct native_part_of_node native_part_of_index(const struct limit_node *node, uint32_t index);

/* Forgets the patches of an earlier frame. */
void native_forget_ray_patches(struct native_ray_room *room);
/* Sorts room->task by sub-patch into room->group. */
void native_group_rays(const struct native_model *model, struct native_ray_room *room);
/* Sorts the rays of room->on by their pieces into room->group. Those on pieces that are not of one
 * sub-patch become tasks. */
void native_group_pieces(const struct native_frame *frame, struct native_tile_room *tile,
                         struct native_ray_room *room);
/* Adds a task for a ray at the place of one of `pieces`. */
void native_ray_start(const struct native_frame *frame, const struct native_tile_room *tile,
                      struct native_ray_room *room, const struct native_ray_pieces *pieces,
                      uint32_t ray);
/* The depth at a nearness, units. */
static inline float native_ray_depth(const struct native_rays *rays, float nearness)
{
    return rays->perspective ? rays->far / (1 + nearness) : rays->far - nearness;
}

/* A listed pixel (shaders/rounded.glsl), px of what is drawn. */
static inline uint32_t native_listed_x(uint32_t listed)
{
    return listed & 0xffff;
}

static inline uint32_t native_listed_y(uint32_t listed)
{
    return listed >> 16 & 0x7fff;
}

static inline bool native_listed_at_edge(uint32_t listed)
{
    return listed >> 31;
}

/* The frame's tile in which a listed pixel lies; *pixel: its place there, x + TILE_WIDTH y. */
uint32_t native_listed_tile(const struct native_frame *frame, uint32_t listed, uint32_t *pixel);

/* Sorts listed pixels by the picture's tiles, and within these by smaller squares; `tile` is what
 * is drawn. `room` is memory for n pixels. */
void native_sort_pixels(uint32_t *pixel, uint32_t n, const struct tile *tile, uint32_t *room);

/* Meets the rays of n pixels of one tile, at most RAYS_PX, from `first` on; thread->rays must
 * exist. False when memory is short. */
bool native_meet_pixels(const struct native_frame *frame, struct native_thread *thread,
                        const struct native_rounded *rounded, uint32_t first, uint32_t n);

/* The number of pixels that a thread takes at a time, of n; n_vertices: of the pieces in a tile of
 * the picture. */
uint32_t native_pixels_at_once(uint32_t n, unsigned threads, uint64_t n_vertices);
/* Meets the rays of pixels with the surface, by all threads. The device's last frame
 * (native_device_drawn) must be of what is drawn. Writes every hit. False with ERROR_SERVER when
 * memory is short. */
bool native_meet_rounded(struct native_device *device, const struct native_rounded *rounded,
                         struct error *error);

#endif
