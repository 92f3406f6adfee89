#include "client/lib/machine_memory.h"

#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define PATH_BYTES 4096

/* The number that a file begins with; UINT64_MAX when there is none, as in "max". */
static uint64_t read_number(const char *path)
{
    uint64_t number;
    FILE *file = fopen(path, "re");
    if (!file)
        return UINT64_MAX;
    if (fscanf(file, "%20" SCNu64, &number) != 1)
        number = UINT64_MAX;
    fclose(file);
    return number;
}

static uint64_t total_bytes(const char *root)
{
    char path[PATH_BYTES], line[256];
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

/* The least limit of a group and those above it. Where a container shows its own group as the root,
 * the group's path is not there and its limit is at the root. */
static uint64_t least_limit(const char *root, const char *mount, char *group, const char *file)
{
    char path[PATH_BYTES];
    uint64_t least = UINT64_MAX;
    for (;;) {
        snprintf(path, sizeof(path), "%s/sys/fs/cgroup/%s%s/%s", root, mount, group, file);
        uint64_t limit = read_number(path);
        least = limit < least ? limit : least;
        char *slash = strrchr(group, '/');
        if (!slash)
            return least;
        *slash = 0;
    }
}

/* "memory" in "cpu,memory". */
static bool has_memory(const char *controllers)
{
    static const char name[] = "memory";
    const char *at = strstr(controllers, name);
    return at && (at == controllers || at[-1] == ',') && strchr(",", at[strlen(name)]);
}

static uint64_t group_bytes(const char *root)
{
    char path[PATH_BYTES], line[PATH_BYTES], *controllers, *group;
    uint64_t least = UINT64_MAX;
    snprintf(path, sizeof(path), "%s/proc/self/cgroup", root);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof(line), file)) { /* "4:memory:/a/b" or "0::/a/b" */
        line[strcspn(line, "\n")] = 0;
        if (!(controllers = strchr(line, ':')) || !(group = strchr(controllers + 1, ':')))
            continue;
        *group++ = 0;
        controllers++;
        uint64_t limit = UINT64_MAX;
        if (!*controllers)
            limit = least_limit(root, "", group, "memory.max");
        else if (has_memory(controllers))
            limit = least_limit(root, "memory", group, "memory.limit_in_bytes");
        least = limit < least ? limit : least;
    }
    if (file)
        fclose(file);
    return least;
}

uint64_t machine_memory_bytes(const char *root)
{
    uint64_t total = total_bytes(root), group = group_bytes(root);
    uint64_t least = total < group ? total : group;
    return least == UINT64_MAX ? 0 : least;
}
