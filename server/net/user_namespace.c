#include "server/net/user_namespace.h"

#include <inttypes.h>
#include <stdio.h>

#define DEFAULT_OVERFLOW 65534u
#define ALL_IDS UINT32_MAX /* ids 0 to UINT32_MAX - 1; the last number is not an id */

/* Reads lines of: first id inside, first id outside, count. The kernel ensures that they do not
 * overlap and that the ids outside are mapped in the surrounding namespace. */
static bool maps_all(const char *path)
{
    FILE *file = fopen(path, "re");
    if (!file)
        return false;
    uint64_t inside, outside, n, total = 0;
    int found;
    while ((found = fscanf(file, "%10" SCNu64 " %10" SCNu64 " %10" SCNu64 " ", &inside, &outside,
                           &n)) == 3 &&
           total < ALL_IDS)
        total += n;
    fclose(file);
    return found == EOF && total == ALL_IDS;
}

static uint32_t read_overflow(const char *path)
{
    FILE *file = fopen(path, "re");
    uint64_t id = UINT64_MAX;
    if (!file)
        return DEFAULT_OVERFLOW;
    bool ok = fscanf(file, "%10" SCNu64, &id) == 1 && id <= UINT32_MAX;
    fclose(file);
    return ok ? (uint32_t)id : DEFAULT_OVERFLOW;
}

struct user_namespace user_namespace_read(const char *map_path, const char *overflow_path)
{
    return (struct user_namespace){maps_all(map_path), read_overflow(overflow_path)};
}
