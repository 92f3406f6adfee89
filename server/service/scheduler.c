#include "server/service/scheduler.h"

#include <stddef.h>

void scheduler_add_queue(struct scheduler *scheduler, struct schedule_queue *queue)
{
    *queue = (struct schedule_queue){.next = queue, .previous = queue};
    if (!scheduler->turn) {
        scheduler->turn = queue;
        return;
    }
    queue->next = scheduler->turn; /* last in the round */
    queue->previous = scheduler->turn->previous;
    queue->previous->next = queue;
    queue->next->previous = queue;
}

/* Entries in flight find their queue through the pointer: the owner of the queue clears it. */
void scheduler_remove_queue(struct scheduler *scheduler, struct schedule_queue *queue,
                            void (*drop)(struct schedule_entry *entry))
{
    for (struct schedule_entry *entry; (entry = queue->head);) {
        queue->head = entry->next;
        entry->queue = NULL;
        scheduler->waiting--;
        drop(entry);
    }
    queue->previous->next = queue->next;
    queue->next->previous = queue->previous;
    if (scheduler->turn == queue)
        scheduler->turn = queue->next == queue ? NULL : queue->next;
}

void scheduler_push(struct scheduler *scheduler, struct schedule_queue *queue,
                    struct schedule_entry *entry)
{
    entry->queue = queue;
    entry->next = NULL;
    if (queue->head)
        queue->tail->next = entry;
    else
        queue->head = entry;
    queue->tail = entry;
    scheduler->waiting++;
}

struct schedule_entry *scheduler_next(struct scheduler *scheduler)
{
    struct schedule_queue *queue = scheduler->turn;
    if (!queue || scheduler->in_flight >= SCHEDULER_IN_ALL)
        return NULL;
    do {
        struct schedule_entry *entry = queue->head;
        if (entry && !queue->held && queue->in_flight < SCHEDULER_PER_QUEUE) {
            queue->head = entry->next;
            queue->in_flight++;
            scheduler->in_flight++;
            scheduler->waiting--;
            scheduler->turn = queue->next;
            return entry;
        }
        queue = queue->next;
    } while (queue != scheduler->turn);
    return NULL;
}

void scheduler_finished(struct scheduler *scheduler, struct schedule_entry *entry)
{
    scheduler->in_flight--;
    if (entry->queue)
        entry->queue->in_flight--;
}
