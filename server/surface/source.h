/* Where tables without stored points have them from: what a builder keeps of a surface, and how it
 * makes a level's points from that. Private to server/surface and its builders.
 *
 * A source is shared by its plan and by all tables built by it; whoever drops it last frees it. */
#ifndef SHEEN_SURFACE_SOURCE_H
#define SHEEN_SURFACE_SOURCE_H

#include <stddef.h>
#include <stdint.h>

#include "server/surface/node.h"
#include "server/surface/texels.h"

struct limit_tables; /* tables.h */

/* The points of one level of a CORNER, or of one patch of another node, as tables store them: the
 * scale is the first texel's x, the points' texels follow. */
struct limit_level {
    float texels[1 + LIMIT_LEVEL_TEXELS][4];
};

struct limit_source {
    void (*keep)(struct limit_source *source);
    void (*drop)(struct limit_source *source); /* `keep` and `drop`: any thread */
    /* Makes level n (from 1) of a CORNER, patch n of a STRIP or the points of a REGULAR node
     * (n is not read) of tables that were built from this source. `level` or `bound` may be NULL.
     * The same bytes as tables would store. Any thread; never fails. */
    void (*make)(struct limit_source *source, const struct limit_tables *tables, uint32_t node,
                 unsigned n, struct limit_level *level, struct limit_bound *bound);
    size_t bytes; /* that it takes in main memory, with what one thread works in */
};

#endif
