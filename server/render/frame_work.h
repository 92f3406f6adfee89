/* The state of a frame while it is drawn: what the caller fills in, and what each step reports. */
#ifndef SHEEN_RENDER_FRAME_WORK_H
#define SHEEN_RENDER_FRAME_WORK_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/frame_watch.h"
#include "server/scene/frame_request.h"

struct renderer_polygons;
struct frame_state;

/* A step draws one tile, so that the render thread can draw other frames in between; of polygons it
 * draws a part of a tile, and putting them on the device takes several steps, too. Fill in the
 * first group, call renderer_begin(), then renderer_step() as long as it returns FRAME_MORE,
 * FRAME_POLYGONS or FRAME_PROGRAMS. */
struct frame_work {
    const struct frame_request *request; /* must stay valid until the last step, like the model */
    /* Largest number of pixels of a tile; 0: as many as possible. */
    uint64_t tile_px;
    /* Exact frame in tiles: the pixels must equal those of one tile, bit by bit, and the planes are
     * kept, which are then as large as the picture. renderer_begin() clears in_place if the device
     * does not have images of that size. */
    bool in_place;
    struct frame_watch watch;
    uint64_t asker; /* whose frame it is: the device prepares for different askers in turns */
    struct renderer_polygons *polygons; /* set after FRAME_POLYGONS; NULL before */

    /* The rest belongs to the renderer. */
    /* The last step drew a tile or a part of one; false: it prepared the device, so its time tells
     * nothing about tiles. */
    bool has_drawn;
    /* The device's state, from renderer_begin() to the last step; NULL: none. */
    struct frame_state *state;
};

enum frame_step {
    FRAME_MORE, /* more steps follow */
    /* The device does not have the polygons for the request: set frame_work.polygons and continue.
     * Making them takes as long as many tiles. */
    FRAME_POLYGONS,
    /* The device is preparing for the frame, which takes as long as many tiles: continue when
     * renderer_options.woken has been called. Other frames can be drawn meanwhile. */
    FRAME_PROGRAMS,
    FRAME_DONE, /* the frame is complete */
    /* *error has the reason; ERROR_GPU_LOST: the frame may be requested again. The frame is
     * empty. */
    FRAME_FAILED,
};

#endif
