#include "server/assets/polygons.h"

#include <stdlib.h>

struct polygons_build {
    struct polygons_order order;
    struct task task;
    struct renderer_polygons *polygons;
    struct error error;
};

static bool is_given_up(void *owner)
{
    const struct polygons_order *order = &((const struct polygons_build *)owner)->order;
    return atomic_load(order->cancelled) || atomic_load(order->is_unwanted);
}

static void make_run(struct task *task, void *context)
{
    (void)context;
    struct polygons_build *build = task->owner;
    const struct frame_watch watch = {is_given_up, build};
    build->polygons =
        renderer_polygons_create(build->order.tables, build->order.level, &watch, &build->error);
}

static void make_done(struct task *task)
{
    struct polygons_build *build = task->owner;
    const struct polygons_build made = *build;
    free(build);
    made.order.finished(made.order.owner, made.polygons, made.polygons ? NULL : &made.error);
}

bool polygons_build_start(const struct polygons_order *order, struct error *error)
{
    struct polygons_build *build = calloc(1, sizeof *build);
    if (!build)
        return error_set(error, ERROR_SERVER, "no memory to make polygons");
    build->order = *order;
    build->task = (struct task){make_run, make_done, build, {NULL}};
    pool_submit(order->pool, &build->task, POOL_LATER);
    return true;
}
