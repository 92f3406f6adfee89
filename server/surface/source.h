/* The source from which tables on demand make points: what a builder keeps of a surface, and how it
 * makes a level's points. Private to server/surface and its builders.
 *
 * A source is shared by its plan and by all tables built from it; the last one to drop it frees
 * it. */
#ifndef SHEEN_SURFACE_SOURCE_H
#define SHEEN_SURFACE_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "server/surface/node.h"
#include "server/surface/texels.h"

struct limit_tables; /* tables.h */

enum { LIMIT_LEVEL_SIDE = 5, LIMIT_LEVEL_POINTS = LIMIT_LEVEL_SIDE * LIMIT_LEVEL_SIDE };

/* The points of one level of a CORNER, or of one patch of another node. */
struct limit_level {
    /* As tables store them: the x of the first texel is the scale; the points' texels follow. */
    float texels[1 + LIMIT_LEVEL_TEXELS][4];
    /* The points before rounding, in the node's frame and in the model's units: 25 for a CORNER
     * (texels_write_level()), else the first 16 (texels_write_patch()). */
    struct vec points[LIMIT_LEVEL_POINTS];
};

struct limit_source {
    /* keep() adds a reference, drop() removes one. Any thread. */
    void (*keep)(struct limit_source *source);
    void (*drop)(struct limit_source *source);
    /* Makes level n (from 1) of a CORNER, patch n of a STRIP, or the points of a REGULAR node (n is
     * ignored), for tables built from this source: the same bytes as stored tables have. `level` or
     * `bound` may be NULL. Any thread; cannot fail. */
    void (*make)(struct limit_source *source, const struct limit_tables *tables, uint32_t node,
                 unsigned n, struct limit_level *level, struct limit_bound *bound);
    size_t bytes; /* main memory of the source and of the working memory of one thread */
};

#endif
