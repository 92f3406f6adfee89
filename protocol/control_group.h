/* Reads the limits that Linux control groups (v1 or v2) set for this process. Any thread. */
#ifndef SHEEN_PROTOCOL_CONTROL_GROUP_H
#define SHEEN_PROTOCOL_CONTROL_GROUP_H

#include <stdbool.h>
#include <stdint.h>

#define CONTROL_GROUP_PATH_BYTES 4096
#define CONTROL_GROUP_NO_LIMIT UINT64_MAX

/* Reads the limit of one group from the files of its folder; CONTROL_GROUP_NO_LIMIT if it has
 * none. */
typedef uint64_t control_group_limit(const char *folder, bool v2);

/* The smallest limit of `controller` ("memory" or "cpu") among this process's group and those above
 * it; CONTROL_GROUP_NO_LIMIT if none has one. `root` is a prefix of /proc and /sys: "", except in
 * tests. */
uint64_t control_group_least(const char *root, const char *controller, control_group_limit *limit);

/* The number at the start of a file of the folder; CONTROL_GROUP_NO_LIMIT if there is none, as in
 * "max". */
uint64_t control_group_number(const char *folder, const char *file);

#endif
