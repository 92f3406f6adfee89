/* Converts scenes between libsheen's structs and messages: camera, lines, lights, patterns, false
 * colour. Pure, any thread. */
#ifndef SHEEN_CLIENT_SCENE_CONVERT_H
#define SHEEN_CLIENT_SCENE_CONVERT_H

#include "client/lib/sheen.h"
#include "protocol/messages/message.h"

/* Fills in the whole message. If a pattern has more lines than a message can carry, the rest is
 * dropped, and message_check_render() refuses the message by its number of lines. */
void scene_to_message(sheen_Render *render, const struct sheen_request *request);

/* Fills in the parts of the frame that the daemon used: camera, up, lines, lights, colours and
 * false colour. */
void scene_from_message(struct sheen_frame *frame, const sheen_Frame *body);

/* The same for other answers. */
void scene_camera_from_message(struct sheen_camera *to, const sheen_Camera *camera);
void scene_lines_from_message(struct sheen_lines *to, const sheen_Lines *lines);
void scene_light_from_message(struct sheen_light *to, const sheen_Light *from);

#endif
