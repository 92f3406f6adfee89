/* How frames are cut into tiles: by what their pixels cost, so that no tile keeps other clients waiting
 * for long. The cost is the number of pixels times fixed weights of the lights, their patterns and the kind of
 * device. It is not measured at run time, so that equal requests give equal bytes.
 *
 * Pure. Thread: any. */
#ifndef SHEEN_FRAME_CUT_H
#define SHEEN_FRAME_CUT_H

#include "protocol/messages/message.h"

struct cut {
    uint64_t tile_px; /* most pixels of one tile; 0: the frame is drawn whole */
    /* The value for frame_work.in_place: tiles of the exact surface are the same, bit by bit, as the frame drawn
     * whole (renderer.h names the exceptions, which clear kept_view.any_cut), and their planes are kept for later
     * frames of the same view. Tiles of polygons differ from the whole frame by rounding and are not kept, whatever
     * in_place says; so cut_frame() leaves interactive frames of polygons whole where in_place is true. */
    bool in_place;
};

/* The members of renderer_info on which the cut depends. */
struct cut_device {
    bool software;
    unsigned n_threads; /* of the native device, else 0; decides only where the cut is in_place */
};

struct cut cut_frame(const sheen_Render *render, const struct cut_device *device);

#endif
