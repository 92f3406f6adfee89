/* Text that grows up to a bound. What does not fit, or finds no memory, marks it as failed, and it
 * takes no more. Owned by its user, who gives it back with text_buffer_finish(). No thread. */
#ifndef SHEEN_BASE_TEXT_BUFFER_H
#define SHEEN_BASE_TEXT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>

struct text_buffer {
    char *bytes; /* with a 0 behind; NULL while empty */
    size_t length, capacity, max;
    bool failed;
};

/* At most max_bytes long. */
void text_buffer_init(struct text_buffer *text, size_t max_bytes);
void text_buffer_finish(struct text_buffer *text);
void text_buffer_add(struct text_buffer *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
