/* A process that has loaded its libraries and then only forks: one sandboxed child a job, so that a
 * job does not wait for them, and nothing of one job is left for the next.
 *
 * It reads nothing but jobs from its own daemon, and ends when the daemon has closed the socket;
 * its children end with it. */
#ifndef SHEEN_SANDBOX_ZYGOTE_H
#define SHEEN_SANDBOX_ZYGOTE_H

#include "server/sandbox/job.h"

#define ZYGOTE_MAX_CHILDREN 512 /* at once; further jobs wait */
/* Exit codes of a child that has given no answer. */
#define ZYGOTE_EXIT_NO_SANDBOX 70
#define ZYGOTE_EXIT_NO_INPUT 71
#define ZYGOTE_EXIT_NO_ANSWER 72

/* A kind of job that a worker takes. run() works in the child and writes a whole answer (job.h). */
struct zygote_task {
    void (*run)(struct source *input, struct sink *answer);
    bool opens_files; /* its input is the daemon's own and it needs the file system: no seccomp */
};

/* Where the daemon puts the socket. */
#define ZYGOTE_FD 3

/* main() of a worker program: serves the SEQPACKET socket ZYGOTE_FD until its peer closes it.
 * tasks[kind].run is NULL where a kind is not taken. Returns the exit code: 0; 1 when it cannot go
 * on; 2 when it was not started by sheend. The latter two after a line on standard error. */
int zygote_main(int argc, char **argv, const struct zygote_task tasks[static N_JOB_KINDS]);

#endif
