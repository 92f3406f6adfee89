/* A histogram of durations with fixed memory. Each power of two of microseconds is divided into
 * HISTOGRAM_SUB equal buckets, so that a percentile is exact to 1 / (2 * HISTOGRAM_SUB), about 3 %,
 * from 1 us to 2^HISTOGRAM_OCTAVES us (19 hours; longer durations count as that). Plain data. */
#ifndef SHEEN_BASE_HISTOGRAM_H
#define SHEEN_BASE_HISTOGRAM_H

#include <stdint.h>

#define HISTOGRAM_SUB 16
#define HISTOGRAM_OCTAVES 36
#define HISTOGRAM_BUCKETS (HISTOGRAM_SUB * (HISTOGRAM_OCTAVES - 3))

struct histogram {
    uint64_t n, sum_us;
    uint32_t buckets[HISTOGRAM_BUCKETS]; /* a bucket's count stops at UINT32_MAX */
};

void histogram_add(struct histogram *histogram, uint64_t us);
/* Adds all durations of `from`. */
void histogram_merge(struct histogram *histogram, const struct histogram *from);
/* The duration that a share `p` (0 to 1) of all do not exceed: the middle of its bucket, in
 * microseconds. 0 if there are none. */
uint64_t histogram_percentile(const struct histogram *histogram, double p);
/* The number of durations below 2^exponent us. */
uint64_t histogram_below(const struct histogram *histogram, unsigned exponent);

#endif
