/* The functions that write the defaults of sheen.h's structs, for C++ and other languages. */
#include <string.h>

#include "client/lib/sheen.h"

#define LEAST_BYTES 16

/* Zeroes the struct first, so that padding is zero too: a newer library may read it as members. */
static void fill(void *theirs, size_t size, const void *defaults, size_t n_defaults)
{
    if (!theirs || size < LEAST_BYTES)
        return;
    memset(theirs, 0, size);
    memcpy(theirs, defaults, size < n_defaults ? size : n_defaults);
    memcpy(theirs, &size, sizeof(size));
}

void sheen_struct_init(void *sized_struct, size_t size)
{
    fill(sized_struct, size, "", 0);
}

void sheen_connect_options_init(struct sheen_connect_options *options, size_t size)
{
    const struct sheen_connect_options defaults = SHEEN_CONNECT_DEFAULTS;
    fill(options, size, &defaults, sizeof(defaults));
}

void sheen_request_init(struct sheen_request *request, size_t size)
{
    const struct sheen_request defaults = SHEEN_REQUEST_DEFAULTS;
    fill(request, size, &defaults, sizeof(defaults));
}

void sheen_pattern_init(struct sheen_pattern *pattern)
{
    if (pattern)
        *pattern = SHEEN_PATTERN_DEFAULTS;
}
