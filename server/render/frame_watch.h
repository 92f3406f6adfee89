/* Tells whether somebody still waits for a frame. A device asks between a frame's tiles and lights;
 * making polygons asks between faces. When nobody waits, the work ends with ERROR_SERVER, so that a
 * client that has gone delays nobody. Thread: the thread that does the work calls
 * is_abandoned(). */
#ifndef SHEEN_RENDER_FRAME_WATCH_H
#define SHEEN_RENDER_FRAME_WATCH_H

#include "server/base/error.h"

struct frame_watch {
    bool (*is_abandoned)(void *owner); /* NULL: never */
    void *owner;
};

/* False with ERROR_SERVER when nobody waits. */
static inline bool frame_watch_check(const struct frame_watch *watch, struct error *error)
{
    return !watch->is_abandoned || !watch->is_abandoned(watch->owner) ||
           error_set(error, ERROR_SERVER, "nobody waits for this frame any more");
}

#endif
