/* Entries of the scheduler for its tests, which need no device and no session. */
#ifndef SHEEN_TESTS_SCHEDULE_ENTRIES_H
#define SHEEN_TESTS_SCHEDULE_ENTRIES_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/frame/scheduler.h"

static inline struct schedule_entry entry_of(enum request_class request_class, uint64_t estimate_us)
{
    return (struct schedule_entry){.request_class = request_class, .estimate_us = estimate_us};
}

static inline struct schedule_entry view_of(enum request_class request_class, uint32_t view)
{
    return (struct schedule_entry){
        .request_class = request_class, .has_view = true, .view = view, .estimate_us = 1000};
}

/* The queue of a client that has no other queue. */
static inline void add_queue(struct schedule_queue *queue)
{
    static struct schedule_party parties[1024];
    static unsigned n;
    struct schedule_party *party = &parties[n++ % 1024];
    scheduler_add_party(party);
    scheduler_add_queue(queue, party);
}

static inline void ask(struct scheduler *scheduler, struct schedule_queue *queue,
                       struct schedule_entry *entry)
{
    assert_null(scheduler_enter(scheduler, queue, entry));
    scheduler_ready(entry);
}

/* Takes the entry's next turn, draws its whole frame as one tile, and finishes the entry. */
static inline void draw_whole(struct scheduler *scheduler, struct schedule_entry *entry,
                              uint64_t us)
{
    scheduler_stepped(scheduler, entry, us, false);
    scheduler_finished(scheduler, entry);
}

static inline void assert_is_empty(const struct scheduler *scheduler)
{
    assert_int_equal(scheduler->waiting + scheduler->on_device, 0);
    for (int c = 0; c < N_CLASSES; c++) {
        assert_null(scheduler->classes[c].parts.first);
        assert_int_equal(scheduler->classes[c].begun, 0);
    }
}

#endif
