/* Parses whole numbers. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_NUMBER_H
#define SHEEN_PROTOCOL_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* Parses a decimal number from low to high; if `suffixes`, K, M, G and T multiply it by powers of
 * 1024. False if `value` is not such a number; then *number is undefined. */
bool number_parse(const char *value, uint64_t low, uint64_t high, bool suffixes, uint64_t *number);

#endif
