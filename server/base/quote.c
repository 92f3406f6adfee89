#include "server/base/quote.h"

#include <stdbool.h>
#include <stdio.h>

#include "protocol/text.h"

size_t quote_character(enum quote_form form, const char *text,
                       char escaped[static QUOTE_CHARACTER_BYTES])
{
    const unsigned char c = (unsigned char)*text;
    const bool is_control = c < 0x20 || c == 0x7f;
    const size_t n = text_utf8_length(text);
    if (c == '"' || c == '\\')
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\%c", c);
    else if (is_control && form == QUOTE_JSON)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "\\u%04x", (unsigned)c);
    else if (is_control)
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "%s", c == '\n' ? "\\n" : "?");
    else
        snprintf(escaped, QUOTE_CHARACTER_BYTES, "%.*s", n ? (int)n : 1, n ? text : "?");
    return n && !is_control ? n : 1;
}
