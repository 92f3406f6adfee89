#include "server/surface/plan/surface_plan.h"

#include "server/surface/spline/build.h"
#include "server/surface/subdivision/build.h"

bool surface_plan_init(struct surface_plan *plan, const struct cage *cage,
                       const struct limit_watch *watch, struct error *error)
{
    *plan = (struct surface_plan){NULL, NULL};
    if (cage->n_patches > 0)
        plan->patches = spline_plan_create(cage, watch, error);
    else
        plan->faces = limit_plan_create(cage, watch, error);
    return plan->patches || plan->faces;
}

void surface_plan_finish(struct surface_plan *plan)
{
    limit_plan_destroy(plan->faces);
    spline_plan_destroy(plan->patches);
    *plan = (struct surface_plan){NULL, NULL};
}

const struct limit_size *surface_plan_size(const struct surface_plan *plan)
{
    return plan->patches ? spline_plan_size(plan->patches) : limit_plan_size(plan->faces);
}

bool surface_build_faces(struct limit_tables *tables, const struct surface_plan *plan, size_t first,
                         size_t last, const struct limit_watch *watch, struct error *error)
{
    return plan->patches ? spline_build_faces(tables, plan->patches, first, last, watch, error)
                         : limit_build_faces(tables, plan->faces, first, last, watch, error);
}
