/* The daemon's monotonic clock. Any thread. */
#ifndef SHEEN_BASE_CLOCK_H
#define SHEEN_BASE_CLOCK_H

#include <stdint.h>

/* Microseconds since an undefined moment; never goes back. */
uint64_t clock_now_us(void);

#endif
