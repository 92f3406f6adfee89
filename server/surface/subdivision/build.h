/* Catmull-Clark surfaces of cages as tables (server/surface/tables.h).
 *
 * Built in two steps, so that callers may use threads, of which this folder knows nothing:
 * limit_plan_create() reads the cage and sizes everything, limit_build_faces() fills any range of
 * faces. All arithmetic is in double; points are rounded once, as they are written. */
#ifndef SHEEN_SURFACE_SUBDIVISION_BUILD_H
#define SHEEN_SURFACE_SUBDIVISION_BUILD_H

#include "server/cage/cage.h"
#include "server/surface/tables.h"
#include "server/surface/watch.h"

struct limit_plan; /* the cage's connectivity and the layout of its tables */

/* `cage` has passed cage_check(); the plan keeps what it needs of it. NULL on failure: ERROR_MODEL for what
 * is not evaluated (another scheme than Catmull-Clark, too large a valence), ERROR_SERVER when
 * memory is short, or the watch's error. One thread. */
struct limit_plan *limit_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                     struct error *error);
/* Tables that were built from the plan keep what they need of it. NULL is safe. */
void limit_plan_destroy(struct limit_plan *plan);

/* For limit_tables_init(); the plan's. */
const struct limit_size *limit_plan_size(const struct limit_plan *plan);

/* Fills the nodes and points of faces [first, last). Writes nothing but that range's share of the
 * tables; disjoint ranges may be filled in different threads. False: ERROR_SERVER when memory is
 * short, or the watch's error. */
bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, const struct limit_watch *watch, struct error *error);

#endif
