#include "protocol/control_group.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

uint64_t control_group_number(const char *folder, const char *name)
{
    char path[CONTROL_GROUP_PATH_BYTES + 64];
    uint64_t number;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "re");
    if (!file)
        return CONTROL_GROUP_NO_LIMIT;
    if (fscanf(file, "%20" SCNu64, &number) != 1)
        number = CONTROL_GROUP_NO_LIMIT;
    fclose(file);
    return number;
}

/* The smallest limit of a group and those above it. In a container the group's path may not exist,
 * because the container shows its own group as the root; then the root has the limit. `group` is
 * shortened on the way up. */
static uint64_t least_above(const char *root, const char *mount, char *group,
                            control_group_limit *limit)
{
    char folder[CONTROL_GROUP_PATH_BYTES];
    uint64_t least = CONTROL_GROUP_NO_LIMIT;
    for (;;) {
        snprintf(folder, sizeof folder, "%s/sys/fs/cgroup/%s%s", root, mount, group);
        uint64_t found = limit(folder, !*mount);
        least = found < least ? found : least;
        char *slash = strrchr(group, '/');
        if (!slash)
            return least;
        *slash = 0;
    }
}

/* True if a list such as "cpu,memory" contains the controller. */
static bool has_controller(const char *list, const char *name)
{
    size_t n = strlen(name);
    for (const char *at = list; (at = strstr(at, name)); at += n)
        if ((at == list || at[-1] == ',') && strchr(",", at[n]))
            return true;
    return false;
}

uint64_t control_group_least(const char *root, const char *controller, control_group_limit *limit)
{
    char path[CONTROL_GROUP_PATH_BYTES], line[CONTROL_GROUP_PATH_BYTES], *controllers, *group;
    uint64_t least = CONTROL_GROUP_NO_LIMIT;
    snprintf(path, sizeof path, "%s/proc/self/cgroup", root);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) { /* "4:memory:/a/b" or "0::/a/b" */
        line[strcspn(line, "\n")] = 0;
        if (!(controllers = strchr(line, ':')) || !(group = strchr(controllers + 1, ':')))
            continue;
        *group++ = 0;
        controllers++;
        uint64_t found = CONTROL_GROUP_NO_LIMIT;
        if (!*controllers)
            found = least_above(root, "", group, limit);
        else if (has_controller(controllers, controller))
            found = least_above(root, controller, group, limit);
        least = found < least ? found : least;
    }
    if (file)
        fclose(file);
    return least;
}
