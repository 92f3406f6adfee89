/* What one thread's part of building a model's tables has cost so far: a limit_watch (watch.h)
 * that ends the build when the daemon does, when all its parts together have taken too much of
 * the processors, or when its tables will not fit into the memory budget. A cage of a few megabytes
 * can be made to cost hours.
 *
 * The clock calls pool_beat(), so that a thread that builds for long is not taken for stuck.
 * Thread: the one that has started the clock. */
#ifndef SHEEN_ASSETS_BUILD_CLOCK_H
#define SHEEN_ASSETS_BUILD_CLOCK_H

#include "server/surface/watch.h"
#include "server/assets/build.h"

struct build_clock {
    const struct build_order *order;
    atomic_ullong *spent_us; /* by all parts of the build; the caller's */
    uint64_t looked_us;      /* when the clock was looked at last */
    uint64_t cpu_us;         /* the thread's own by then */
};

/* Both must outlive the clock. */
void build_clock_start(struct build_clock *clock, const struct build_order *order,
                       atomic_ullong *spent_us);

/* The watch of the part that the clock measures. ERROR_MODEL: the parts have taken
 * order->tables_cpu_us, or the tables need more than order->may_need() allows; ERROR_SERVER: the
 * daemon is shutting down. */
struct limit_watch build_clock_watch(struct build_clock *clock);

#endif
