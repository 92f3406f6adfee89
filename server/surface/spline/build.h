/* Builds the tables (server/surface/tables.h) of a model of bicubic patches: each patch is a face,
 * which is one REGULAR node. Neighbours are patches with an equal boundary curve
 * (server/cage/joints.h). README.md, chapter 8.
 *
 * As with server/surface/subdivision/build.h, a plan is created first, and then any range of faces
 * is filled, by any number of threads. */
#ifndef SHEEN_SURFACE_SPLINE_BUILD_H
#define SHEEN_SURFACE_SPLINE_BUILD_H

#include "server/cage/cage.h"
#include "server/surface/tables.h"
#include "server/surface/watch.h"

struct spline_plan;

/* `cage` has passed cage_check() and has patches; the plan copies what it needs. NULL on failure:
 * ERROR_SERVER when memory is short, or the watch's error. One thread. */
struct spline_plan *spline_plan_create(const struct cage *cage, const struct limit_watch *watch,
                                       struct error *error);
/* Destroys the plan; tables on demand built from it keep what they need. NULL is safe. */
void spline_plan_destroy(struct spline_plan *plan);

/* The size for limit_tables_init(); owned by the plan. */
const struct limit_size *spline_plan_size(const struct spline_plan *plan);

/* Fills the nodes and points of faces first to last - 1, and writes nothing else. Returns false
 * with the watch's error. */
bool spline_build_faces(struct limit_tables *tables, const struct spline_plan *plan, size_t first,
                        size_t last, const struct limit_watch *watch, struct error *error);

#endif
