/* The daemon's clock. Any thread. */
#ifndef SHEEN_BASE_CLOCK_H
#define SHEEN_BASE_CLOCK_H

#include <stdint.h>

/* Microseconds of a clock that never goes back; where it begins is undefined. */
uint64_t clock_now_us(void);

#endif
