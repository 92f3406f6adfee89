/* A task: one piece of work for another thread, and its way back to the loop's thread.
 *
 * A task is a member of the object that it serves, so nothing is allocated to submit it. From
 * pool_submit() until done() is called, the owner must not touch it. */
#ifndef SHEEN_THREADS_TASK_H
#define SHEEN_THREADS_TASK_H

#include <stdbool.h>
#include <sys/queue.h>

#include "server/base/error.h"
#include "server/net/loop.h"

struct task {
    void (*run)(struct task *task, void *context); /* called on another thread, with its context */
    /* Called on the loop's thread; may free the task. */
    void (*done)(struct task *task);
    void *owner;
    STAILQ_ENTRY(task) link; /* link in the queue that holds the task */
};

STAILQ_HEAD(task_list, task);

/* Finished tasks on their way to the loop's thread: a list with a lock, and an eventfd. The list
 * has no more tasks than were submitted; scheduler.h and store.h limit those. */
struct completions;

struct completions *completions_create(struct loop *loop, struct error *error);
void completions_destroy(struct completions *completions);                 /* NULL is safe */
void completions_post(struct completions *completions, struct task *task); /* any thread */
/* Makes the loop run its hook after a batch, without a task. Any thread. */
void completions_wake(struct completions *completions);
/* Calls done() of all finished tasks. The loop does so by itself; after the loop has stopped, the
 * daemon calls this a last time. */
void completions_deliver(struct completions *completions);

#endif
