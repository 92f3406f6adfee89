/* Conversions that client and daemon share: vectors, colours, and the numbers of patterns, between
 * messages and their own structs. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_VALUES_H
#define SHEEN_PROTOCOL_MESSAGE_VALUES_H

#include "protocol/messages/message.h"

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

/* Initializers: of a sheen_Pattern from a struct whose members have the same names, and of such a
 * struct from a sheen_Pattern. Add a new number of patterns to both. */
#define MESSAGE_PATTERN_NUMBERS(pattern)                                                           \
    .has_count = true, .count = (pattern)->count, .has_period = (pattern)->period != 0,            \
    .period = (pattern)->period, .has_duty = true, .duty = (pattern)->duty,                        \
    .has_rotation_deg = true, .rotation_deg = (pattern)->rotation_deg, .has_offset = true,         \
    .offset = (pattern)->offset, .has_soft = true, .soft = (pattern)->soft, .has_opacity = true,   \
    .opacity = (pattern)->opacity, .width = (pattern)->width
#define MESSAGE_PATTERN_NUMBERS_OF(message)                                                        \
    .count = (message)->count, .period = (message)->has_period ? (message)->period : 0,            \
    .duty = (message)->duty, .rotation_deg = (message)->rotation_deg, .offset = (message)->offset, \
    .soft = (message)->soft, .opacity = (message)->opacity, .n_at = (message)->at_count,           \
    .width = (message)->width

#endif
