#include "server/frame/costs.h"

#include <stdbool.h>

#define NEWEST 0.25 /* weight of the latest measurement */

uint64_t costs_key(uint64_t key, uint64_t value)
{
    key = (key ^ value) * 0x9e3779b97f4a7c15u;
    return key ^ key >> 29;
}

uint64_t costs_estimate(const struct costs *costs, uint64_t key, uint64_t px)
{
    uint64_t place = key % COSTS_SLOTS;
    bool known = costs->slot[place].key == key && costs->slot[place].us_per_px > 0;
    double us_per_px = known ? costs->slot[place].us_per_px : costs->us_per_px;
    return us_per_px > 0 ? (uint64_t)(us_per_px * (double)px) : COSTS_UNKNOWN_US;
}

static double average(double before, double latest)
{
    return before > 0 ? before + NEWEST * (latest - before) : latest;
}

/* Keys that share a slot replace each other: what is drawn often stays known. */
void costs_learn(struct costs *costs, uint64_t key, uint64_t px, uint64_t us)
{
    uint64_t place = key % COSTS_SLOTS;
    double us_per_px = (double)(us > 0 ? us : 1) / (double)px;
    double before = costs->slot[place].key == key ? costs->slot[place].us_per_px : 0;
    costs->slot[place].key = key;
    costs->slot[place].us_per_px = average(before, us_per_px);
    costs->us_per_px = average(costs->us_per_px, us_per_px);
}
