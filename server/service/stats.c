#include "server/service/stats.h"

#include "server/service/loop.h"

void stats_init(struct stats *stats)
{
    *stats = (struct stats){.start_us = loop_now_us()};
}

void stats_frame(struct stats *stats, const sheen_Times *times)
{
    stats->last[stats->frames++ % STATS_FRAMES] = *times;
}

sheen_Times stats_mean(const struct stats *stats)
{
    sheen_Times mean = sheen_Times_init_zero;
    uint64_t n = stats->frames < STATS_FRAMES ? stats->frames : STATS_FRAMES;
    if (n == 0)
        return mean;
    for (uint64_t i = 0; i < n; i++) {
        const sheen_Times *t = &stats->last[i];
        mean.tables_us += t->tables_us;
        mean.visibility_us += t->visibility_us;
        mean.evaluate_us += t->evaluate_us;
        mean.shade_us += t->shade_us;
        mean.readback_us += t->readback_us;
        mean.encode_us += t->encode_us;
        mean.total_us += t->total_us;
    }
    return (sheen_Times){mean.tables_us / n, mean.visibility_us / n, mean.evaluate_us / n,
                         mean.shade_us / n,  mean.readback_us / n,   mean.encode_us / n,
                         mean.total_us / n};
}
