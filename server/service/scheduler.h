/* Which waiting render runs next: first in, first out within a session, round robin among
 * sessions, at most two in flight per session and a few altogether.
 *
 * Pure bookkeeping over nodes embedded in their owners: no descriptor, no thread, no clock, no
 * allocation. The bound on what is in flight bounds the queues of the GL thread and of the pool,
 * and the memory that finished frames take. Thread: one at a time. */
#ifndef SHEEN_SERVICE_SCHEDULER_H
#define SHEEN_SERVICE_SCHEDULER_H

#include <stdbool.h>

#define SCHEDULER_PER_QUEUE 2u /* one renders while the one before is encoded */
#define SCHEDULER_IN_ALL 4u    /* keeps the GL thread and the pool busy, no more */

struct schedule_queue;

struct schedule_entry {
    struct schedule_queue *queue; /* NULL once its session has gone */
    struct schedule_entry *next;
    void *owner;
};

struct schedule_queue { /* one per session */
    struct schedule_entry *head, *tail;
    unsigned in_flight;
    bool held; /* the session cannot take more output now: start nothing for it */
    struct schedule_queue *next, *previous; /* ring of all queues */
};

struct scheduler {
    struct schedule_queue *turn; /* whose turn it is; NULL without queues */
    unsigned waiting, in_flight;
};

void scheduler_add_queue(struct scheduler *scheduler, struct schedule_queue *queue);

/* Takes the queue out. Entries in flight go on without it; those that wait are handed to drop(). */
void scheduler_remove_queue(struct scheduler *scheduler, struct schedule_queue *queue,
                            void (*drop)(struct schedule_entry *entry));

void scheduler_push(struct scheduler *scheduler, struct schedule_queue *queue,
                    struct schedule_entry *entry);

/* The next entry to start, now in flight, or NULL when none may. */
struct schedule_entry *scheduler_next(struct scheduler *scheduler);

/* An entry that scheduler_next() returned has been answered or given up. */
void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry);

#endif
