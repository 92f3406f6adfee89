/* Whole numbers as people write them. Pure, any thread. */
#ifndef SHEEN_PROTOCOL_NUMBER_H
#define SHEEN_PROTOCOL_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* A whole number from low to high; with suffixes K, M, G or T multiply by powers of 1024. */
bool number_parse(const char *value, uint64_t low, uint64_t high, bool suffixes, uint64_t *number);

#endif
