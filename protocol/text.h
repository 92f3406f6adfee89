/* Text from outside: UTF-8, and what of it may reach a terminal. Pure functions, any thread. */
#ifndef SHEEN_PROTOCOL_TEXT_H
#define SHEEN_PROTOCOL_TEXT_H

#include <stdarg.h>
#include <stddef.h>

/* Bytes of the UTF-8 character that begins at `text`, 1 to 4; 0 when it is malformed (an overlong
 * form, a surrogate, above U+10FFFF) or one of the control characters U+0080 to U+009F. Reads no
 * further than a 0. */
size_t text_utf8_length(const char *text);

/* Formats one line that quotes files and peers, cut to `size` bytes with its 0. A '?' stands for
 * each control character, each mark that turns the direction of text, and each byte that is not
 * UTF-8, so that the line is safe to show. */
void text_format_line(char *line, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

#endif
