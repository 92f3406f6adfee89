/* How frames are cut into tiles: by what their pixels cost, so that no tile keeps other clients waiting
 * for long. The cost is pixels times fixed weights of the lights, their patterns and the kind of device. It is
 * never measured, so that equal requests give equal bytes.
 *
 * Pure. Thread: any. */
#ifndef SHEEN_FRAME_CUT_H
#define SHEEN_FRAME_CUT_H

#include "protocol/message.h"

struct cut {
    uint64_t tile_px; /* most pixels of one tile; 0: the frame is drawn whole */
    /* The frame is the same, bit by bit, as if drawn whole, and its planes are kept for later frames
     * of the same view. */
    bool in_place;
};

/* What of a device decides: as renderer_info has it. */
struct cut_device {
    bool software;
    unsigned n_threads; /* of the native device, else 0 */
};

struct cut cut_frame(const sheen_Render *render, const struct cut_device *device);

#endif
