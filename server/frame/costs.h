/* What tiles cost the device, learned from those that have been drawn: microseconds a pixel by what
 * makes frames alike (model, planes, lights). Pure. Thread: one at a time. */
#ifndef SHEEN_FRAME_COSTS_H
#define SHEEN_FRAME_COSTS_H

#include <stdint.h>

#define COSTS_SLOTS 256u

struct costs {
    struct {
        uint64_t key;
        double us_per_px; /* moving average; 0: a free place */
    } slot[COSTS_SLOTS];
    double us_per_px; /* of all, for what has not been drawn yet; 0: nothing has */
};

/* The expected time of a tile; COSTS_UNKNOWN_US when nothing at all has been drawn. */
#define COSTS_UNKNOWN_US 10000u
uint64_t costs_estimate(const struct costs *costs, uint64_t key, uint64_t px);

/* A tile took so long. */
void costs_learn(struct costs *costs, uint64_t key, uint64_t px, uint64_t us);

/* A key that mixes another value in; begin with 0. */
uint64_t costs_key(uint64_t key, uint64_t value);

#endif
