/* How many processors this process may use. Any thread. */
#ifndef SHEEN_BASE_PROCESSORS_H
#define SHEEN_BASE_PROCESSORS_H

/* Those that the system lets the process run on, or as many as its control group may use in the
 * mean (cgroup v1 or v2, this group and those above it; rounded up), if that is less; at least 1.
 * `root` stands before /proc and /sys: "", but for tests. */
unsigned processors_available(const char *root);

#endif
