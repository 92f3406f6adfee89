/* What every fuzz target has: one function that takes one input, and memory that runs out.
 *
 * An input begins with two bytes (little-endian) that choose the allocation that fails: 0 none, n
 * the n-th of this input, and with the top bit all from there on. The rest is the target's. Built
 * with libFuzzer (make fuzz), or with tests/fuzz/replay.c to run the corpora (make check). */
#ifndef SHEEN_TESTS_FUZZ_H
#define SHEEN_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Implemented by the target. Must leave no allocation and no state. */
void fuzz_one(const uint8_t *bytes, size_t size);

/* Ends the process, which the fuzzer reports, if the condition is false. */
#define MUST(condition)                                                                            \
    do {                                                                                           \
        if (!(condition))                                                                          \
            fuzz_fail(#condition, __FILE__, __LINE__);                                             \
    } while (0)
__attribute__((noreturn)) void fuzz_fail(const char *what, const char *file, int line);

/* True if an allocation has failed for this input; further ones may fail that the input does not
 * name. */
bool fuzz_memory_failed(void);

/* Switches failing allocations off or on, for a library that would end the process. */
void fuzz_spare_memory(bool spared);

/* libFuzzer's entry: in alloc_fail.c for all targets. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

#ifdef __cplusplus
}
#endif

#endif
