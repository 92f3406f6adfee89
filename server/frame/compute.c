#include "server/frame/compute.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/scene/request_check.h"
#include "server/scene/scene_convert.h"

const struct compute_kind *compute_kind_of(uint8_t type)
{
    return type == MESSAGE_COMPARE       ? &compute_compare_kind
           : type == MESSAGE_TRACE_LINES ? &compute_lines_kind
                                         : &compute_breaks_kind;
}

struct compute *compute_create(struct request *request, uint8_t type,
                               const union compute_asked *asked)
{
    struct request_host *host = request->host;
    const unsigned n_tasks = store_slices(host->store)->most_running;
    const size_t bytes = sizeof(struct compute) + n_tasks * sizeof(struct compute_task);
    struct compute *compute = block_cache_take(host->block_cache, bytes);
    if (!compute)
        return NULL;
    memset(compute, 0, bytes);
    compute->kind = compute_kind_of(type);
    compute->request = request;
    compute->asked = *asked;
    compute->n_tasks = n_tasks;
    compute->ok = true;
    return compute;
}

static void leave_slices(struct compute *compute)
{
    if (compute->has_joined)
        slices_leave(store_slices(compute->request->host->store), &compute->source);
    compute->has_joined = false;
}

static void leave_line(struct compute *compute)
{
    if (compute->is_in_line)
        TAILQ_REMOVE(&compute->request->host->in_line, compute, link);
    compute->is_in_line = false;
}

void compute_destroy(struct compute *compute)
{
    if (!compute)
        return;
    struct request *request = compute->request;
    struct request_host *host = request->host;
    leave_line(compute);
    leave_slices(compute);
    if (compute->computation) {
        computation_destroy(compute->computation);
        host->n_computing--;
        request->party->n_computing--;
    }
    block_cache_give(host->block_cache, compute->records);
    block_cache_give(host->block_cache, compute);
}

void compute_stop(struct compute *compute)
{
    if (compute->computation)
        atomic_store(&compute->computation->cancelled, true);
    leave_slices(compute);
}

/* --- in line */

/* Lines without an eye of their own are those of the camera's. */
static void set_line_eye(struct frame_request *scene)
{
    const struct camera *camera = &scene->camera;
    struct lines *lines = &scene->lines;
    if (lines->eye_kind != LINE_EYE_CAMERA)
        return;
    bool is_point = camera->kind == CAMERA_PERSPECTIVE;
    lines->eye_kind = is_point ? LINE_EYE_POINT : LINE_EYE_DIRECTION;
    for (int i = 0; i < 3; i++)
        lines->eye[i] = is_point ? camera->eye[i] : camera->target[i] - camera->eye[i];
}

void compute_enter_line(struct compute *compute)
{
    struct request *request = compute->request;
    const struct needed *const models[2] = {&request->model, &compute->second};
    for (int i = 0; i < 2; i++)
        compute->tables[i] = models[i]->asset ? &models[i]->asset->model->tables : NULL;
    const struct scene_subject subject = model_subject(request->model.asset->model);
    scene_read_request(&request->render, &subject, &compute->scene);
    set_line_eye(&compute->scene);
    compute->bytes = compute->kind->bytes(compute);
    request_state_move(&request->state, REQUEST_IN_LINE);
    TAILQ_INSERT_TAIL(&request->host->in_line, compute, link);
    compute->is_in_line = true;
}

/* Charges the memory of a computation whose turn it is. */
static enum memory_result take_memory(struct compute *compute)
{
    struct request *request = compute->request;
    struct request_host *host = request->host;
    struct client_quota *quota = request->client->quota;
    const uint64_t room = store_account(host->store)->limit;
    const uint64_t most = quota->account.limit < room ? quota->account.limit : room;
    const struct memory_frame needs = {compute->bytes, 0, compute->kind->what};
    if (compute->bytes > most) {
        error_set(&request->failure, ERROR_REQUEST,
                  "%s takes up to %" PRIu64 " bytes of memory, and this daemon has at most %" PRIu64
                  " for it (--memory-budget, --peer-memory)",
                  compute->kind->what, compute->bytes, most);
        return MEMORY_FAILED;
    }
    return memory_charge_frame(host->memory, quota, request->asker, ACCOUNT_PATIENT, &needs,
                               &request->charge, &request->failure);
}

static struct task *next_task(struct slice_source *source);

static void start(struct compute *compute)
{
    struct request *request = compute->request;
    struct request_host *host = request->host;
    if (request_check_view(&compute->scene, &request->failure))
        compute->computation = compute->kind->create(compute, &request->failure);
    if (!compute->computation) {
        request_fail(request, &request->failure);
        return;
    }
    compute->computation->beat = slices_beat;
    host->n_computing++;
    request->party->n_computing++;
    leave_line(compute);
    request_state_move(&request->state, REQUEST_COMPUTING);
    compute->source.build = compute;
    compute->source.next = next_task;
    slices_join(store_slices(host->store), &compute->source);
    compute->has_joined = true;
}

void compute_start_next(struct request_host *host)
{
    struct compute *compute = TAILQ_FIRST(&host->in_line);
    while (compute && host->n_computing < COMPUTE_MOST_RUNNING) {
        struct compute *next = TAILQ_NEXT(compute, link);
        struct request *request = compute->request;
        if (request->party->n_computing < COMPUTE_MOST_OF_PARTY) {
            request->failure = (struct error){0};
            enum memory_result result = take_memory(compute);
            if (result == MEMORY_CHARGED)
                start(compute);
            else if (result == MEMORY_FAILED)
                request_fail(request, &request->failure);
        }
        compute = next;
    }
    slices_start(store_slices(host->store));
}

/* --- on the pool */

static void task_run(struct task *task, void *context)
{
    (void)context;
    struct compute_task *of = task->owner;
    struct compute *compute = of->compute;
    struct computation *computation = compute->computation;
    const uint64_t start_us = clock_now_us();
    if (atomic_load(&computation->cancelled))
        ; /* nobody waits for the result */
    else if (compute->step == COMPUTE_BEGIN)
        compute->ok = computation->kind->begin(computation, compute->phase, &compute->n_slices,
                                               &compute->error);
    else if (compute->step == COMPUTE_SLICES)
        computation->kind->slice(computation, of->slice);
    else
        compute->ok = compute->kind->pack(compute, &compute->error);
    of->took_us = clock_now_us() - start_us;
}

/* Hands the records and their charge to the encoded answer. NULL when memory is short; then the computation keeps
 * both. */
static struct encoded *take_records(struct compute *compute)
{
    struct request *request = compute->request;
    struct encoded *encoded =
        encoded_of(request->host->block_cache, compute->records, compute->records_bytes);
    if (!encoded)
        return NULL;
    compute->records = NULL;
    request_hand_over_charge(request, encoded);
    return encoded;
}

static void reply(struct compute *compute)
{
    struct request *request = compute->request;
    const struct request_client *client = request->client;
    struct encoded *records = NULL;
    if (compute->records_bytes > 0 && !(records = take_records(compute))) {
        error_set(&compute->error, ERROR_SERVER, "%s: no memory for the answer: try again later",
                  compute->kind->what);
        request_fail(request, &compute->error);
        return;
    }
    client->events->computed(client->owner, request->reply, compute->kind->answer, &compute->answer,
                             records);
    request_end(request);
}

/* All tasks of a step are done: chooses the next step. */
static void end_step(struct compute *compute)
{
    const char *const *stages = compute->computation->kind->stages;
    if (!compute->ok) {
        request_fail(compute->request, &compute->error);
        return;
    }
    if (compute->step == COMPUTE_PACK) {
        reply(compute);
        return;
    }
    if (compute->step == COMPUTE_BEGIN && compute->n_slices > 0) {
        compute->step = COMPUTE_SLICES;
        compute->next_slice = compute->n_done = 0;
        return;
    }
    compute->phase += !computation_repeats(compute->computation);
    compute->n_slices = compute->next_slice = compute->n_done = 0;
    compute->step = stages[compute->phase] ? COMPUTE_BEGIN : COMPUTE_PACK;
}

static void task_done(struct task *task)
{
    struct compute_task *of = task->owner;
    struct compute *compute = of->compute;
    struct request *request = compute->request;
    struct slices *slices = store_slices(request->host->store);
    of->is_busy = false;
    compute->n_running--;
    compute->n_done += compute->step == COMPUTE_SLICES;
    if (compute->step == COMPUTE_SLICES && of->took_us > compute->longest_us)
        compute->longest_us = of->took_us;
    slices_done(slices, &compute->source, of->took_us);
    bool is_last = compute->n_running == 0 &&
                   (compute->step != COMPUTE_SLICES || compute->next_slice == compute->n_slices);
    if (request->state == REQUEST_ABANDONED) {
        if (compute->n_running == 0)
            request_end(request);
    } else if (is_last) {
        end_step(compute);
    }
    slices_start(slices);
}

/* One task at a time while frames are drawn or encoded, so that they get the processors. The same until a slice has been
 * run, and after one that took much longer than it should: if such slices ran on all threads of the pool, nobody's
 * picture could be encoded. */
static unsigned most_running(const struct compute *compute)
{
    enum { LONG_US = 10 * SLICE_US };
    bool is_free = compute->longest_us > 0 && compute->longest_us < LONG_US &&
                   scheduler_is_idle(&compute->request->host->scheduler);
    return is_free ? compute->n_tasks : 1;
}

static struct task *next_task(struct slice_source *source)
{
    struct compute *compute = source->build;
    bool has_more = compute->step == COMPUTE_SLICES ? compute->next_slice < compute->n_slices
                                                    : compute->n_running == 0;
    if (!has_more || compute->n_running >= most_running(compute))
        return NULL;
    unsigned at = 0;
    while (compute->tasks[at].is_busy)
        at++;
    struct compute_task *of = &compute->tasks[at];
    of->compute = compute;
    of->is_busy = true;
    if (compute->step == COMPUTE_SLICES)
        of->slice = compute->next_slice++;
    of->task = (struct task){task_run, task_done, of, {NULL}};
    compute->n_running++;
    return &of->task;
}

bool compute_is_running(const struct compute *compute)
{
    return compute->n_running > 0;
}

bool compute_progress(const struct compute *compute, sheen_Progress *progress)
{
    const struct request *request = compute->request;
    if (request->state == REQUEST_IN_LINE) {
        *progress = (sheen_Progress){.stage = "waiting"};
        return true;
    }
    if (request->state != REQUEST_COMPUTING || compute->step == COMPUTE_PACK)
        return false;
    *progress = (sheen_Progress){.done = compute->n_done};
    /* While a phase is prepared, n_slices belongs to another thread. */
    progress->total = compute->step == COMPUTE_SLICES ? compute->n_slices : 0;
    snprintf(progress->stage, sizeof progress->stage, "%s",
             compute->computation->kind->stages[compute->phase]);
    return true;
}
