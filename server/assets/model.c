#include "server/assets/model.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/fault.h"
#include "server/surface/subdivision/build.h"
#include "server/surface/support.h"
#include "server/assets/build_clock.h"

#define MAX_RANGES 256 /* even shares for many cores, and a progress bar that moves */
#define MIN_FACES_PER_RANGE 16

struct model_build;

struct range {
    struct task task;
    struct model_build *build;
    size_t first, last; /* Ptex faces */
    bool ok;
    struct error error;
};

struct model_build {
    struct build_order order;
    struct task task; /* reading, later uploading */
    struct cage cage;
    struct limit_plan *plan;
    struct model *model;
    bool ok;
    struct error error;
    struct range *ranges;
    size_t n_ranges, n_ranges_left;
    atomic_ullong cpu_us; /* that measuring and filling have taken */
    uint64_t start_us;
};

static void model_free(struct model *model)
{
    if (!model)
        return;
    limit_tables_finish(&model->tables);
    free(model->warnings);
    free(model);
}

static void drop_cage(struct model_build *build)
{
    limit_plan_destroy(build->plan);
    build->plan = NULL;
    cage_finish(&build->cage);
}

/* Puts the file's name before an error of a part that knows no files. Returns false. */
static bool fail_named(struct model_build *build, const struct error *found)
{
    const struct error copy = *found;
    return error_set(&build->error, copy.kind, "%s: %s", build->order.name, copy.text);
}

/* Ends the build on the loop's thread: with its model, or with build->error. */
static void end_build(struct model_build *build, bool ok)
{
    drop_cage(build);
    struct model *model = build->model;
    if (!ok) {
        model_free(model);
        model = NULL;
    } else {
        model->build_us = clock_now_us() - build->start_us;
    }
    build->order.finished(build->order.owner, model, ok ? NULL : &build->error);
    free(build->ranges);
    free(build);
}

/* --- the render thread's part */

static void upload_run(struct task *task, void *context)
{
    struct model_build *build = task->owner;
    build->model->gpu = renderer_model_create(context, &build->model->tables, &build->error);
}

static void upload_done(struct task *task)
{
    struct model_build *build = task->owner;
    end_build(build, build->model->gpu || fail_named(build, &build->error));
}

static void start_upload(struct model_build *build)
{
    drop_cage(build);
    build->order.progress->stage = "upload";
    build->order.progress->total = 0;
    build->task = (struct task){upload_run, upload_done, build, {NULL}};
    render_thread_submit(build->order.render_thread, &build->task);
}

/* --- the pool's part */

static bool check_not_cancelled(const struct build_order *order, struct error *error)
{
    return !atomic_load(order->cancelled) ||
           error_set(error, ERROR_SERVER, "the daemon is shutting down");
}

static void range_run(struct task *task, void *context)
{
    (void)context;
    struct range *range = task->owner;
    struct model_build *build = range->build;
    struct build_clock clock;
    build_clock_start(&clock, &build->order, &build->cpu_us);
    const struct limit_watch watch = build_clock_watch(&clock);
    range->ok = check_not_cancelled(&build->order, &range->error) &&
                limit_build_faces(&build->model->tables, build->plan, range->first, range->last,
                                  &watch, &range->error);
    atomic_fetch_add(&build->order.progress->done, range->last - range->first);
}

static void support_run(struct task *task, void *context)
{
    (void)context;
    struct model_build *build = task->owner;
    struct build_clock clock;
    build_clock_start(&clock, &build->order, &build->cpu_us);
    const struct limit_watch watch = build_clock_watch(&clock);
    build->ok = check_not_cancelled(&build->order, &build->error) &&
                limit_find_support(&build->model->tables, &watch, &build->error);
}

static void support_done(struct task *task)
{
    struct model_build *build = task->owner;
    if (build->ok)
        start_upload(build);
    else
        end_build(build, fail_named(build, &build->error));
}

static void range_done(struct task *task)
{
    struct model_build *build = ((struct range *)task->owner)->build;
    if (--build->n_ranges_left > 0)
        return;
    for (size_t i = 0; i < build->n_ranges; i++) {
        if (build->ranges[i].ok)
            continue;
        end_build(build, fail_named(build, &build->ranges[i].error));
        return;
    }
    build->task = (struct task){support_run, support_done, build, {NULL}};
    pool_submit(build->order.pool, &build->task, POOL_LATER);
}

static bool start_ranges(struct model_build *build)
{
    size_t n_faces = build->model->tables.n_faces;
    size_t n = n_faces / MIN_FACES_PER_RANGE + 1;
    n = n > MAX_RANGES ? MAX_RANGES : n;
    build->ranges = fault_at("model.build") ? NULL : calloc(n, sizeof *build->ranges);
    if (!build->ranges)
        return error_set(&build->error, ERROR_SERVER, "%s: no memory to build its tables",
                         build->order.name);
    build->n_ranges = build->n_ranges_left = n;
    build->order.progress->stage = "tables";
    build->order.progress->total = n_faces;
    for (size_t i = 0; i < n; i++) {
        struct range *range = &build->ranges[i];
        range->first = (size_t)((unsigned __int128)n_faces * i / n);
        range->last = (size_t)((unsigned __int128)n_faces * (i + 1) / n);
        range->build = build;
        range->task = (struct task){range_run, range_done, range, {NULL}};
        pool_submit(build->order.pool, &range->task, POOL_LATER);
    }
    return true;
}

/* In the form that the device takes. */
static bool init_tables(struct model_build *build, struct error *error)
{
    const struct limit_size *size = limit_plan_size(build->plan);
    struct limit_tables *tables = &build->model->tables;
    cage_finish(&build->cage); /* the plan has what is needed of it */
    return renderer_takes_tables_on_demand(render_thread_device(build->order.render_thread))
               ? limit_tables_init_on_demand(tables, size, error)
               : limit_tables_init(tables, size, error);
}

static bool read_cage(struct model_build *build)
{
    const struct build_order *order = &build->order;
    struct model *model = build->model;
    struct error error = {0};
    if (!workers_read_cage(order->workers, &build->cage, order->file, order->file_bytes,
                           order->name, &build->error))
        return false;
    model->n_vertices = build->cage.n_vertices;
    model->n_faces = build->cage.n_faces;
    model->up = build->cage.up;
    model->n_findings = build->cage.n_findings;
    memcpy(model->finding, build->cage.finding, sizeof model->finding);
    if (build->cage.warnings && !(model->warnings = strdup(build->cage.warnings)))
        return error_set(&build->error, ERROR_SERVER, "%s: no memory", order->name);
    struct build_clock clock;
    build_clock_start(&clock, order, &build->cpu_us);
    const struct limit_watch watch = build_clock_watch(&clock);
    if (check_not_cancelled(order, &error) &&
        cage_statistics(&build->cage, &model->statistics, &error) &&
        (build->plan = limit_plan_create(&build->cage, &watch, &error)) &&
        init_tables(build, &error))
        return true;
    return fail_named(build, &error);
}

static void read_run(struct task *task, void *context)
{
    (void)context;
    struct model_build *build = task->owner;
    build->ok = read_cage(build);
}

static void read_done(struct task *task)
{
    struct model_build *build = task->owner;
    const struct build_order *order = &build->order;
    if (build->ok) {
        const struct limit_tables *tables = &build->model->tables;
        build->model->device_bytes =
            renderer_model_bytes(render_thread_device(order->render_thread), tables);
        build->ok = order->reserve(order->owner, build_model_bytes(order, tables), &build->error) &&
                    start_ranges(build);
    }
    if (!build->ok)
        end_build(build, false);
}

bool model_build_start(const struct build_order *order, struct error *error)
{
    struct model_build *build = calloc(1, sizeof *build);
    struct model *model = calloc(1, sizeof *model);
    if (!build || !model) {
        free(build);
        free(model);
        return error_set(error, ERROR_SERVER, "%s: no memory to build it", order->name);
    }
    build->order = *order;
    atomic_init(&build->cpu_us, 0);
    build->model = model;
    build->start_us = clock_now_us();
    order->progress->stage = "reading";
    build->task = (struct task){read_run, read_done, build, {NULL}};
    pool_submit(order->readers, &build->task, POOL_LATER);
    return true;
}

static void destroy_run(struct task *task, void *context)
{
    struct model *model = task->owner;
    renderer_model_destroy(context, model->gpu);
}

static void destroy_done(struct task *task)
{
    model_free(task->owner);
}

void model_destroy(struct model *model, struct render_thread *render_thread)
{
    model->destroy_task = (struct task){destroy_run, destroy_done, model, {NULL}};
    render_thread_submit(render_thread, &model->destroy_task);
}
