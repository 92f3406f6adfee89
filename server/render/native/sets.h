/* The instruction sets that lanes/ is compiled for, and what each has to offer. */
#ifndef SHEEN_RENDER_NATIVE_SETS_H
#define SHEEN_RENDER_NATIVE_SETS_H

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
    const char *name;  /* as an option says it */
    const char *words; /* as people read it */
    int lanes;
    struct native_programs programs;
    /* The pieces of a part of the model, and the tiles that they lie in. */
    void (*pieces)(struct native_frame *frame, struct native_thread *thread, uint32_t part);
    /* The planes of a tile, but for pixels in gaps. */
    void (*tile)(struct native_frame *frame, struct native_thread *thread, uint32_t tile);
    /* After all tiles, by one thread: the pixels in gaps. */
    void (*gaps)(struct native_frame *frame, struct native_thread *thread);
    /* Groups of pixels in some rows: lanes/entries.h. */
    uint32_t (*groups)(const struct native_seen *seen, uint32_t first, uint32_t end, float *columns,
                       uint32_t *groups);
    /* Meets the rays of room->task with the surface, and leaves no task; what each meets in front of what its ray has met
     * is kept in room->met. */
    void (*meet_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                      struct native_ray_room *room);
    /* Writes of every ray of room->task what lies at the place where it begins: RoundedHit of shaders/rounded.glsl. */
    void (*describe_rays)(const struct native_frame *frame, struct native_tile_room *tile,
                          struct native_ray_room *room, float (*hit)[HIT_WORDS]);
    /* Of polygons (polygons/fill.h): the triangles of the slice's part of that number, and the tiles that they lie in. */
    void (*place)(struct native_slice *slice, struct native_polygon_thread *thread, uint32_t part);
    /* Draws what has been placed in a tile. */
    void (*triangles)(struct native_slice *slice, uint32_t tile);
};

/* The set of that name, or the widest that the processor has; NULL where it has not. Any thread. */
const struct native_set *native_set_find(const char *name);
/* The k-th set that the processor has, narrowest first; NULL from the last one on. */
const struct native_set *native_set_at(unsigned k);

#endif
