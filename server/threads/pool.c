#include "server/threads/pool.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"

struct pool_thread {
    struct pool *pool;
    pthread_t thread;
    atomic_ullong busy_since_us; /* when its task began or last called pool_beat(); 0: no task */
};

static _Thread_local struct pool_thread *this_thread; /* NULL outside of a pool */

struct pool {
    char name[13];
    struct pool_context context;
    struct completions *completions;
    pthread_mutex_t lock;
    pthread_cond_t changed; /* signalled for new tasks, started threads and the end */
    struct task_list lists[POOL_URGENCIES];
    bool ending;
    unsigned n_urgent_threads; /* the first threads are the urgent ones */
    unsigned n_threads, n_started, n_failed;
    struct error start_error; /* of the first context that failed */
    struct pool_thread threads[];
};

/* Takes the first task; NULL if there is none. */
static struct task *take_first(struct task_list *list)
{
    struct task *task = STAILQ_FIRST(list);
    if (task)
        STAILQ_REMOVE_HEAD(list, link);
    return task;
}

static struct task *next_task(struct pool *pool, int least_urgent)
{
    struct task *task = NULL;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        for (int urgency = POOL_URGENT; urgency <= least_urgent && !task; urgency++)
            task = take_first(&pool->lists[urgency]);
        if (task || pool->ending)
            break;
        pthread_cond_wait(&pool->changed, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
    return task;
}

/* Makes the calling thread's context. *least_urgent: the least urgent tasks that the thread
 * takes. */
static bool start_context(struct pool *pool, void **context, int *least_urgent)
{
    struct error error = {0};
    bool ok = !pool->context.start || pool->context.start(pool->context.owner, context, &error);
    pthread_mutex_lock(&pool->lock);
    *least_urgent = pool->n_started++ < pool->n_urgent_threads ? POOL_URGENT : POOL_LATER;
    if (!ok && pool->n_failed++ == 0)
        pool->start_error = error;
    pthread_cond_broadcast(&pool->changed);
    pthread_mutex_unlock(&pool->lock);
    return ok;
}

static void *thread_main(void *argument)
{
    struct pool_thread *self = argument;
    struct pool *pool = self->pool;
    this_thread = self;
    pthread_setname_np(pthread_self(), pool->name);
    void *context = NULL;
    int least_urgent;
    if (!start_context(pool, &context, &least_urgent))
        return NULL;
    for (struct task *task; (task = next_task(pool, least_urgent));) {
        atomic_store(&self->busy_since_us, clock_now_us());
        task->run(task, context);
        atomic_store(&self->busy_since_us, 0);
        completions_post(pool->completions, task);
    }
    if (pool->context.stop)
        pool->context.stop(context);
    return NULL;
}

static bool start_threads(struct pool *pool, unsigned n_threads, struct error *error)
{
    int code = 0;
    while (pool->n_threads < n_threads && code == 0) {
        struct pool_thread *next = &pool->threads[pool->n_threads];
        next->pool = pool;
        atomic_init(&next->busy_since_us, 0);
        code = pthread_create(&next->thread, NULL, thread_main, next);
        pool->n_threads += code == 0;
    }
    pthread_mutex_lock(&pool->lock);
    while (pool->n_started < pool->n_threads)
        pthread_cond_wait(&pool->changed, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
    if (code)
        return error_set(error, ERROR_SERVER, "cannot start a thread: %s", strerror(code));
    if (pool->n_failed)
        return error_set(error, pool->start_error.kind, "%s", pool->start_error.text);
    return true;
}

struct pool *pool_create(const char *name, unsigned n_threads, unsigned n_urgent_threads,
                         const struct pool_context *context, struct completions *completions,
                         struct error *error)
{
    n_threads += n_urgent_threads;
    struct pool *pool = calloc(1, sizeof *pool + n_threads * sizeof pool->threads[0]);
    if (!pool) {
        error_set(error, ERROR_SERVER, "no memory for %u threads", n_threads);
        return NULL;
    }
    snprintf(pool->name, sizeof pool->name, "%s", name);
    pool->context = *context;
    pool->n_urgent_threads = n_urgent_threads;
    pool->completions = completions;
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->changed, NULL);
    for (int i = 0; i < POOL_URGENCIES; i++)
        STAILQ_INIT(&pool->lists[i]);
    if (!start_threads(pool, n_threads, error)) {
        pool_destroy(pool);
        return NULL;
    }
    return pool;
}

void pool_destroy(struct pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->ending = true;
    pthread_cond_broadcast(&pool->changed);
    pthread_mutex_unlock(&pool->lock);
    for (unsigned i = 0; i < pool->n_threads; i++)
        pthread_join(pool->threads[i].thread, NULL);
    pthread_cond_destroy(&pool->changed);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

unsigned pool_threads(const struct pool *pool)
{
    return pool->n_threads - pool->n_urgent_threads;
}

uint64_t pool_busy_us(const struct pool *pool, uint64_t now_us)
{
    uint64_t longest = 0;
    for (unsigned i = 0; i < pool->n_threads; i++) {
        uint64_t since = atomic_load(&pool->threads[i].busy_since_us);
        uint64_t busy = since && since < now_us ? now_us - since : 0;
        longest = busy > longest ? busy : longest;
    }
    return longest;
}

void pool_beat(void)
{
    if (this_thread)
        atomic_store(&this_thread->busy_since_us, clock_now_us());
}

void pool_submit(struct pool *pool, struct task *task, enum pool_urgency urgency)
{
    pthread_mutex_lock(&pool->lock);
    STAILQ_INSERT_TAIL(&pool->lists[urgency], task, link);
    /* A woken thread may be an urgent one, which cannot take this task: then wake all. */
    pool->n_urgent_threads ? pthread_cond_broadcast(&pool->changed)
                           : pthread_cond_signal(&pool->changed);
    pthread_mutex_unlock(&pool->lock);
}
