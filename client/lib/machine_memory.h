/* The main memory that programs on this machine may use. */
#ifndef SHEEN_CLIENT_MACHINE_MEMORY_H
#define SHEEN_CLIENT_MACHINE_MEMORY_H

#include <stdint.h>

/* The bytes of the machine's memory, or, if that is less, the limit of the control group (cgroup v1
 * or v2; this group and those above it); 0 if unknown. `root` is a prefix of /proc and /sys: "",
 * except in tests. Any thread. */
uint64_t machine_memory_bytes(const char *root);

#endif
