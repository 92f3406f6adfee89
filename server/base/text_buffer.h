/* A text that grows up to a maximum. If an addition does not fit or memory is short, the text is
 * marked as failed and takes no more. The caller owns the struct and frees its memory by
 * text_buffer_finish().
 * Thread: one at a time. */
#ifndef SHEEN_BASE_TEXT_BUFFER_H
#define SHEEN_BASE_TEXT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>

struct text_buffer {
    char *bytes; /* ends with a 0; NULL while empty */
    size_t length, capacity, max;
    bool failed;
};

/* Starts an empty text of at most max_bytes bytes. Allocates nothing. */
void text_buffer_init(struct text_buffer *text, size_t max_bytes);
void text_buffer_finish(struct text_buffer *text);
void text_buffer_add(struct text_buffer *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
