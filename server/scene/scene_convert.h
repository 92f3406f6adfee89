/* Between what stands in messages and what the renderer takes: cameras, lights, patterns, colours,
 * planes, errors. Pure, any thread. */
#ifndef SHEEN_SCENE_SCENE_CONVERT_H
#define SHEEN_SCENE_SCENE_CONVERT_H

#include "protocol/message.h"
#include "server/base/error.h"
#include "server/frame/scheduler.h"
#include "server/scene/frame_request.h"
#include "server/surface/tables.h"

/* The model that a request is about, for what the request leaves out. */
struct wire_subject {
    const struct limit_tables *tables;
    enum cage_up up; /* as its file says */
};

/* Which way is up: as the request says, else as the file does, else as the box looks. */
sheen_UpSource wire_model_up(const sheen_Render *render, const struct wire_subject *subject,
                             double up[3]);

/* A frame request from a message that has passed message_check_render(). The patterns' images are
 * left to the caller. */
void wire_to_frame_request(const sheen_Render *render, const struct wire_subject *subject,
                           struct frame_request *request);

sheen_Camera wire_from_camera(const struct camera *camera);
sheen_Vec3 wire_from_vec3(const double v[3]);
sheen_Colour wire_from_colour(const float c[4]);
void wire_to_vec3(const sheen_Vec3 *from, double to[3]);
void wire_to_colour(const sheen_Colour *from, float to[4]);

/* Line families, lights and patterns (wire_light.c). The box and `up` place lights that have no
 * place of their own, and `up` is the axis of families that are told none. `asked` gives an image's
 * hash; NULL: nothing was asked for. */
void wire_to_lines(const sheen_Lines *from, const double up[3], struct lines *to);
void wire_to_light(const sheen_Light *from, const struct wire_subject *subject, const double up[3],
                   struct light *to);
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
