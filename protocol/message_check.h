/* Checks of parts of messages that the files message_check*.c share. Private to them. They return false and write one
 * line to `text` (MESSAGE_TEXT_BYTES), which names the field. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_MESSAGE_CHECK_H
#define SHEEN_PROTOCOL_MESSAGE_CHECK_H

#include "protocol/message.h"
#include "protocol/ranges.h"

/* Writes the line and returns false. */
bool check_refuse(char *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* UTF-8 without control characters. */
bool check_text(const char *value, const char *field, char *text);
/* The number is in its range. */
bool check_number(double value, enum range_name name, char *text);
/* Camera, lines and lights of an answer, which has all fields. */
bool check_whole_scene(const sheen_Camera *camera, const sheen_Lines *lines,
                       const sheen_Light *lights, size_t n, char *text);

/* The answer BREAKS (message_check_numbers.c). */
bool check_breaks(const sheen_Breaks *breaks, char *text);
/* The answer COMPARED. */
bool check_compared(const sheen_Compared *compared, char *text);
/* The answer CURVES. */
bool check_curves(const sheen_Curves *curves, char *text);

#endif
