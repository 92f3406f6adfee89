/* One finished frame in main memory: its planes, and what a device says about it. Any thread, one
 * at a time. */
#ifndef SHEEN_SCENE_FRAME_H
#define SHEEN_SCENE_FRAME_H

#include <stddef.h>

#include "server/base/block_cache.h"
#include "server/base/error.h"
#include "server/scene/frame_request.h"

/* The time that each stage took. Where renderer_info.timed_by_device: time of the device alone,
 * without what the processor did meanwhile; else by the clock, waiting for the device after each
 * stage. The readback is always by the clock. */
struct frame_times {
    uint64_t visibility_us, evaluate_us, shade_us, readback_us;
};

/* Planes are rows, top row first, tightly packed; NULL when not asked for. They belong to who has
 * the frame, who gives them back by frame_finish(). */
struct frame {
    uint32_t width_px, height_px;
    void *plane[PLANE_COUNT]; /* indexed by bit number */
    struct frame_times times;
    bool shows_surface; /* false: no pixel shows any of the model */
    /* With frame_request.count_light: how many pixels show surface at their centre, and on how many
     * of these the reflected ray meets a light. They are samples for a share, met_px / seen_px: all
     * pixels of tiles of fewer than 2^18, one in eight of larger tiles; and where no light can be
     * missed, nothing is counted and both get 1 for each tile that shows surface. */
    uint64_t seen_px, met_px;
    struct block_cache *block_cache; /* where the planes come from; NULL: malloc() */
};

/* Bytes of one pixel of a plane (a single bit). */
size_t frame_plane_bytes(enum frame_plane plane);

/* An empty frame with the planes that the request asks for, their contents undefined. ERROR_SERVER
 * when memory is short; the frame is all zero then. */
bool frame_init(struct frame *frame, const struct frame_request *request,
                struct block_cache *block_cache, struct error *error);
/* Gives the planes back; the frame is all zero then, which is safe to finish again. */
void frame_finish(struct frame *frame);

#endif
