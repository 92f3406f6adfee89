/* Makes the points of single levels from a plan, for tables on demand (server/surface/source.h). A
 * maker keeps its latest intermediate results: each level of a node follows from the one before,
 * and the nodes of a face from the face's rings. */
#ifndef SHEEN_SURFACE_SUBDIVISION_MAKER_H
#define SHEEN_SURFACE_SUBDIVISION_MAKER_H

#include "server/surface/subdivision/plan.h"

/* The makers of a plan: one for each thread that works. */
struct maker_pool;

/* Creates a pool with one maker. NULL when memory is short. */
struct maker_pool *maker_pool_create(const struct limit_plan *plan);
void maker_pool_destroy(struct maker_pool *pool); /* NULL is safe */

/* The make() of limit_source. */
void maker_make(struct limit_source *source, const struct limit_tables *tables, uint32_t node,
                unsigned n, struct limit_level *level, struct limit_bound *bound);

#endif
