/* A pool of threads that run tasks and post them back as completions. With one thread it is the
 * owner of something that only one thread may touch (render_thread.h).
 *
 * Thread: all functions here but pool_beat() are for the loop's thread. */
#ifndef SHEEN_THREADS_POOL_H
#define SHEEN_THREADS_POOL_H

#include <stddef.h>
#include <stdint.h>

#include "server/threads/task.h"

#define POOL_MAX_THREADS 256u

/* What every worker thread makes for itself before its first task and takes down after its last;
 * tasks see it as `worker`. All NULL: nothing. */
struct pool_worker {
    bool (*start)(void *owner, void **worker, struct error *error); /* on the worker's thread */
    void (*stop)(void *worker);                                     /* on the same thread */
    void *owner;
};

enum pool_urgency {
    POOL_URGENT, /* an interactive frame waits for it: before all others */
    POOL_SOON,   /* another frame does */
    POOL_LATER,  /* building tables, decoding images */
};
enum { POOL_URGENCIES = 3 };

struct pool;

/* Starts n_threads (1 to POOL_MAX_THREADS) for all tasks, and n_urgent_threads beside them for
 * urgent ones alone (those need not wait until a long task ends), and waits until each has started
 * its worker. NULL with the first worker's error, or ERROR_SERVER. `name` shows in ps and debuggers
 * (at most 12 bytes). */
struct pool *pool_create(const char *name, unsigned n_threads, unsigned n_urgent_threads,
                         const struct pool_worker *worker, struct completions *completions,
                         struct error *error);

/* Finishes every submitted task, then ends the threads. The tasks' done() calls are still to be
 * delivered then. NULL is safe. */
void pool_destroy(struct pool *pool);

/* For how long the thread that has been busy longest has been at its present task, or has not
 * called pool_beat() in it; 0: no thread has a task. A thread that hangs is told from one that
 * works by how long this is. */
uint64_t pool_busy_us(const struct pool *pool, uint64_t now_us);

/* The calling thread's present task is well, though it takes long: it waits for somebody, and will
 * not wait for ever. Any thread; nothing outside of a pool. */
void pool_beat(void);

/* Takes a task in. Never blocks and never fails: callers bound how much they submit. */
void pool_submit(struct pool *pool, struct task *task, enum pool_urgency urgency);

#endif
