/* A program beside sheend that runs jobs in sandboxed processes, kept running: started before it is
 * needed, so that it loads its libraries meanwhile, and again whenever it has died.
 *
 * Thread: worker_run() and worker_wake() may be called from any thread, and by many at once; the
 * former blocks until the job has ended. The others are for one thread. */
#ifndef SHEEN_THREADS_WORKER_H
#define SHEEN_THREADS_WORKER_H

#include "server/sandbox/job.h"

#define WORKER_PATH_BYTES 4096
/* Inputs kept for the next job, and their size: a picture of 3840 x 2160. */
#define WORKER_MAX_SPARES 2
#define WORKER_MAX_SPARE_BYTES (32u << 20)

struct worker;

/* For the program at `path`, which is not started yet. NULL with ERROR_SERVER. */
struct worker *worker_create(const char *path, struct error *error);
/* Starts the program unless it runs. A job would start it too, but would then wait until the program
 * has loaded its libraries. False with ERROR_SERVER. */
bool worker_wake(struct worker *worker, struct error *error);
/* Ends the program and what it runs. No job may be waited for. NULL is safe. */
void worker_destroy(struct worker *worker);
/* From now on all jobs fail soon, also those under way: the daemon ends. */
void worker_stop(struct worker *worker);

/* A job's two files. The caller writes the parameters to `input`, runs the job, and reads the
 * result from `answer`. */
struct worker_call {
    struct worker *lender; /* who gets the input back; NULL: nobody */
    int input_fd, answer_fd;
    struct sink input;
    struct source answer; /* in the mapping, valid until worker_call_finish() */
    void *mapping;
    size_t mapping_bytes;
    bool ended; /* the process that has the files is dead */
};

/* ERROR_SERVER when the system has no more descriptors. worker_call_finish() is due in both cases.
 */
bool worker_call_init(struct worker_call *call, struct error *error);
/* The same for jobs whose input is not of a stranger: it may lie in the file of a job before, since
 * memory that the system has to find and clear costs more than the copy. */
bool worker_call_init_lent(struct worker_call *call, struct worker *lender, struct error *error);
void worker_call_finish(struct worker_call *call);

/* Runs the job. On success call->answer holds the result. Errors say `name`; they are the worker's
 * own, and else of kind
 *   `damage`      the process crashed, tried what it must not, or took more than its limits: the
 *                 file does that, and would do it again
 *   ERROR_SERVER  it was killed, or the program cannot be started
 * A job whose program dies is run once more. */
bool worker_run(struct worker *worker, struct worker_call *call, enum job_kind kind,
                const struct job_limits *limits, const char *name, enum error_kind damage,
                struct error *error);

#endif
