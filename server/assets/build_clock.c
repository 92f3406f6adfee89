#include "server/assets/build_clock.h"

#include <time.h>

#include "server/base/clock.h"

/* Measure only this often, because reading a thread's time is a system call. */
#define LOOK_US 5000u

static uint64_t thread_cpu_us(void)
{
    struct timespec used;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
    return (uint64_t)used.tv_sec * 1000000u + (uint64_t)used.tv_nsec / 1000u;
}

void build_clock_start(struct build_clock *clock, const struct build_order *order,
                       atomic_ullong *spent_us)
{
    *clock = (struct build_clock){order, spent_us, clock_now_us(), thread_cpu_us()};
}

static bool goes_on(void *owner, struct error *error)
{
    struct build_clock *clock = owner;
    const struct build_order *order = clock->order;
    uint64_t now_us = clock_now_us();
    if (now_us - clock->looked_us < LOOK_US)
        return true;
    uint64_t cpu_us = thread_cpu_us(), more_us = cpu_us - clock->cpu_us;
    uint64_t spent_us = atomic_fetch_add(clock->spent_us, more_us) + more_us;
    clock->looked_us = now_us;
    clock->cpu_us = cpu_us;
    pool_beat();
    if (atomic_load(order->cancelled))
        return error_set(error, ERROR_SERVER, "the daemon is shutting down");
    return spent_us <= order->tables_cpu_us ||
           error_set(error, ERROR_MODEL,
                     "its tables take more than %llu s of processor time (--tables-cpu): it is not "
                     "taken; vertices of fewer faces cost less",
                     (unsigned long long)(order->tables_cpu_us / 1000000));
}

static bool may_need(void *owner, const struct limit_size *size, struct error *error)
{
    const struct build_clock *clock = owner;
    const struct renderer_device *device = render_thread_device(clock->order->render_thread);
    struct limit_tables tables = {.on_demand = renderer_takes_tables_on_demand(device),
                                  .n_faces = size->n_faces,
                                  .n_nodes = size->n_nodes,
                                  .n_texels = size->n_texels,
                                  .n_bounds = size->n_bounds};
    memcpy(tables.count, size->count, sizeof tables.count);
    return build_may_need_model(clock->order, &tables, size->plan_bytes, error);
}

struct limit_watch build_clock_watch(struct build_clock *clock)
{
    return (struct limit_watch){goes_on, may_need, clock};
}
