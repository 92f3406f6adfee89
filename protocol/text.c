#include "protocol/text.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

size_t text_utf8_length(const char *text)
{
    const unsigned char *c = (const unsigned char *)text;
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    if (*c < 0x80)
        return 1;
    size_t n = *c >= 0xf0 && *c < 0xf8 ? 4 : *c >= 0xe0 ? 3 : *c >= 0xc0 ? 2 : 0;
    if (n == 0 || *c >= 0xf8)
        return 0;
    uint32_t code = *c & (0xffu >> (n + 1));
    for (size_t i = 1; i < n; i++) {
        if ((c[i] & 0xc0) != 0x80)
            return 0;
        code = code << 6 | (c[i] & 0x3f);
    }
    bool surrogate = code >= 0xd800 && code < 0xe000;
    bool c1_control = code < 0xa0;
    return code < least[n] || code > 0x10ffff || surrogate || c1_control ? 0 : n;
}

size_t text_unseen_length(const char *text)
{
    static const char marks[][4] = {
        "\u061c", "\u200e", "\u200f", "\u202a", "\u202b", "\u202c", "\u202d",
        "\u202e", "\u2028", "\u2029", "\u2066", "\u2067", "\u2068", "\u2069",
    };
    for (size_t i = 0; i < sizeof(marks) / sizeof(*marks); i++)
        if (strncmp(text, marks[i], strlen(marks[i])) == 0)
            return strlen(marks[i]);
    const unsigned char *c = (const unsigned char *)text; /* F3 A0 80 80 to F3 A0 81 BF */
    bool is_tag = c[0] == 0xf3 && c[1] == 0xa0 && (c[2] & 0xfe) == 0x80 && (c[3] & 0xc0) == 0x80;
    return is_tag ? 4 : 0;
}

static void hide_controls(char *text)
{
    char *to = text;
    for (const char *from = text; *from;) {
        size_t length = text_utf8_length(from);
        bool c1_control = from[0] == '\xc2' && ((unsigned char)from[1] & 0xe0) == 0x80;
        bool shown = length > 0 && (unsigned char)*from >= 0x20 && *from != 0x7f &&
                     text_unseen_length(from) == 0;
        size_t n = length > 0 ? length : c1_control ? 2 : 1;
        if (shown)
            memmove(to, from, n);
        else
            *to = '?';
        to += shown ? n : 1;
        from += n;
    }
    *to = 0;
}

void text_format_line(char *line, size_t size, const char *format, va_list arguments)
{
    vsnprintf(line, size, format, arguments);
    hide_controls(line);
}
