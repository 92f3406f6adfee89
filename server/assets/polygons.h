/* Builds the polygons of one level of a model, on the pool, because that can take seconds. All
 * frames that show them share them.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_POLYGONS_H
#define SHEEN_ASSETS_POLYGONS_H

#include <stdatomic.h>

#include "server/render/renderer.h"
#include "server/threads/pool.h"

/* Everything here must stay valid until finished() is called. */
struct polygons_order {
    struct pool *pool;
    const struct limit_tables *tables;
    uint32_t level;
    /* The build fails soon after one of these becomes true. */
    const atomic_bool *cancelled;   /* all builds */
    const atomic_bool *is_unwanted; /* this build */
    /* Called once at the end, on the loop's thread: with the polygons, which the callee owns, or
     * with NULL and the error. */
    void (*finished)(void *owner, struct renderer_polygons *polygons, const struct error *failure);
    void *owner;
};

/* Starts a build. False with *error when memory is short; then finished() is not called. */
bool polygons_build_start(const struct polygons_order *order, struct error *error);

#endif
