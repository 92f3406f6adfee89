#include "client/lib/machine_memory.h"

#include <inttypes.h>
#include <stdio.h>

#include "protocol/control_group.h"

static uint64_t total_bytes(const char *root)
{
    char path[CONTROL_GROUP_PATH_BYTES], line[256];
    uint64_t kib = 0;
    snprintf(path, sizeof(path), "%s/proc/meminfo", root);
    FILE *file = fopen(path, "re");
    if (!file)
        return UINT64_MAX;
    while (kib == 0 && fgets(line, sizeof(line), file))
        if (sscanf(line, "MemTotal: %20" SCNu64, &kib) != 1)
            kib = 0;
    fclose(file);
    return kib > 0 && kib < UINT64_MAX / 1024 ? kib * 1024 : UINT64_MAX;
}

static uint64_t limit_bytes(const char *folder, bool v2)
{
    return control_group_number(folder, v2 ? "memory.max" : "memory.limit_in_bytes");
}

uint64_t machine_memory_bytes(const char *root)
{
    uint64_t total = total_bytes(root), group = control_group_least(root, "memory", limit_bytes);
    uint64_t least = total < group ? total : group;
    return least == UINT64_MAX ? 0 : least;
}
