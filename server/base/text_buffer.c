#include "server/base/text_buffer.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#define FIRST_CAPACITY 4096

void report_init(struct report *report, size_t max_bytes)
{
    *report = (struct report){.max = max_bytes};
}

void report_finish(struct report *report)
{
    free(report->bytes);
    *report = (struct report){.max = report->max};
}

/* Room for n more bytes and the 0. */
static bool make_room(struct report *report, size_t n)
{
    size_t needed = report->length + n + 1;
    if (n > report->max - report->length)
        return false;
    if (needed <= report->capacity)
        return true;
    size_t capacity = report->capacity ? report->capacity : FIRST_CAPACITY;
    while (capacity < needed)
        capacity *= 2;
    char *bytes = realloc(report->bytes, capacity);
    if (!bytes)
        return false;
    report->bytes = bytes;
    report->capacity = capacity;
    return true;
}

void report_add(struct report *report, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int n = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (n < 0 || report->failed || !make_room(report, (size_t)n))
        report->failed = true;
    else
        report->length +=
            (size_t)vsnprintf(report->bytes + report->length, (size_t)n + 1, format, again);
    va_end(again);
}
