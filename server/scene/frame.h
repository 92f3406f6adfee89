/* A frame in main memory: its planes, and what the device reports about it.
 * Thread: one at a time. */
#ifndef SHEEN_SCENE_FRAME_H
#define SHEEN_SCENE_FRAME_H

#include <stddef.h>

#include "server/base/block_cache.h"
#include "server/base/error.h"
#include "server/scene/frame_request.h"

/* The time of each stage in microseconds. If renderer_info.timed_by_device: the device's own time,
 * without what the processor did meanwhile; else by the clock, waiting for the device after each
 * stage. The readback is always measured by the clock. */
struct frame_times {
    uint64_t visibility_us, evaluate_us, shade_us, readback_us;
};

/* A plane consists of contiguous rows, top row first; NULL if it was not requested. The frame owns
 * its planes until frame_finish(). */
struct frame {
    uint32_t width_px, height_px;
    void *plane[PLANE_COUNT]; /* indexed by bit number */
    struct frame_times times;
    bool shows_surface; /* false: no pixel shows the model */
    /* Only with frame_request.count_light: the number of pixels whose centre shows the surface, and
     * the number of those whose ray meets a light. Only their ratio met_px / seen_px has a meaning:
     * in tiles of 2^18 pixels and more, one pixel of eight is counted. If no light can be missed,
     * nothing is counted, and each tile that shows the surface adds 1 to both. */
    uint64_t seen_px, met_px;
    struct block_cache *block_cache; /* memory of the planes; NULL: malloc() */
};

/* Bytes of one pixel of a plane; `plane` is a single bit. */
size_t frame_plane_bytes(enum frame_plane plane);

/* Allocates the planes that the request asks for; their contents are undefined. False with
 * ERROR_SERVER when memory is short; the frame is then all zero. */
bool frame_init(struct frame *frame, const struct frame_request *request,
                struct block_cache *block_cache, struct error *error);
/* Frees the planes and zeroes the frame; safe to call again. */
void frame_finish(struct frame *frame);

#endif
