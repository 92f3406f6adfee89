/* Predicts how long the device takes for a tile, from the times of earlier tiles: a moving average
 * of microseconds per pixel for each key. Frames that cost alike have the same key (model, planes,
 * lights). Plain data.
 * Thread: one at a time. */
#ifndef SHEEN_FRAME_COSTS_H
#define SHEEN_FRAME_COSTS_H

#include <stdint.h>

#define COSTS_SLOTS 256u

struct costs {
    struct {
        uint64_t key;
        double us_per_px; /* moving average; 0: the slot is free */
    } slot[COSTS_SLOTS];
    double us_per_px; /* average of all tiles, for unknown keys; 0: nothing was drawn yet */
};

/* The expected time of a tile of `px` pixels in microseconds; COSTS_UNKNOWN_US before the first
 * tile. */
#define COSTS_UNKNOWN_US 10000u
uint64_t costs_estimate(const struct costs *costs, uint64_t key, uint64_t px);

/* Records that a tile of `px` pixels took `us` microseconds. */
void costs_learn(struct costs *costs, uint64_t key, uint64_t px, uint64_t us);

/* Returns `key` with another value mixed in. Start with 0. */
uint64_t costs_key(uint64_t key, uint64_t value);

#endif
