/* Builds the tables (server/surface/tables.h) of the Catmull-Clark surface of a cage.
 *
 * There are two steps, so that callers can use several threads, of which this folder knows nothing:
 * limit_plan_create() reads the cage and computes all sizes, limit_build_faces() fills any range of
 * faces. All arithmetic is in double precision; points are rounded once, when they are written. */
#ifndef SHEEN_SURFACE_SUBDIVISION_BUILD_H
#define SHEEN_SURFACE_SUBDIVISION_BUILD_H

#include "server/cage/cage.h"
#include "server/surface/tables.h"
#include "server/surface/watch.h"

struct limit_plan; /* the cage's connectivity, and the layout of its tables */

/* `cage` has passed cage_check(); the plan copies what it needs of it. NULL on failure: ERROR_MODEL
 * for what is not supported (a scheme other than Catmull-Clark, too large a valence), ERROR_SERVER
 * when memory is short, or the watch's error. One thread. */
struct limit_plan *limit_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                     struct error *error);
/* Destroys the plan; tables on demand built from it keep what they need. NULL is safe. */
void limit_plan_destroy(struct limit_plan *plan);

/* The size for limit_tables_init(); owned by the plan. */
const struct limit_size *limit_plan_size(const struct limit_plan *plan);

/* Fills the nodes and points of faces first to last - 1. Writes only that range's share of the
 * tables, so that several threads may fill disjoint ranges. False with ERROR_SERVER when memory is
 * short, or with the watch's error. */
bool limit_build_faces(struct limit_tables *tables, const struct limit_plan *plan, size_t first,
                       size_t last, const struct limit_watch *watch, struct error *error);

#endif
