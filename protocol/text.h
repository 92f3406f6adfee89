/* Checks text from outside: valid UTF-8, and characters that must not reach a terminal. Pure, any
 * thread. */
#ifndef SHEEN_PROTOCOL_TEXT_H
#define SHEEN_PROTOCOL_TEXT_H

#include <stdarg.h>
#include <stddef.h>

/* The length in bytes, 1 to 4, of the UTF-8 character at `text`; 0 if it is malformed (an overlong
 * form, a surrogate, above U+10FFFF) or one of the control characters U+0080 to U+009F. Reads no
 * further than a 0. */
size_t text_utf8_length(const char *text);

/* The length in bytes of the character at `text` if it is invisible and can make the text around it
 * look different: marks of text direction (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to
 * U+2069), line breaks (U+2028, U+2029), and tags (U+E0000 to U+E007F). Else 0. Reads no further
 * than a 0. */
size_t text_unseen_length(const char *text);

/* Formats one line that may quote files and peers, cut to `size` bytes with its 0. Each control
 * character, each invisible character and each byte that is not UTF-8 becomes '?', so that the line
 * can be shown safely. */
void text_format_line(char *line, size_t size, const char *format, va_list arguments)
    __attribute__((format(printf, 3, 0)));

#endif
