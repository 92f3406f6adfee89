/* Between what stands in messages and what the renderer takes: cameras, lights, patterns, colours,
 * planes, errors. Pure, any thread. */
#ifndef SHEEN_SERVICE_WIRE_H
#define SHEEN_SERVICE_WIRE_H

#include "protocol/message.h"
#include "server/error.h"
#include "server/gpu/renderer.h"
#include "server/service/scheduler.h"

/* A frame request from a message that has passed message_check_render(). What it leaves out comes
 * from the model's box; the patterns' images are left to the caller. */
void wire_to_frame_request(const sheen_Render *render, const double box_min[3],
                           const double box_max[3], struct frame_request *request);

sheen_Camera wire_from_camera(const struct camera *camera);
sheen_Vec3 wire_from_vec3(const double v[3]);
sheen_Colour wire_from_colour(const float c[4]);
void wire_to_vec3(const sheen_Vec3 *from, double to[3]);
void wire_to_colour(const sheen_Colour *from, float to[4]);

/* Line families, lights and patterns (wire_light.c). `camera` and the box place lights that have
 * no place of their own. `asked` gives an image's hash; NULL: nothing was asked for. */
void wire_to_lines(const sheen_Lines *from, struct lines *to);
void wire_to_light(const sheen_Light *from, const double box_min[3], const double box_max[3],
                   const struct camera *camera, struct light *to);
sheen_Lines wire_from_lines(const struct lines *lines);
sheen_Light wire_from_light(const struct light *light, const sheen_Light *asked);

enum request_class wire_request_class(sheen_RequestClass request_class);

sheen_ErrorCode wire_error_code(enum error_kind kind);

/* Makes a text fit for the wire in place: what is not UTF-8 without control characters (names and
 * lines out of files may hold anything, and cutting may split a character) becomes '?'. */
void wire_make_text(char *text, bool lines);

/* 64 hexadecimal digits and a 0. */
void wire_hex(const uint8_t sha256[static MODEL_ID_BYTES], char hex[static 2 * MODEL_ID_BYTES + 1]);

#endif
