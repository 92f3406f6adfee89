/* Which view the planes of a target hold. Stages 1 (visibility) and 2 (evaluate) fill these planes, so a
 * later frame of the same view needs only stage 3 (shade). Plain data; any thread. */
#ifndef SHEEN_RENDER_KEPT_VIEW_H
#define SHEEN_RENDER_KEPT_VIEW_H

#include "server/scene/frame_request.h"

struct kept_view {
    uint64_t model_serial; /* 0: the planes hold nothing */
    uint32_t width_px, height_px;
    struct camera camera;
    struct surface surface;
    bool ptex;  /* the Ptex plane is there */
    bool edges; /* coverage is there, with the lists of pixels that are shaded anew */
    /* The planes are the same, bit by bit, whether the frame is drawn whole or in tiles in_place
     * (frame_work.in_place). False: they serve only frames that are cut as theirs was. */
    bool any_cut;
};

/* The view of planes that have been drawn for this request. any_cut is true for the exact surface and
 * false for polygons; a device clears it where the exceptions of renderer_step() apply. */
struct kept_view kept_view_of(uint64_t model_serial, const struct frame_request *request);
/* True if the planes hold all that stages 1 and 2 would draw for this request. Ignores any_cut: the
 * caller checks whether the frame is cut as the planes were, or else any_cut. */
bool kept_view_serves(const struct kept_view *kept, uint64_t model_serial,
                      const struct frame_request *request);

/* True for frames of fewer than 4,096 pixels, such as thumbnails and probes. They have planes of their
 * own, so that they do not overwrite the planes of a larger view. */
bool kept_view_is_small(const struct frame_request *request);

#endif
