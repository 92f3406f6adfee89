/* Allocations that fail where the input says. The linker's --wrap redirects each function below to
 * its wrapper here. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/fuzz.h"

#define ALL_FROM_THERE 0x8000u

static bool active, spared, failed, all_from_there;
static unsigned n_until_failure; /* allocations up to the one that fails; 0: none fails */

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *block, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t most);

static bool must_fail(void)
{
    if (!active || spared || n_until_failure == 0)
        return false;
    if (n_until_failure > 1) {
        n_until_failure--;
        return false;
    }
    n_until_failure = all_from_there ? 1 : 0;
    failed = true;
    errno = ENOMEM;
    return true;
}

void *__wrap_malloc(size_t size)
{
    return must_fail() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return must_fail() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *block, size_t size)
{
    return must_fail() ? NULL : __real_realloc(block, size);
}

char *__wrap_strndup(const char *text, size_t most)
{
    size_t length = strnlen(text, most);
    char *copy = __wrap_malloc(length + 1);
    if (!copy)
        return NULL;
    memcpy(copy, text, length);
    copy[length] = 0;
    return copy;
}

char *__wrap_strdup(const char *text)
{
    return __wrap_strndup(text, strlen(text));
}

void fuzz_spare_memory(bool is_spared)
{
    spared = is_spared;
}

bool fuzz_memory_failed(void)
{
    return failed;
}

void fuzz_fail(const char *what, const char *file, int line)
{
    active = false;
    fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
    abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size < 2)
        return 0;
    unsigned chosen = bytes[0] | (unsigned)bytes[1] << 8;
    all_from_there = (chosen & ALL_FROM_THERE) != 0;
    n_until_failure = chosen & ~ALL_FROM_THERE;
    /* A copy of exactly this size, so that a sanitizer finds reads beyond its end. */
    uint8_t *copy = __real_malloc(size - 2 ? size - 2 : 1);
    memcpy(copy, bytes + 2, size - 2);
    failed = false;
    active = true;
    fuzz_one(copy, size - 2);
    active = false;
    free(copy);
    return 0;
}
