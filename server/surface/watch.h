/* How long work on a surface's tables is stopped from outside. */
#ifndef SHEEN_SURFACE_WATCH_H
#define SHEEN_SURFACE_WATCH_H

#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

/* Asked at every face, which may cost milliseconds. goes_on() returns false to end the work, and
 * sets `error`, which the work then fails with. It is called in the thread that works. */
struct limit_watch {
    bool (*goes_on)(void *owner, struct error *error);
    void *owner;
};

/* Without a watch (NULL) the work goes on to its end. */
static inline bool limit_goes_on(const struct limit_watch *watch, struct error *error)
{
    return !watch || watch->goes_on(watch->owner, error);
}

#endif
