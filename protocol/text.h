/* Text from outside: UTF-8, and what of it may reach a terminal. Pure functions, any thread. */
#ifndef SHEEN_PROTOCOL_TEXT_H
#define SHEEN_PROTOCOL_TEXT_H

#include <stdarg.h>
#include <stddef.h>

/* Bytes of the UTF-8 character that begins at `text`, 1 to 4; 0 when it is malformed (an overlong
 * form, a surrogate, above U+10FFFF) or one of the control characters U+0080 to U+009F. Reads no
 * further than a 0. */
size_t text_utf8_length(const char *text);

/* Bytes of the character that begins at `text`, if it is one that nobody sees, and that makes the text
 * around it look like another: the marks that turn the direction of text (U+061C, U+200E, U+200F,
 * U+202A to U+202E, U+2066 to U+2069), U+2028 and U+2029, which begin a new line, and the tags
 * U+E0000 to U+E007F. Else 0. Reads no further than a 0. */
size_t text_unseen_length(const char *text);

/* Formats one line that quotes files and peers, cut to `size` bytes with its 0. A '?' stands for
 * each control character, each unseen one, and each byte that is not
 * UTF-8, so that the line is safe to show. */
void text_format_line(char *line, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

#endif
