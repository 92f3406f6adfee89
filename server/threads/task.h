/* One piece of work for another thread, and the way back to the loop's thread.
 *
 * A task is embedded in the object it serves and belongs to it; nothing is allocated to hand it
 * over. From pool_submit() until done() has been called it must not be touched by its owner. */
#ifndef SHEEN_THREADS_TASK_H
#define SHEEN_THREADS_TASK_H

#include <stdbool.h>
#include <sys/queue.h>

#include "server/base/error.h"
#include "server/net/loop.h"

struct task {
    void (*run)(struct task *task, void *context); /* on another thread, with its context */
    void (*done)(struct task *task);               /* on the loop's thread; may free the task */
    void *owner;
    STAILQ_ENTRY(task) link; /* of the queue that holds it */
};

STAILQ_HEAD(task_list, task);

/* Finished tasks on their way to the loop's thread: a locked list and an eventfd. The list holds no
 * more tasks than were submitted, and scheduler.h and store.h bound how many are. */
struct completions;

struct completions *completions_create(struct loop *loop, struct error *error);
void completions_destroy(struct completions *completions);                 /* NULL is safe */
void completions_post(struct completions *completions, struct task *task); /* any thread */
/* Calls done() of all finished tasks. The loop does this by itself; once the loop has stopped, the
 * daemon calls it a last time. */
void completions_deliver(struct completions *completions);

#endif
