/* Measures the processor time of the calling thread. */
#ifndef SHEEN_RENDER_NATIVE_TIMES_H
#define SHEEN_RENDER_NATIVE_TIMES_H

#include <stdint.h>
#include <time.h>

static inline uint64_t times_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

/* Adds the time since *since to *total, and sets *since to now. Nanoseconds. */
static inline void times_add(uint64_t *total, uint64_t *since)
{
    uint64_t now = times_now();
    *total += now - *since;
    *since = now;
}

#endif
