#include "server/threads/render_thread.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/base/clock.h"
#include "server/threads/pool.h"

struct render_thread {
    const struct renderer_device *kind;
    struct renderer_options options;
    /* A copy for the loop's thread: the renderer writes its own again when it reopens the
     * device. */
    struct renderer_info info;
    char device[RENDERER_NAME_BYTES], driver[RENDERER_NAME_BYTES];
    struct pool *pool; /* a pool of one thread */
    atomic_uint losses, wakes;
    _Atomic uint64_t compiling_since_us; /* 0: no program is being made */
    struct completions *completions;
};

static void device_lost(void *owner)
{
    struct render_thread *thread = owner;
    atomic_fetch_add(&thread->losses, 1);
}

static void frames_woken(void *owner)
{
    struct render_thread *thread = owner;
    atomic_fetch_add(&thread->wakes, 1);
    completions_wake(thread->completions);
}

static void compiling(void *owner, bool begins)
{
    struct render_thread *thread = owner;
    atomic_store(&thread->compiling_since_us, begins ? clock_now_us() : 0);
}

static bool open_device(void *owner, void **context, struct error *error)
{
    struct render_thread *thread = owner;
    struct renderer *renderer = renderer_create(thread->kind, &thread->options, error);
    if (!renderer)
        return false;
    thread->info = *renderer_info(renderer);
    snprintf(thread->device, sizeof thread->device, "%s", thread->info.device);
    snprintf(thread->driver, sizeof thread->driver, "%s", thread->info.driver);
    thread->info.device = thread->device;
    thread->info.driver = thread->driver;
    *context = renderer;
    return true;
}

static void close_device(void *context)
{
    renderer_destroy(context);
}

struct render_thread *render_thread_create(const struct renderer_device *device,
                                           const struct renderer_options *options,
                                           struct completions *completions, struct error *error)
{
    struct render_thread *thread = calloc(1, sizeof *thread);
    if (!thread) {
        error_set(error, ERROR_SERVER, "no memory for the render thread");
        return NULL;
    }
    thread->kind = device;
    thread->options = *options;
    thread->options.lost = device_lost;
    thread->options.woken = frames_woken;
    thread->options.compiling = compiling;
    thread->options.owner = thread;
    thread->completions = completions;
    atomic_init(&thread->losses, 0);
    atomic_init(&thread->wakes, 0);
    atomic_init(&thread->compiling_since_us, 0);
    const struct pool_context context = {open_device, close_device, thread};
    thread->pool = pool_create("sheend-gl", 1, 0, &context, completions, error);
    if (!thread->pool) {
        free(thread);
        return NULL;
    }
    return thread;
}

void render_thread_destroy(struct render_thread *thread)
{
    if (!thread)
        return;
    pool_destroy(thread->pool);
    free(thread);
}

void render_thread_submit(struct render_thread *thread, struct task *task)
{
    pool_submit(thread->pool, task, POOL_URGENT);
}

const struct renderer_device *render_thread_device(const struct render_thread *thread)
{
    return thread->kind;
}

const struct renderer_info *render_thread_info(const struct render_thread *thread)
{
    return &thread->info;
}

uint32_t render_thread_losses(const struct render_thread *thread)
{
    return atomic_load(&thread->losses);
}

uint32_t render_thread_wakes(const struct render_thread *thread)
{
    return atomic_load(&thread->wakes);
}

uint64_t render_thread_busy_us(const struct render_thread *thread, uint64_t now_us)
{
    return pool_busy_us(thread->pool, now_us);
}

uint64_t render_thread_compiling_us(const struct render_thread *thread, uint64_t now_us)
{
    uint64_t since_us = atomic_load(&thread->compiling_since_us);
    return since_us > 0 && since_us < now_us ? now_us - since_us : 0;
}
