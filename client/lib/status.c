#include "client/lib/status.h"

#include <stdarg.h>

#include "protocol/frame.h"
#include "protocol/text.h"

#define TEXT_OF(number) TEXT_OF_VALUE(number)
#define TEXT_OF_VALUE(value) #value

const char *sheen_version(void)
{
    return SHEEN_VERSION ", protocol " TEXT_OF(PROTOCOL_MAJOR) "." TEXT_OF(PROTOCOL_MINOR);
}

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
    text_format_line(error->text, sizeof(error->text), format, arguments);
    va_end(arguments);
    return status;
}
