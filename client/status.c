#include "client/status.h"

#include <stdarg.h>
#include <stdio.h>

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
    for (char *c = error->text; *c; c++)
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            *c = '?';
    return status;
}
