/* The whole path of a cage file, from its bytes to its tables. */
#ifndef SHEEN_TESTS_FUZZ_CAGE_H
#define SHEEN_TESTS_FUZZ_CAGE_H

#include <stddef.h>

/* Reads and checks a cage, passes it on like a worker program, and builds the tables of a small
 * one. */
void fuzz_cage(const void *bytes, size_t size, const char *name);

#endif
