/* How work on a surface's tables is stopped from outside: it takes too long, or too much memory. */
#ifndef SHEEN_SURFACE_WATCH_H
#define SHEEN_SURFACE_WATCH_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

struct limit_size;

/* Asked at every face, which may cost milliseconds. goes_on() returns false to end the work, and
 * sets `error`, which the work then fails with. may_need() does so where tables that need at least
 * `size` cannot be kept; it is asked while tables are measured, so that nobody measures to its end
 * what will be refused, and may be NULL. Both are called in the thread that works. */
struct limit_watch {
    bool (*goes_on)(void *owner, struct error *error);
    bool (*may_need)(void *owner, const struct limit_size *size, struct error *error);
    void *owner;
};

/* Without a watch (NULL) the work goes on to its end. */
static inline bool limit_goes_on(const struct limit_watch *watch, struct error *error)
{
    return !watch || watch->goes_on(watch->owner, error);
}

static inline bool limit_may_need(const struct limit_watch *watch, const struct limit_size *size,
                                  struct error *error)
{
    return !watch || !watch->may_need || watch->may_need(watch->owner, size, error);
}

#endif
