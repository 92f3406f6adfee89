#include "server/assets/model.h"

#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/base/fault.h"
#include "server/surface/plan/surface_plan.h"
#include "server/surface/support.h"
#include "server/assets/build_clock.h"

#define FIRST_SLICE_FACES 16 /* later slices have as many as take SLICE_US */
#define MOST_SLICE_FACES 65536

struct model_build;

/* A range of faces whose tables one task of the pool fills in. */
struct slice {
    struct task task;
    struct model_build *build;
    size_t first, last; /* Ptex faces first to last - 1; equal: the slice is free */
    uint64_t took_us;
    bool ok;
    struct error error;
};

struct model_build {
    struct build_order order;
    struct task task; /* for the stages that are not cut into slices */
    struct cage cage;
    struct surface_plan plan;
    struct model *model;
    bool ok;
    struct error error;
    struct slice_source source;
    struct slice *slices; /* [n_slices], one for each that may run at the same time */
    size_t n_slices, n_running, next_face, slice_faces;
    atomic_ullong cpu_us; /* processor time of planning and filling so far */
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
    surface_plan_finish(&build->plan);
    cage_finish(&build->cage);
}

/* Prefixes build->error with the file's name, for errors of code that does not know it. Returns
 * false. */
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
    free(build->slices);
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

static void slice_run(struct task *task, void *context)
{
    (void)context;
    struct slice *slice = task->owner;
    struct model_build *build = slice->build;
    struct build_clock clock;
    const uint64_t start_us = clock_now_us();
    build_clock_start(&clock, &build->order, &build->cpu_us);
    const struct limit_watch watch = build_clock_watch(&clock);
    slice->ok = check_not_cancelled(&build->order, &slice->error) &&
                surface_build_faces(&build->model->tables, &build->plan, slice->first, slice->last,
                                    &watch, &slice->error);
    slice->took_us = clock_now_us() - start_us;
    atomic_fetch_add(&build->order.progress->done, slice->last - slice->first);
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

/* Chooses the size of the next slice so that it takes SLICE_US, by the time of this one. */
static void learn_size(struct model_build *build, const struct slice *slice)
{
    size_t n = slice->last - slice->first, most = 4 * n;
    size_t faces = slice->took_us == 0 ? most : n * SLICE_US / slice->took_us;
    faces = faces > most ? most : faces < 1 ? 1 : faces;
    build->slice_faces = faces > MOST_SLICE_FACES ? MOST_SLICE_FACES : faces;
}

static void slice_done(struct task *task)
{
    struct slice *slice = task->owner;
    struct model_build *build = slice->build;
    struct slices *slices = build->order.slices;
    slices_done(slices, &build->source, slice->took_us);
    if (!slice->ok && build->ok) {
        build->ok = false;
        build->error = slice->error;
        build->next_face = build->model->tables.n_faces; /* start no more slices */
    }
    learn_size(build, slice);
    slice->last = slice->first;
    if (--build->n_running == 0 && build->next_face == build->model->tables.n_faces) {
        slices_leave(slices, &build->source);
        if (build->ok) {
            build->task = (struct task){support_run, support_done, build, {NULL}};
            pool_submit(build->order.readers, &build->task, POOL_LATER);
        } else {
            end_build(build, fail_named(build, &build->error));
        }
    }
    slices_start(slices);
}

static struct task *next_slice(struct slice_source *source)
{
    struct model_build *build = source->build;
    const size_t n_faces = build->model->tables.n_faces;
    size_t at = 0;
    while (at < build->n_slices && build->slices[at].first < build->slices[at].last)
        at++;
    if (at == build->n_slices || build->next_face == n_faces)
        return NULL;
    struct slice *slice = &build->slices[at];
    size_t left = n_faces - build->next_face;
    slice->build = build;
    slice->first = build->next_face;
    slice->last = slice->first + (left < build->slice_faces ? left : build->slice_faces);
    slice->task = (struct task){slice_run, slice_done, slice, {NULL}};
    build->next_face = slice->last;
    build->n_running++;
    return &slice->task;
}

static bool start_slices(struct model_build *build)
{
    struct slices *slices = build->order.slices;
    build->n_slices = slices->most_running;
    build->slices = fault_at("model.build") ? NULL : calloc(build->n_slices, sizeof *build->slices);
    if (!build->slices)
        return error_set(&build->error, ERROR_SERVER, "%s: no memory to build its tables",
                         build->order.name);
    build->slice_faces = FIRST_SLICE_FACES;
    build->order.progress->stage = "tables";
    build->order.progress->total = build->model->tables.n_faces;
    build->source.build = build;
    build->source.next = next_slice;
    slices_join(slices, &build->source);
    slices_start(slices);
    return true;
}

/* Allocates the tables in the form that the device takes. */
static bool init_tables(struct model_build *build, struct error *error)
{
    const struct limit_size *size = surface_plan_size(&build->plan);
    struct limit_tables *tables = &build->model->tables;
    cage_finish(&build->cage); /* the plan holds all that is still needed of the cage */
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
        surface_plan_init(&build->plan, &build->cage, &watch, &error) &&
        cage_statistics(&build->cage, &model->statistics, &error) && init_tables(build, &error))
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
        build->ok = build_reserve_model(order, tables, &build->error) && start_slices(build);
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
