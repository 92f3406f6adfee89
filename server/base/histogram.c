#include "server/base/histogram.h"

/* Below HISTOGRAM_SUB us every microsecond has its own bucket; above, each octave has HISTOGRAM_SUB
 * buckets. 2^4 == HISTOGRAM_SUB. */
static unsigned bucket_of(uint64_t us)
{
    if (us < HISTOGRAM_SUB)
        return (unsigned)us;
    unsigned octave = 63u - (unsigned)__builtin_clzll(us);
    if (octave >= HISTOGRAM_OCTAVES)
        return HISTOGRAM_BUCKETS - 1;
    return HISTOGRAM_SUB * (octave - 3) + (unsigned)(us >> (octave - 4) & (HISTOGRAM_SUB - 1));
}

static uint64_t middle_of(unsigned bucket)
{
    if (bucket < HISTOGRAM_SUB)
        return bucket;
    unsigned octave = bucket / HISTOGRAM_SUB + 3;
    uint64_t width = 1ull << (octave - 4);
    return (1ull << octave) + width * (bucket % HISTOGRAM_SUB) + width / 2;
}

void histogram_add(struct histogram *histogram, uint64_t us)
{
    uint32_t *bucket = &histogram->buckets[bucket_of(us)];
    histogram->n++;
    histogram->sum_us += us;
    *bucket += *bucket < UINT32_MAX;
}

void histogram_merge(struct histogram *histogram, const struct histogram *from)
{
    histogram->n += from->n;
    histogram->sum_us += from->sum_us;
    for (unsigned i = 0; i < HISTOGRAM_BUCKETS; i++) {
        uint64_t sum = (uint64_t)histogram->buckets[i] + from->buckets[i];
        histogram->buckets[i] = sum < UINT32_MAX ? (uint32_t)sum : UINT32_MAX;
    }
}

uint64_t histogram_percentile(const struct histogram *histogram, double p)
{
    uint64_t passed = 0;
    double wanted = p * (double)histogram->n;
    for (unsigned i = 0; i < HISTOGRAM_BUCKETS; i++) {
        passed += histogram->buckets[i];
        if (passed > 0 && (double)passed >= wanted)
            return middle_of(i);
    }
    return 0;
}

uint64_t histogram_below(const struct histogram *histogram, unsigned exponent)
{
    uint64_t n = 0;
    unsigned end = exponent < HISTOGRAM_OCTAVES ? bucket_of(1ull << exponent) : HISTOGRAM_BUCKETS;
    for (unsigned i = 0; i < end; i++)
        n += histogram->buckets[i];
    return n;
}
