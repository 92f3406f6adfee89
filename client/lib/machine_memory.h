/* How much main memory programs of this machine may use. */
#ifndef SHEEN_CLIENT_MACHINE_MEMORY_H
#define SHEEN_CLIENT_MACHINE_MEMORY_H

#include <stdint.h>

/* What the machine has, or its control group may take (cgroup v1 or v2, this group and those above
 * it), if that is less; 0 when nothing is known. `root` stands before /proc and /sys: "", but for
 * tests. Any thread. */
uint64_t machine_memory_bytes(const char *root);

#endif
