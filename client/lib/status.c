#include "client/lib/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "protocol/message.h"

int sheen_status_exit_code(enum sheen_status status)
{
    switch (status) {
    case SHEEN_OK:
        return 0;
    case SHEEN_BAD_ARGUMENT:
    case SHEEN_BAD_REQUEST:
        return 2;
    case SHEEN_BAD_MODEL:
    case SHEEN_BAD_IMAGE:
    case SHEEN_TOO_BIG:
        return 3;
    case SHEEN_DEVICE_FAILED:
        return 5;
    default:
        return 4;
    }
}

bool sheen_status_is_fatal(enum sheen_status status)
{
    switch (status) {
    case SHEEN_SHUTTING_DOWN:
    case SHEEN_NO_SERVER:
    case SHEEN_LOST_SERVER:
    case SHEEN_TIMEOUT:
    case SHEEN_BAD_PEER:
    case SHEEN_BAD_VERSION:
    case SHEEN_NO_MEMORY:
        return true;
    default:
        return false;
    }
}

/* Whether a mark begins at `c` that turns the direction of the text behind it, so that a terminal
 * shows it in another order: U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069. */
static bool turns_text(const char *c)
{
    static const char marks[][4] = {
        "\u061c", "\u200e", "\u200f", "\u202a", "\u202b", "\u202c",
        "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069",
    };
    for (size_t i = 0; i < sizeof(marks) / sizeof(*marks); i++)
        if (strncmp(c, marks[i], strlen(marks[i])) == 0)
            return true;
    return false;
}

/* Texts quote files and servers, and go to terminals: a '?' stands for each control character,
 * each mark that turns text, and each byte that is not UTF-8. */
static void hide_controls(char *text)
{
    char *to = text;
    for (const char *from = text; *from;) {
        size_t length = message_utf8_length(from);
        bool c1_control = from[0] == '\xc2' && ((unsigned char)from[1] & 0xe0) == 0x80;
        bool shown =
            length > 0 && (unsigned char)*from >= 0x20 && *from != 0x7f && !turns_text(from);
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

enum sheen_status status_set(struct sheen_error *error, enum sheen_status status,
                             const char *format, ...)
{
    if (!error)
        return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->text, sizeof(error->text), format, arguments);
    va_end(arguments);
    hide_controls(error->text);
    return status;
}
