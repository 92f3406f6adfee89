/* Checks of parts of messages that the files message_check*.c share. Private to them. They return false and write one
 * line to `text` (MESSAGE_TEXT_BYTES), which names the field. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_CHECK_H
#define SHEEN_PROTOCOL_MESSAGE_CHECK_H

#include "protocol/messages/message.h"
#include "protocol/ranges.h"

/* Writes the line and returns false. */
bool check_refuse(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* UTF-8 without control characters. */
bool check_text(const char *value, const char *field, char *text);
/* The number is in its range; the line names the range's field, or this one. */
bool check_number(double value, enum range_name name, char *text);
bool check_named(double value, const struct range *range, const char *field, char *text);
/* Each coordinate is in its range. */
bool check_vec3(const sheen_Vec3 *v, const char *field, char *text);
/* As check_vec3(), and not zero. */
bool check_direction(const sheen_Vec3 *v, const char *field, char *text);
/* 0 to last. */
bool check_enum(unsigned value, unsigned last, const char *field, char *text);
bool check_colour(const sheen_Colour *colour, const char *field, char *text);
/* Colours that are absent are NULL. */
bool check_colours(const sheen_Colour *miss, const sheen_Colour *empty, const sheen_Colour *base,
                   char *text);

/* A camera (message_check_scene.c), of which any part may be absent. */
bool check_camera(const sheen_Camera *camera, char *text);
/* Lines with n lights, whose places may be absent. */
bool check_lights(const sheen_Lines *lines, const sheen_Light *lights, size_t n, char *text);
/* Camera, lines and lights of an answer, which has all fields. */
bool check_whole_scene(const sheen_Camera *camera, const sheen_Lines *lines,
                       const sheen_Light *lights, size_t n, char *text);

/* The planes suit the encoding (message_check_render.c). */
bool check_planes(uint32_t planes, unsigned encoding, char *text);

/* The answer BREAKS (message_check_numbers.c). */
bool check_breaks(const sheen_Breaks *breaks, char *text);
/* The answer COMPARED. */
bool check_compared(const sheen_Compared *compared, char *text);
/* The answer CURVES. */
bool check_curves(const sheen_Curves *curves, char *text);

#endif
