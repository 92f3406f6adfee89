/* Between what stands in messages and what the renderer takes: cameras, lights, patterns, colours,
 * planes, errors. Pure, any thread. */
#ifndef SHEEN_SERVICE_WIRE_H
#define SHEEN_SERVICE_WIRE_H

#include "protocol/message.h"
#include "server/error.h"
#include "server/gpu/renderer.h"

/* A frame request from a message that has passed message_check_render(). What it leaves out comes
 * from the model's box; pattern.image is left to the caller. */
void wire_to_frame_request(const sheen_Render *render, const double box_min[3],
                           const double box_max[3], struct frame_request *request);

sheen_Camera wire_from_camera(const struct camera *camera);
sheen_Light wire_from_light(const struct light *light);
sheen_Vec3 wire_from_vec3(const double v[3]);
/* `asked` gives the image's hash. */
sheen_Pattern wire_from_pattern(const struct pattern *pattern, const sheen_Pattern *asked);

sheen_ErrorCode wire_error_code(enum error_kind kind);

/* Makes a text fit for the wire in place: what is not UTF-8 without control characters (names and
 * lines out of files may hold anything, and cutting may split a character) becomes '?'. */
void wire_make_text(char *text, bool lines);

/* 64 hexadecimal digits and a 0. */
void wire_hex(const uint8_t sha256[static MODEL_ID_BYTES], char hex[static 2 * MODEL_ID_BYTES + 1]);

#endif
