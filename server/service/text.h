/* Text that grows up to a bound. What does not fit, or finds no memory, marks it as failed, and it
 * takes no more. Owned by its user, who gives it back with text_finish(). No thread. */
#ifndef SHEEN_SERVICE_TEXT_H
#define SHEEN_SERVICE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

struct text {
    char *bytes; /* with a 0 behind; NULL while empty */
    size_t length, capacity, max;
    bool failed;
};

/* At most max_bytes long. */
void text_init(struct text *text, size_t max_bytes);
void text_finish(struct text *text);
void text_add(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
