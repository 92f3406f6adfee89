/* What a cage file goes through, from its bytes to its tables. */
#ifndef SHEEN_TESTS_FUZZ_CAGE_H
#define SHEEN_TESTS_FUZZ_CAGE_H

#include <stddef.h>

/* Reads, checks, hands it over as a worker does, and builds the tables of a small one. */
void fuzz_cage(const void *bytes, size_t size, const char *name);

#endif
