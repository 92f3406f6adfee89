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

/* The part of request_check() that does not depend on a picture: checks camera, lines and the
 * places of the lights. False with ERROR_REQUEST; where camera or light were chosen by the model's
 * box, the error blames the model's size. */
bool request_check_view(const struct frame_request *request, struct error *error);

#endif
