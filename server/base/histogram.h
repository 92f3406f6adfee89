/* A histogram of durations with fixed memory: each power of two of microseconds is cut into
 * HISTOGRAM_SUB equal buckets, so that a percentile is right to 1 in 2 * HISTOGRAM_SUB, 3 %, from
 * 1 us to 2^HISTOGRAM_OCTAVES us (19 hours; longer ones count as that). Plain data, no thread. */
#ifndef SHEEN_BASE_HISTOGRAM_H
#define SHEEN_BASE_HISTOGRAM_H

#include <stdint.h>

#define HISTOGRAM_SUB 16
#define HISTOGRAM_OCTAVES 36
#define HISTOGRAM_BUCKETS (HISTOGRAM_SUB * (HISTOGRAM_OCTAVES - 3))

struct histogram {
    uint64_t n, sum_us;
    uint32_t buckets[HISTOGRAM_BUCKETS]; /* a bucket that is full stays full */
};

void histogram_add(struct histogram *histogram, uint64_t us);
/* Adds what `from` holds. */
void histogram_merge(struct histogram *histogram, const struct histogram *from);
/* The middle of the bucket under which a share `p` (0 to 1) of all lies; 0 when there is none. */
uint64_t histogram_percentile(const struct histogram *histogram, double p);
/* How many were below 2^exponent us. */
uint64_t histogram_below(const struct histogram *histogram, unsigned exponent);

#endif
