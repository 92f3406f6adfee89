/* Runs jobs in a worker program: a process beside sheend that forks a sandboxed child for each job
 * (sandbox/zygote.h). The program is started before it is needed, because it takes time to load its
 * libraries, and again whenever it has died.
 *
 * Thread: any, for worker_run() and worker_wake(), also several at once; worker_run() blocks until
 * the job has ended. One thread at a time for the others. */
#ifndef SHEEN_THREADS_WORKER_H
#define SHEEN_THREADS_WORKER_H

#include "server/sandbox/job.h"

#define WORKER_PATH_BYTES 4096
/* The number of input files kept for the next job, and their largest size: a picture of 3840 x
 * 2160. */
#define WORKER_MAX_SPARES 2
#define WORKER_MAX_SPARE_BYTES (32u << 20)
/* A program that has a job tells every JOB_BEAT_MS that it works. After the first time it counts as
 * silent, after the second as dead: it is killed, and the job is given to another. */
#define WORKER_SILENT_MS 2500
#define WORKER_DEAD_MS 6000

struct worker;

/* Makes a worker for the program at `path`, without starting it. NULL with ERROR_SERVER. */
struct worker *worker_create(const char *path, struct error *error);
/* Starts the program unless it runs. A job would start it too, but would then wait for its
 * libraries to load. False with ERROR_SERVER. */
bool worker_wake(struct worker *worker, struct error *error);
enum worker_health {
    WORKER_WELL,
    WORKER_SILENT, /* it has a job, and has not told for WORKER_SILENT_MS that it works */
    WORKER_LOST,   /* it cannot be started again: the starter's process has died */
};
enum worker_health worker_health(struct worker *worker);
/* Kills the program and its jobs. No thread may wait for a job. NULL is safe. */
void worker_destroy(struct worker *worker);
/* From now on all jobs fail soon, including those that run: the daemon ends. */
void worker_stop(struct worker *worker);

/* The two files of a job. The caller writes the parameters to `input`, runs the job, and reads the
 * result from `answer`. */
struct worker_call {
    struct worker *lender; /* the worker that the input file is returned to; NULL: none */
    int input_fd, answer_fd;
    struct sink input;
    struct source answer; /* reads the mapping; valid until worker_call_finish() */
    void *mapping;
    size_t mapping_bytes;
    bool ended; /* the process that had the files is dead */
};

/* Makes the files of a job. False with ERROR_SERVER when no descriptor is free. Call
 * worker_call_finish() in both cases. */
bool worker_call_init(struct worker_call *call, struct error *error);
/* As worker_call_init(), for jobs whose input does not come from outside: its file may be reused
 * from an earlier job, because fresh memory, which the system must find and clear, costs more than
 * the copy. */
bool worker_call_init_lent(struct worker_call *call, struct worker *lender, struct error *error);
void worker_call_finish(struct worker_call *call);

/* Runs a job and waits for it. On success call->answer holds the result. Errors contain `name`. An
 * error is that of the worker itself, or has the kind
 *
 *   `damage`      the process crashed, made a forbidden call or exceeded its limits: the file causes
 *                 that and would do so again
 *   ERROR_SERVER  the process was killed, or the program cannot be started
 *
 * If the program dies or is stopped during the job, the job is run once more; also if the job's process
 * is stopped. */
bool worker_run(struct worker *worker, struct worker_call *call, enum job_kind kind,
                const struct job_limits *limits, const char *name, enum error_kind damage,
                struct error *error);

#endif
