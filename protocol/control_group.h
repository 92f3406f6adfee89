/* Limits that Linux's control groups put on this process, v1 or v2. Any thread. */
#ifndef SHEEN_PROTOCOL_CONTROL_GROUP_H
#define SHEEN_PROTOCOL_CONTROL_GROUP_H

#include <stdbool.h>
#include <stdint.h>

#define CONTROL_GROUP_PATH_BYTES 4096
#define CONTROL_GROUP_NO_LIMIT UINT64_MAX

/* What limits a group: a group's folder in, the limit that its files hold out, or
 * CONTROL_GROUP_NO_LIMIT. */
typedef uint64_t control_group_limit(const char *folder, bool v2);

/* The least limit of `controller` ("memory", "cpu") over this process's group and those above it;
 * CONTROL_GROUP_NO_LIMIT where none of them has one. `root` stands before /proc and /sys: "", but
 * for tests. */
uint64_t control_group_least(const char *root, const char *controller, control_group_limit *limit);

/* The number that a file of the folder begins with; CONTROL_GROUP_NO_LIMIT when there is none, as
 * in "max". */
uint64_t control_group_number(const char *folder, const char *file);

#endif
