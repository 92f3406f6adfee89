/* Which view the planes of a target hold, so that a later frame of the same view needs only stage 3.
 * Plain data; any thread. */
#ifndef SHEEN_RENDER_KEPT_VIEW_H
#define SHEEN_RENDER_KEPT_VIEW_H

#include "server/scene/frame_request.h"

struct kept_view {
    uint64_t model_serial; /* 0: the planes hold nothing */
    uint32_t width_px, height_px;
    struct camera camera;
    struct surface surface;
    bool ptex;    /* the Ptex plane is there */
    bool edges;   /* coverage is there, with the lists of pixels that are shaded anew */
    bool any_cut; /* the planes are the same, bit by bit, for any cut into tiles, so they serve
                     frames of any cut */
};

/* The view of planes that have been drawn for this request. */
struct kept_view kept_view_of(uint64_t model_serial, const struct frame_request *request);
/* Do the planes hold all that stages 1 and 2 would draw for this request? */
bool kept_view_serves(const struct kept_view *kept, uint64_t model_serial,
                      const struct frame_request *request);

/* Frames of few pixels, such as thumbnails and probes, have planes of their own: they must not
 * overwrite the planes of a larger view. */
bool kept_view_is_small(const struct frame_request *request);

#endif
