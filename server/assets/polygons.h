/* A model's polygons of one level: made on the pool, since that takes up to seconds, once for all
 * frames that show them. Thread: the loop's. */
#ifndef SHEEN_ASSETS_POLYGONS_H
#define SHEEN_ASSETS_POLYGONS_H

#include <stdatomic.h>

#include "server/render/renderer.h"
#include "server/threads/pool.h"

/* Everything here stays until finished() is called. */
struct polygons_order {
    struct pool *pool;
    const struct limit_tables *tables;
    uint32_t level;
    const atomic_bool *cancelled;   /* of all builds: soon ends with a failure once one of these */
    const atomic_bool *is_unwanted; /* is true */
    /* The polygons, or NULL and why. Called once, at the end. */
    void (*finished)(void *owner, struct renderer_polygons *polygons, const struct error *failure);
    void *owner;
};

/* False, without finished(), when memory is short. */
bool polygons_build_start(const struct polygons_order *order, struct error *error);

#endif
