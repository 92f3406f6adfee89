#include "client/lib/sized.h"

#include <string.h>

#include "client/lib/status.h"

#define LEAST_BYTES 16
#define MOST_BYTES ((size_t)1 << 20) /* a size that was never set is usually larger */

static size_t size_of(const void *theirs)
{
    size_t size;
    memcpy(&size, theirs, sizeof(size));
    return size;
}

enum sheen_status sized_check(const void *theirs, const char *name, struct sheen_error *error)
{
    if (!theirs)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s is NULL", name);
    size_t size = size_of(theirs);
    if (size >= LEAST_BYTES && size <= MOST_BYTES)
        return SHEEN_OK;
    return status_set(error, SHEEN_BAD_ARGUMENT,
                      "%s.size is %zu: begin with the struct's defaults, which set it", name, size);
}

enum sheen_status sized_take(void *ours, size_t n_ours, const void *theirs, const char *name,
                             struct sheen_error *error)
{
    enum sheen_status status = sized_check(theirs, name, error);
    if (status)
        return status;
    const uint8_t *bytes = theirs;
    size_t n_theirs = size_of(theirs);
    for (size_t i = n_ours; i < n_theirs; i++)
        if (bytes[i])
            return status_set(error, SHEEN_BAD_ARGUMENT,
                              "%s asks for what libsheen " SHEEN_VERSION
                              " does not have: the program was compiled for a newer one",
                              name);
    memcpy(ours, theirs, n_theirs < n_ours ? n_theirs : n_ours);
    memcpy(ours, &n_ours, sizeof(n_ours));
    return SHEEN_OK;
}

void sized_give(void *theirs, const void *ours, size_t n_ours)
{
    uint8_t *to = theirs;
    const uint8_t *from = ours;
    size_t n_theirs = size_of(theirs), n = n_theirs < n_ours ? n_theirs : n_ours;
    memcpy(to + sizeof(size_t), from + sizeof(size_t), n - sizeof(size_t));
    memset(to + n, 0, n_theirs - n);
}
