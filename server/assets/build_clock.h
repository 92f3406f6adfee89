/* Limits the cost of building a model's tables. A clock measures one thread's part of a build and
 * gives it a limit_watch (watch.h), which ends the build when the daemon ends, when all parts
 * together have used too much processor time, or when the tables will not fit into the memory
 * budget. A cage of a few megabytes can be made to cost hours.
 *
 * The clock also calls pool_beat(), so that a thread that builds for long does not count as stuck.
 * Thread: the one that started the clock. */
#ifndef SHEEN_ASSETS_BUILD_CLOCK_H
#define SHEEN_ASSETS_BUILD_CLOCK_H

#include "server/surface/watch.h"
#include "server/assets/build.h"

struct build_clock {
    const struct build_order *order;
    atomic_ullong *spent_us; /* processor time of all parts of the build; owned by the caller */
    uint64_t looked_us;      /* time of the last measurement */
    uint64_t cpu_us;         /* processor time of this thread at that time */
};

/* Starts the clock. `order` and `spent_us` must outlive it. */
void build_clock_start(struct build_clock *clock, const struct build_order *order,
                       atomic_ullong *spent_us);

/* The watch for the code that the clock measures. It stops the code with ERROR_MODEL if the parts
 * have used order->tables_cpu_us or the tables need more than order->may_need() allows, and with
 * ERROR_SERVER if the daemon ends. */
struct limit_watch build_clock_watch(struct build_clock *clock);

#endif
