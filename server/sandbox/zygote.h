/* The main loop of a worker program. The process loads its libraries once and then forks one
 * sandboxed child for each job. So no job waits for libraries to load, and nothing of one job is
 * left for the next.
 *
 * The process reads only jobs from its own daemon. It ends when the daemon closes the socket, and
 * its children end with it. */
#ifndef SHEEN_SANDBOX_ZYGOTE_H
#define SHEEN_SANDBOX_ZYGOTE_H

#include "server/sandbox/job.h"

#define ZYGOTE_MAX_CHILDREN 512 /* at the same time; further jobs wait */
/* Exit codes of a child that could not give an answer. */
#define ZYGOTE_EXIT_NO_SANDBOX 70
#define ZYGOTE_EXIT_NO_INPUT 71
#define ZYGOTE_EXIT_NO_ANSWER 72

/* How a worker runs one kind of job. run() works in the child and writes the whole answer
 * (job.h). */
struct zygote_task {
    void (*run)(struct source *input, struct sink *answer);
};

/* The descriptor of the socket to the daemon. */
#define ZYGOTE_FD 3

/* The main() of a worker program: serves jobs from the SEQPACKET socket ZYGOTE_FD until the daemon
 * closes it. tasks[kind].run is NULL for kinds that this program does not take. Returns the exit
 * code: 0; 1 if it cannot continue; 2 if it was not started by sheend. It explains 1 and 2 on
 * standard error. */
int zygote_main(int argc, char **argv, const struct zygote_task tasks[static N_JOB_KINDS]);

#endif
