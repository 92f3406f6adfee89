/* Checks of single values in messages. */
#include <stdarg.h>
#include <stdio.h>

#include "protocol/messages/message_check.h"
#include "protocol/ranges.h"
#include "protocol/text.h"

bool check_refuse(char *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, MESSAGE_TEXT_BYTES, format, arguments);
    va_end(arguments);
    return false;
}

bool message_is_text(const char *text, bool lines)
{
    const unsigned char *c = (const unsigned char *)text;
    while (*c) {
        if ((*c < 0x20 && !(lines && *c == '\n')) || *c == 0x7f)
            return false;
        size_t n = text_utf8_length((const char *)c);
        if (n == 0)
            return false;
        c += n;
    }
    return true;
}

void message_make_text(char *text, bool lines)
{
    if (!message_is_text(text, lines))
        for (char *c = text; *c; c++)
            if ((*c < 0x20 && !(lines && *c == '\n')) || *c > 0x7e)
                *c = '?';
    char *to = text;
    for (const char *from = text; *from;) {
        size_t unseen = text_unseen_length(from);
        *to++ = unseen ? '?' : *from;
        from += unseen ? unseen : 1;
    }
    *to = 0;
}

bool check_text(const char *value, const char *field, char *text)
{
    return message_is_text(value, false) ||
           check_refuse(text, "%s is not UTF-8 text without control characters", field);
}

/* Writes, for example: "deadline_ms (--deadline) is 0; it must be from 1 to 3600000
 * milliseconds". */
bool check_named(double value, const struct range *range, const char *field, char *text)
{
    char wanted[RANGE_TEXT_BYTES];
    const char *option = range->option;
    return range_holds(range, value) ||
           check_refuse(text, "%s%s%s%s is %.9g; it must be %s", field, option ? " (" : "",
                        option ? option : "", option ? ")" : "", value, range_text(range, wanted));
}

bool check_number(double value, enum range_name name, char *text)
{
    return check_named(value, &RANGES[name], RANGES[name].field, text);
}

bool check_vec3(const sheen_Vec3 *v, const char *field, char *text)
{
    const double value[3] = {v->x, v->y, v->z};
    char name[64];
    for (int i = 0; i < 3; i++) {
        snprintf(name, sizeof name, "%s.%c", field, "xyz"[i]);
        if (!check_named(value[i], &RANGES[RANGE_COORDINATE], name, text))
            return false;
    }
    return true;
}

bool check_enum(unsigned value, unsigned last, const char *field, char *text)
{
    return value <= last ||
           check_refuse(text, "%s is %u; it must be from 0 to %u", field, value, last);
}

bool check_colour(const sheen_Colour *colour, const char *field, char *text)
{
    const float value[4] = {colour->r, colour->g, colour->b, colour->a};
    char name[64];
    for (int i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "%s.%c", field, "rgba"[i]);
        if (!check_named((double)value[i], &RANGES[RANGE_COLOUR], name, text))
            return false;
    }
    return true;
}

bool check_colours(const sheen_Colour *miss, const sheen_Colour *empty, const sheen_Colour *base,
                   char *text)
{
    return (!miss || check_colour(miss, "miss", text)) &&
           (!empty || check_colour(empty, "empty", text)) &&
           (!base || check_colour(base, "base", text));
}
