#include "server/base/processors.h"

#include <inttypes.h>
#include <sched.h>
#include <stdio.h>

#include "protocol/control_group.h"

/* cpu.max of cgroup v2: "QUOTA PERIOD" or "max PERIOD", microseconds. */
static bool read_v2(const char *folder, uint64_t *quota, uint64_t *period)
{
    char path[CONTROL_GROUP_PATH_BYTES + 16];
    snprintf(path, sizeof path, "%s/cpu.max", folder);
    FILE *file = fopen(path, "re");
    if (!file)
        return false;
    bool read = fscanf(file, "%20" SCNu64 " %20" SCNu64, quota, period) == 2;
    fclose(file);
    return read;
}

/* The limit in processors, rounded up. In v1 a quota of -1 means none; read as unsigned it exceeds
 * any period. */
static uint64_t limit_processors(const char *folder, bool v2)
{
    uint64_t quota = 0, period = 0;
    if (v2 && !read_v2(folder, &quota, &period))
        return CONTROL_GROUP_NO_LIMIT;
    if (!v2) {
        quota = control_group_number(folder, "cpu.cfs_quota_us");
        period = control_group_number(folder, "cpu.cfs_period_us");
    }
    if (quota == 0 || quota > INT64_MAX || period == 0 || period > INT64_MAX)
        return CONTROL_GROUP_NO_LIMIT;
    return (quota + period - 1) / period;
}

unsigned processors_available(const char *root)
{
    cpu_set_t set;
    int n = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
    uint64_t limit = control_group_least(root, "cpu", limit_processors);
    unsigned processors = n < 1 ? 1 : (unsigned)n;
    return limit < processors ? (unsigned)limit : processors;
}
