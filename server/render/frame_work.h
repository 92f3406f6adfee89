/* A frame in the making: what whoever asks for it fills in, and what each of its steps tells. */
#ifndef SHEEN_RENDER_FRAME_WORK_H
#define SHEEN_RENDER_FRAME_WORK_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/frame_watch.h"
#include "server/scene/frame_request.h"

struct renderer_polygons;
struct frame_state;

/* One tile a step, so that the render thread can turn to other frames in
 * between; of polygons a step is a part of a tile, and the device takes them in several steps, too.
 * Fill in the first group and call renderer_begin(), then renderer_step() for as long as it says
 * FRAME_MORE or FRAME_POLYGONS. */
struct frame_work {
    const struct frame_request *request; /* stays until the last step, as the model does */
    uint64_t tile_px;                    /* most pixels of one tile; 0: as many as fit at once */
    bool in_place; /* of an exact frame in tiles: its pixels must be those of one tile, bit by bit,
                      and its planes are kept. They are then as large as the whole picture;
                      renderer_begin() clears in_place where the device has no such images */
    struct frame_watch watch;
    struct renderer_polygons *polygons; /* for after FRAME_POLYGONS; NULL until then */

    /* The renderer's from here on. */
    bool has_drawn; /* the last step drew a tile or a part of one; else it made the device ready for
                       it, which tells nothing about the time that tiles take */
    struct frame_state *state; /* the device's, from begin to the last step; NULL: none */
};

enum frame_step {
    FRAME_MORE, /* steps are left */
    /* The device has no polygons for the request's surface, or no longer: set frame_work.polygons
     * and go on. Making them takes as long as many tiles. */
    FRAME_POLYGONS,
    FRAME_DONE,   /* the frame is whole */
    FRAME_FAILED, /* *error says why; ERROR_GPU_LOST: ask again. The frame is empty */
};

#endif
