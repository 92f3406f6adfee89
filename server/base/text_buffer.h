/* Text that grows up to a bound. What does not fit, or finds no memory, marks it as failed, and it
 * takes no more. Owned by its user, who gives it back with report_finish(). No thread. */
#ifndef SHEEN_BASE_TEXT_BUFFER_H
#define SHEEN_BASE_TEXT_BUFFER_H

#include <stdbool.h>
#include <stddef.h>

struct report {
    char *bytes; /* with a 0 behind; NULL while empty */
    size_t length, capacity, max;
    bool failed;
};

/* At most max_bytes long. */
void report_init(struct report *report, size_t max_bytes);
void report_finish(struct report *report);
void report_add(struct report *report, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
