/* Vectors and colours of messages from and to arrays. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_VALUES_H
#define SHEEN_PROTOCOL_MESSAGE_VALUES_H

#include "protocol/message.h"

static inline sheen_Vec3 message_vec3(const double v[3])
{
    return (sheen_Vec3){v[0], v[1], v[2]};
}

static inline void message_read_vec3(const sheen_Vec3 *from, double to[3])
{
    to[0] = from->x;
    to[1] = from->y;
    to[2] = from->z;
}

static inline sheen_Colour message_colour(const float c[4])
{
    return (sheen_Colour){c[0], c[1], c[2], c[3]};
}

static inline void message_read_colour(const sheen_Colour *from, float to[4])
{
    to[0] = from->r;
    to[1] = from->g;
    to[2] = from->b;
    to[3] = from->a;
}

#endif
