/* The number of processors that this process may use. Any thread. */
#ifndef SHEEN_BASE_PROCESSORS_H
#define SHEEN_BASE_PROCESSORS_H

/* The number of processors that the process may run on, or, if that is less, the average number
 * that its control group and the groups above it allow (cgroup v1 or v2, rounded up). At least 1.
 * `root` is a prefix of /proc and /sys: "", except in tests. */
unsigned processors_available(const char *root);

#endif
