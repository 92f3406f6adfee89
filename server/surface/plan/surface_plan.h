/* The plan of any model's tables: chooses the builder by what the model consists of, faces of a
 * cage (server/surface/subdivision/build.h) or patches (server/surface/spline/build.h). It offers
 * the functions that both builders have in common. */
#ifndef SHEEN_SURFACE_PLAN_SURFACE_PLAN_H
#define SHEEN_SURFACE_PLAN_SURFACE_PLAN_H

#include "server/cage/cage.h"
#include "server/surface/tables.h"
#include "server/surface/watch.h"

struct limit_plan;
struct spline_plan;

/* Exactly one member is not NULL after surface_plan_init(). */
struct surface_plan {
    struct limit_plan *faces;
    struct spline_plan *patches;
};

/* `cage` has passed cage_check(); the plan copies what it needs. False: ERROR_MODEL for what is not
 * supported, ERROR_SERVER when memory is short, or the watch's error; there is then nothing to
 * finish. One thread. */
bool surface_plan_init(struct surface_plan *plan, const struct cage *cage,
                       const struct limit_watch *watch, struct error *error);
/* Tables on demand keep what they need of the plan. Safe on a zeroed plan. */
void surface_plan_finish(struct surface_plan *plan);

/* The size for limit_tables_init(); owned by the plan. Any thread. */
const struct limit_size *surface_plan_size(const struct surface_plan *plan);

/* Fills the nodes and points of faces first to last - 1, and writes nothing else: several threads
 * may fill disjoint ranges. False with ERROR_SERVER when memory is short, or with the watch's
 * error. */
bool surface_build_faces(struct limit_tables *tables, const struct surface_plan *plan, size_t first,
                         size_t last, const struct limit_watch *watch, struct error *error);

#endif
