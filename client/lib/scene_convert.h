/* Line families, lights and patterns between libsheen's structs and messages. Pure, any thread. */
#ifndef SHEEN_CLIENT_SCENE_CONVERT_H
#define SHEEN_CLIENT_SCENE_CONVERT_H

#include "client/lib/sheen.h"
#include "protocol/message.h"

sheen_Vec3 message_vec3(const double v[3]);
void message_get_vec3(double v[3], const sheen_Vec3 *message);
sheen_Colour message_colour(const float c[4]);

/* Fills in lines, lights and false colour. More places of lines than a message carries are left
 * out, and what is left is refused by message_check_render() like any other bad number. */
void lights_to_message(sheen_Render *render, const struct sheen_request *request);

/* Fills in the frame's lines, lights and false colour, as used. */
void lights_from_message(struct sheen_frame *frame, const sheen_Frame *body);

#endif
