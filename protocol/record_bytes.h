/* The bytes of records behind answers: little-endian numbers, and what all records check. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_RECORD_BYTES_H
#define SHEEN_PROTOCOL_RECORD_BYTES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "protocol/limits.h"

/* Writes n bytes of a whole number, or a double. Returns the byte behind them. */
static inline uint8_t *record_put(uint8_t *to, uint64_t value, unsigned n)
{
    for (unsigned i = 0; i < n; i++)
        to[i] = (uint8_t)(value >> (8 * i));
    return to + n;
}

/* Reads n bytes, or a double, and moves *from behind them. */
static inline uint64_t record_take(const uint8_t **from, unsigned n)
{
    uint64_t value = 0;
    for (unsigned i = 0; i < n; i++)
        value |= (uint64_t)(*from)[i] << (8 * i);
    *from += n;
    return value;
}

static inline uint8_t *record_put_double(uint8_t *to, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return record_put(to, bits, 8);
}

static inline double record_take_double(const uint8_t **from)
{
    uint64_t bits = record_take(from, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Checks of numbers that a peer sent. */
static inline bool record_is_length(double value)
{
    return value >= 0 && isfinite(value);
}

static inline bool record_is_point(const double point[3])
{
    return fabs(point[0]) <= PROTOCOL_MAX_COORDINATE && fabs(point[1]) <= PROTOCOL_MAX_COORDINATE &&
           fabs(point[2]) <= PROTOCOL_MAX_COORDINATE;
}

#endif
