/* What sheend and its worker processes say to each other: a job with its limits on the way there,
 * how it ended on the way back. What a job works on and what comes of it lies in two files in
 * memory that travel with the job: its input, and the answer, which begins with its status.
 *
 * Both ends are of one build on one machine, yet a worker may have been taken over by what it read:
 * all that comes from it is checked. Pure; any thread. */
#ifndef SHEEN_SANDBOX_JOB_H
#define SHEEN_SANDBOX_JOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/sandbox/stream.h"

enum job_kind {
    JOB_READ_CAGE,   /* a file to a cage */
    JOB_READ_IMAGE,  /* a file to pixels */
    JOB_WRITE_IMAGE, /* planes to a file */
    JOB_DRAW_TEXT,   /* a line of the daemon's own words to a mask */
    N_JOB_KINDS,
};

/* What the process of one job may use before it is ended. */
struct job_limits {
    uint64_t memory_bytes; /* of its own, beyond what it starts with */
    uint64_t answer_bytes; /* that it may write */
    uint32_t cpu_s, wall_s;
};

struct job {
    enum job_kind kind;
    struct job_limits limits;
    uint64_t input_bytes; /* not 0 */
};

/* Descriptors that travel with a job. */
enum job_fd {
    JOB_INPUT,  /* at least input_bytes long */
    JOB_ANSWER, /* empty */
    JOB_END,    /* a pipe that the end is written to */
    N_JOB_FDS,
};

#define JOB_MESSAGE_BYTES 48
void job_encode(const struct job *job, uint8_t message[JOB_MESSAGE_BYTES]);
/* False: not a job of this build. */
bool job_decode(struct job *job, const uint8_t *message, size_t size);

enum job_how {
    JOB_EXITED,    /* value: the exit code; an answer is there when it is 0 */
    JOB_KILLED,    /* value: the signal */
    JOB_TIMED_OUT, /* value: 0; ended after limits.wall_s */
    JOB_NOT_RUN,   /* value: errno; the system gave no process */
    N_JOB_HOWS,
};

struct job_end {
    enum job_how how;
    uint32_t value;
};

#define JOB_END_BYTES 8
void job_end_encode(const struct job_end *end, uint8_t message[JOB_END_BYTES]);
bool job_end_decode(struct job_end *end, const uint8_t *message, size_t size);

/* The input of the jobs that read a file. The bytes are to the end of the source; NULL when there
 * is no such input. */
void job_write_file(struct sink *input, const char *name, const void *bytes, size_t size);
const void *job_take_file(struct source *input, const char **name, size_t *size);

/* The beginning of an answer: how a job went. On success the result follows. */
void answer_write_ok(struct sink *sink);
void answer_write_error(struct sink *sink, const struct error *error);

enum answer_status {
    ANSWER_OK,     /* the result follows in the source */
    ANSWER_FAILED, /* *error is what the worker found: of kind REQUEST, MODEL, IMAGE or SERVER */
    ANSWER_BROKEN, /* no answer at all */
};
enum answer_status answer_read_status(struct source *source, struct error *error);

#endif
