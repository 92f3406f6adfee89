/* Lets the caller stop work on a surface's tables when it takes too long or needs too much
 * memory. */
#ifndef SHEEN_SURFACE_WATCH_H
#define SHEEN_SURFACE_WATCH_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

struct limit_size;

/* goes_on() is called for every face, which may cost milliseconds. It returns false and sets *error
 * to end the work, which then fails with that error. may_need() does the same if tables of at least
 * `size` cannot be kept; it is called while tables are measured, so that tables that will be
 * refused are not measured to the end; it may be NULL. Both are called by the thread that works. */
struct limit_watch {
    bool (*goes_on)(void *owner, struct error *error);
    bool (*may_need)(void *owner, const struct limit_size *size, struct error *error);
    void *owner;
};

/* Without a watch (NULL) the work is not stopped. */
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
