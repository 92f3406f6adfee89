/* How the process's descriptors are divided between clients and the work for them, so that the work for
 * a client that is connected never fails because others have come: where descriptors are scarce, fewer
 * clients are accepted and fewer jobs of worker programs run at once.
 * Thread: the loop's, while the daemon starts. */
#ifndef SHEEN_OPS_DESCRIPTORS_H
#define SHEEN_OPS_DESCRIPTORS_H

#include <stdint.h>

struct descriptors {
    uint64_t clients;
    unsigned jobs;   /* of worker programs, at once */
    unsigned probes; /* connections for health and metrics, at once */
};

/* Raises the process's limit of descriptors as far as the system allows, and divides what is not in use.
 * `wanted`: what all clients, jobs and probes together may ask for; the result is at most that, and at
 * least 1 of each. */
struct descriptors descriptors_divide(const struct descriptors *wanted);

#endif
