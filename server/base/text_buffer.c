#include "server/base/text_buffer.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#define FIRST_CAPACITY 4096

void text_buffer_init(struct text_buffer *text, size_t max_bytes)
{
    *text = (struct text_buffer){.max = max_bytes};
}

void text_buffer_finish(struct text_buffer *text)
{
    free(text->bytes);
    *text = (struct text_buffer){.max = text->max};
}

/* Makes room for n more bytes and the 0. */
static bool make_room(struct text_buffer *text, size_t n)
{
    size_t needed = text->length + n + 1;
    if (n > text->max - text->length)
        return false;
    if (needed <= text->capacity)
        return true;
    size_t capacity = text->capacity ? text->capacity : FIRST_CAPACITY;
    while (capacity < needed)
        capacity *= 2;
    char *bytes = realloc(text->bytes, capacity);
    if (!bytes)
        return false;
    text->bytes = bytes;
    text->capacity = capacity;
    return true;
}

void text_buffer_add(struct text_buffer *text, const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int n = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    if (n < 0 || text->failed || !make_room(text, (size_t)n))
        text->failed = true;
    else
        text->length += (size_t)vsnprintf(text->bytes + text->length, (size_t)n + 1, format, again);
    va_end(again);
}
