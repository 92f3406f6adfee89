/* A pool of threads that run tasks; finished tasks come back to the event loop as completions
 * (task.h). A pool with one thread can own what only one thread may touch (render_thread.h).
 *
 * Thread: the loop's, for all functions except pool_beat(). */
#ifndef SHEEN_THREADS_POOL_H
#define SHEEN_THREADS_POOL_H

#include <stddef.h>
#include <stdint.h>

#include "server/threads/task.h"

#define POOL_MAX_THREADS 256u

/* The context of each thread of a pool: start() makes it before the thread's first task, stop()
 * destroys it after the last, and tasks get it as `context`. All NULL: no context. */
struct pool_context {
    bool (*start)(void *owner, void **context, struct error *error); /* on the pool's thread */
    void (*stop)(void *context);                                     /* on the same thread */
    void *owner;
};

enum pool_urgency {
    POOL_URGENT, /* an interactive frame waits for it: runs before all others */
    POOL_SOON,   /* another frame waits for it */
    POOL_LATER,  /* building tables, decoding images */
};
enum { POOL_URGENCIES = 3 };

struct pool;

/* Starts n_threads threads (1 to POOL_MAX_THREADS) for all tasks, and n_urgent_threads more for
 * urgent tasks only, which then need not wait for a long task to end. Waits until each thread has
 * made its context. NULL with the error of the first context that failed, or with ERROR_SERVER.
 * `name` is shown by ps and debuggers (at most 12 bytes). *context is copied. */
struct pool *pool_create(const char *name, unsigned n_threads, unsigned n_urgent_threads,
                         const struct pool_context *context, struct completions *completions,
                         struct error *error);

/* Runs all submitted tasks to their end, then ends the threads. The done() calls of these tasks are
 * delivered afterwards (completions_deliver()). NULL is safe. */
void pool_destroy(struct pool *pool);

/* The number of threads that take all tasks. */
unsigned pool_threads(const struct pool *pool);

/* How long, in microseconds, the slowest thread has worked on its task since the task began or
 * called pool_beat(); 0: no thread has a task. The caller decides by it whether a thread is
 * stuck. */
uint64_t pool_busy_us(const struct pool *pool, uint64_t now_us);

/* Reports that the calling thread's task is alive although it takes long. Any thread; does nothing
 * outside of a pool. */
void pool_beat(void);

/* Queues a task. Never blocks and never fails: callers limit how much they submit. */
void pool_submit(struct pool *pool, struct task *task, enum pool_urgency urgency);

#endif
