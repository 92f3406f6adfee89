/* The instruction sets for which lanes/ is compiled, with the functions of each. */
#ifndef SHEEN_RENDER_NATIVE_SETS_H
#define SHEEN_RENDER_NATIVE_SETS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/native/planes.h"
#include "server/render/native/programs/program.h"

struct native_frame;
struct native_polygon_thread;
struct native_ray_room; /* rays/rays.h */
struct native_slice;
struct native_thread;
struct native_tile_room; /* tile.h */

struct native_set {
    const char *name;  /* name in options */
    const char *words; /* name for people */
    int lanes;
    struct native_programs programs;
    /* Makes the pieces of a part of the model, and lists them in the tiles that they touch. */
    void (*pieces)(struct native_frame *frame, struct native_thread *thread, uint32_t part);
    /* tile: computes the planes of a tile, except for pixels in gaps; gaps: computes these after
     * all tiles, on one thread. */
    void (*tile)(struct native_frame *frame, struct native_thread *thread, uint32_t tile);
    void (*gaps)(struct native_frame *frame, struct native_thread *thread);
    uint32_t (*groups)(const struct native_seen *seen, uint32_t first, uint32_t end, float *columns,
                       uint32_t *groups);
    /* Finds the pieces that the room's rays may meet: room->on and room->beside. False when memory
     * is short. */
    bool (*see_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                     struct native_ray_room *room);
    /* Meets the rays of room->group and of room->task with the surface and removes both. A hit in
     * front of a ray's earlier hit is kept in room->met. */
    void (*meet_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                      struct native_ray_room *room);
    /* Writes for every ray of room->task a description of the place where it starts: RoundedHit of
     * shaders/rounded.glsl. */
    void (*describe_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                          struct native_ray_room *room, float (*hit)[HIT_WORDS]);
    /* Polygons (polygons/fill.h): places the triangles of one part of the slice, and lists them in
     * their tiles. */
    void (*place)(struct native_slice *slice, struct native_polygon_thread *thread, uint32_t part);
    void (*triangles)(struct native_slice *slice, uint32_t tile); /* draws those placed in a tile */
};

/* The set with this name, or (NULL) the best of the processor; NULL if the processor does not have
 * it. Any thread. */
const struct native_set *native_set_find(const char *name);
/* The k-th set of the processor, the narrowest first; NULL after the last one. */
const struct native_set *native_set_at(unsigned k);

#endif
