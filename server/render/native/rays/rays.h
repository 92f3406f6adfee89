/* Rays spread over pixels that one sample cannot show (shaders/rounded.glsl), and the places where they meet the
 * surface (shaders/rounded_solve.comp.glsl). Internal to the folder.
 *
 * A thread takes RAYS_PX pixels at a time. Their rays need places to start from: tasks. All tasks of these pixels
 * that start on the same sub-patch form a group, which lanes solve together, because they read the same coefficients.
 * The hit of a ray does not depend on the other rays. */
#ifndef SHEEN_RENDER_NATIVE_RAYS_RAYS_H
#define SHEEN_RENDER_NATIVE_RAYS_RAYS_H

#include "server/base/error.h"
#include "server/render/native/tile.h"

struct native_device;

enum { RAYS_PX = 512, RAYS_AT_ONCE = RAYS_PX * NATIVE_MAX_RAYS, RAYS_END = 16 /* a vector's */ };
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
};

/* Tasks on one sub-patch: [first, first + n) of the sorted ones. */
struct native_ray_group {
    uint32_t node, first, n;
    uint16_t index;
    const struct native_patch *patch; /* NULL: the model does not keep it yet, or at a vertex */
};

struct native_ray_pixel {
    uint32_t x, y; /* px of the tile */
    float front;   /* smallest depth of the pixels beside it; RAYS_FARTHEST: they show nothing */
    unsigned asks; /* number of rays that are not finished */
};

/* An entry of the hash table of sub-patches that rays have reached: the group of its tasks in sorting number
 * `sorting`. */
struct native_ray_patch {
    uint32_t node, sorting; /* sorting 0: unused */
    uint16_t index, group;
    const struct native_patch *patch; /* as in native_ray_group */
};

/* A thread's memory for RAYS_PX pixels. */
struct native_ray_room {
    struct native_ray_pixel pixel[RAYS_PX];
    uint32_t n_pixels, n_rays, rays_per_px;
    /* For each ray: its pixel, px of the picture, and its offset from that pixel's centre. */
    float x[RAYS_AT_ONCE], y[RAYS_AT_ONCE], off_x[RAYS_AT_ONCE], off_y[RAYS_AT_ONCE];
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
/* Sorts room->task by sub-patch. */
void native_group_rays(const struct native_model *model, struct native_ray_room *room);

/* Sorts listed pixels by squares of the picture, so that pixels that are met together lie near each other. `room` is
 * memory for n pixels. */
void native_sort_pixels(uint32_t *pixel, uint32_t n, uint32_t *room);

/* Meets the rays of n pixels, at most RAYS_PX, from `first` on; thread->rays must exist. */
void native_meet_pixels(const struct native_frame *frame, struct native_thread *thread,
                        const struct native_rounded *rounded, uint32_t first, uint32_t n);

/* Meets the rays of pixels with the surface, by all threads. `planes` are those that native_draw() found for the same
 * view and tile, with `node` UINT32_MAX where nothing is met. Writes every hit. False with ERROR_SERVER when memory
 * is short. */
bool native_meet_rounded(struct native_device *device, struct native_model *model,
                         const struct view *view, const struct tile *tile,
                         const struct native_planes *planes, const struct native_rounded *rounded,
                         struct error *error);

#endif
