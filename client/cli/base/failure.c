#include "client/cli/base/failure.h"

#include "protocol/text.h"

enum sheen_status failure_set(struct sheen_error *error, enum sheen_status status,
                              const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    text_format_line(error->text, sizeof(error->text), format, arguments);
    va_end(arguments);
    error->status = status;
    return status;
}
