/* The messages between sheend and its worker programs: a job with its limits on the way there, and
 * how it ended on the way back. The data travel as two files in memory: the input of the job, and
 * its answer, which begins with a status.
 *
 * Both ends are from the same build on the same machine. But a file may have taken control of a
 * worker process, so everything that comes from a worker is checked. Pure; any thread. */
#ifndef SHEEN_SANDBOX_JOB_H
#define SHEEN_SANDBOX_JOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/sandbox/stream.h"

enum job_kind {
    JOB_READ_CAGE,     /* a file to a cage */
    JOB_MEASURE_IMAGE, /* a file to the size of its pixels */
    JOB_READ_IMAGE,    /* a file to pixels */
    JOB_WRITE_IMAGE,   /* planes to a file */
    N_JOB_KINDS,
};

/* What the process of one job may use; it is killed beyond that. */
struct job_limits {
    uint64_t memory_bytes; /* in addition to what the process holds at its start */
    uint64_t answer_bytes; /* largest answer */
    uint32_t cpu_s, wall_s;
};

struct job {
    enum job_kind kind;
    struct job_limits limits;
    uint64_t input_bytes; /* not 0 */
};

/* The descriptors that are sent with a job. */
enum job_fd {
    JOB_INPUT,  /* input_bytes long; can only be read */
    JOB_ANSWER, /* empty */
    JOB_END,    /* a pipe to which the job's end is written */
    N_JOB_FDS,
};

#define JOB_MESSAGE_BYTES 48
void job_encode(const struct job *job, uint8_t message[JOB_MESSAGE_BYTES]);
/* Reads a job; false if the message is not a job of this build. */
bool job_decode(struct job *job, const uint8_t *message, size_t size);

enum job_how {
    JOB_EXITED,    /* value: the exit code; 0: there is an answer */
    JOB_KILLED,    /* value: the signal */
    JOB_TIMED_OUT, /* value: 0; killed after limits.wall_s */
    JOB_NOT_RUN,   /* value: errno; no process could be started */
    JOB_STOPPED,   /* value: 0; somebody had stopped the process, so it was killed */
    /* value: 0; no end: the process runs. Sent when it is started and then every JOB_BEAT_MS, so that the
     * daemon notices when the program itself is stopped. */
    JOB_RUNNING,
    N_JOB_HOWS,
};

struct job_end {
    enum job_how how;
    uint32_t value;
};

#define JOB_BEAT_MS 1000
#define JOB_END_BYTES 8
void job_end_encode(const struct job_end *end, uint8_t message[JOB_END_BYTES]);
bool job_end_decode(struct job_end *end, const uint8_t *message, size_t size);

/* The input of jobs that read a file. job_take_file() returns the file's bytes, which extend to the
 * end of the source, or NULL if the input is malformed. */
void job_write_file(struct sink *input, const char *name, const void *bytes, size_t size);
const void *job_take_file(struct source *input, const char **name, size_t *size);

/* An answer begins with the job's status. On success the result follows. */
void answer_write_ok(struct sink *sink);
void answer_write_error(struct sink *sink, const struct error *error);

enum answer_status {
    ANSWER_OK, /* the result follows in the source */
    /* The worker failed; *error has its reason, of kind REQUEST, MODEL, IMAGE or SERVER. */
    ANSWER_FAILED,
    ANSWER_BROKEN, /* malformed or missing */
};
enum answer_status answer_read_status(struct source *source, struct error *error);

#endif
