/* Scenes between libsheen's structs and messages: camera, lines, lights, patterns, false colour.
 * Pure, any thread. */
#ifndef SHEEN_CLIENT_SCENE_CONVERT_H
#define SHEEN_CLIENT_SCENE_CONVERT_H

#include "client/lib/sheen.h"
#include "protocol/message.h"

/* Fills in all of the request. More places of lines than a message carries are left out, and what
 * is left is refused by message_check_render() like any other bad number. */
void scene_to_message(sheen_Render *render, const struct sheen_request *request);

/* Fills in what the frame shows, as used: camera, up, lines, lights, colours and false colour. */
void scene_from_message(struct sheen_frame *frame, const sheen_Frame *body);

#endif
