#include "server/base/quote.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "protocol/text.h"

/* Writes a character of 2 to 4 bytes in UTF-16, as JSON's \u escapes. */
static void escape_utf16(const char *text, size_t n, char *escaped)
{
    uint32_t code = (unsigned char)text[0] & (0xffu >> (n + 1));
    for (size_t i = 1; i < n; i++)
        code = code << 6 | ((unsigned char)text[i] & 0x3f);
    if (code < 0x10000)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\u%04x", (unsigned)code);
    else
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\u%04x\\u%04x",
                 (unsigned)(0xd7c0 + (code >> 10)) & 0xffff, (unsigned)(0xdc00 + (code & 0x3ff)));
}

size_t quote_character(enum quote_form form, const char *text,
                       char escaped[static QUOTE_CHARACTER_BYTES])
{
    const unsigned char c = (unsigned char)*text;
    const bool is_control = c < 0x20 || c == 0x7f;
    const size_t n = text_utf8_length(text), unseen = text_unseen_length(text);
    if (unseen && form == QUOTE_JSON)
        escape_utf16(text, unseen, escaped);
    else if (unseen)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "?");
    else if (c == '"' || c == '\\')
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\%c", c);
    else if (is_control && form == QUOTE_JSON)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\u%04x", (unsigned)c);
    else if (is_control)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "%s", c == '\n' ? "\\n" : "?");
    else
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "%.*s", n ? (int)n : 1, n ? text : "?");
    return n && !is_control ? n : 1;
}
