/* A pool of threads that run tasks and post them back as completions. A pool of one thread owns
 * what only one thread may touch (render_thread.h).
 *
 * Thread: all functions here but pool_beat() are for the loop's thread. */
#ifndef SHEEN_THREADS_POOL_H
#define SHEEN_THREADS_POOL_H

#include <stddef.h>
#include <stdint.h>

#include "server/threads/task.h"

#define POOL_MAX_THREADS 256u

/* What every thread of the pool makes for itself before its first task and destroys after its last;
 * tasks get it as `context`. All NULL: nothing. */
struct pool_context {
    bool (*start)(void *owner, void **context, struct error *error); /* on the pool's thread */
    void (*stop)(void *context);                                     /* on the same thread */
    void *owner;
};

enum pool_urgency {
    POOL_URGENT, /* an interactive frame waits for it: before all others */
    POOL_SOON,   /* a frame that is not interactive waits for it */
    POOL_LATER,  /* building tables, decoding images */
};
enum { POOL_URGENCIES = 3 };

struct pool;

/* Starts n_threads (1 to POOL_MAX_THREADS) for all tasks, and beside them n_urgent_threads for
 * urgent tasks alone, which then need not wait until a long task ends. Waits until each thread has
 * made its context. NULL with the error of the first that failed, or ERROR_SERVER. `name` shows in
 * ps and debuggers (at most 12 bytes). */
struct pool *pool_create(const char *name, unsigned n_threads, unsigned n_urgent_threads,
                         const struct pool_context *context, struct completions *completions,
                         struct error *error);

/* Finishes every submitted task, then ends the threads. The tasks' done() calls are still to be
 * delivered then. NULL is safe. */
void pool_destroy(struct pool *pool);

/* How many threads take all tasks. */
unsigned pool_threads(const struct pool *pool);

/* The longest time that any thread has been at its present task without calling pool_beat(); 0: no
 * thread has a task. The caller takes a thread for stuck by the length of this time. */
uint64_t pool_busy_us(const struct pool *pool, uint64_t now_us);

/* Says that the calling thread's present task is well although it takes long. Any thread; it does
 * nothing outside of a pool. */
void pool_beat(void);

/* Queues a task. Never blocks and never fails: callers bound how much they submit. */
void pool_submit(struct pool *pool, struct task *task, enum pool_urgency urgency);

#endif
