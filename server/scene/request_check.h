/* Checks whether a frame request can be rendered. Pure, any thread. */
#ifndef SHEEN_SCENE_REQUEST_CHECK_H
#define SHEEN_SCENE_REQUEST_CHECK_H

#include "server/base/error.h"
#include "server/scene/frame_request.h"

/* Checks every number of the request against its range (protocol/ranges.h), and its size against
 * the device's largest. False with ERROR_REQUEST, which names the field, its value and its
 * range. */
bool request_check(const struct frame_request *request, uint32_t max_width_px,
                   uint32_t max_height_px, struct error *error);

#endif
