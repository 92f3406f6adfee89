/* Converts between messages and the structs that a renderer takes: cameras, lights, patterns,
 * colours, planes. scene_read_...() reads a part of a message into a struct; scene_write_...()
 * makes a part of a message from a struct. Pure, any thread. */
#ifndef SHEEN_SCENE_SCENE_CONVERT_H
#define SHEEN_SCENE_SCENE_CONVERT_H

#include "protocol/messages/message.h"
#include "server/cage/cage.h"
#include "server/scene/frame_request.h"
#include "server/surface/tables.h"

/* The model of a request, for what the request leaves out. */
struct scene_subject {
    const struct limit_tables *tables;
    enum cage_up up; /* up direction from its file */
};

/* The model's up direction: the request's, else the file's, else guessed by the box. Returns
 * which. */
sheen_UpSource scene_model_up(const sheen_Render *render, const struct scene_subject *subject,
                              double up[3]);

/* Makes a frame request from a message that has passed message_check_render(). The caller sets the
 * images of patterns. */
void scene_read_request(const sheen_Render *render, const struct scene_subject *subject,
                        struct frame_request *request);

sheen_Camera scene_write_camera(const struct camera *camera);

/* Line families, lights and patterns (scene_convert_light.c). The box and `up` place lights without
 * a place of their own; `up` is the axis of line families without an axis. `asked` has an image's
 * hash; NULL: no image was requested. */
void scene_read_lines(const sheen_Lines *from, const double up[3], struct lines *to);
void scene_read_light(const sheen_Light *from, const struct scene_subject *subject,
                      const double up[3], struct light *to);
sheen_Lines scene_write_lines(const struct lines *lines);
sheen_Light scene_write_light(const struct light *light, const sheen_Light *asked);

#endif
