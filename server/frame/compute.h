/* Requests that compute numbers: how a struct computation (server/curves/computation.h) runs on the
 * pool of threads. Private to this folder.
 *
 * compute.c         the life of such a request: its turn, its memory, its slices, its answer
 * compute_breaks.c  the kind that finds breaks; every other kind is a file like it
 * compute_compare.c the kind that compares two surfaces
 * compute_lines.c   the kind that traces lines
 *
 * A computation waits in line until few enough others run and its memory is charged to its client.
 * Then its slices take turns with those of builds (server/assets/slices.h). While frames are drawn
 * or encoded, one slice of it runs at a time. The loop's thread starts and ends it; the pool runs
 * begin(), slices and pack().
 *
 * A new kind of request: a message (protocol/), a member of both unions (compute_asked.h and
 * below), a struct compute_kind, and a row in compute_kind_of() (compute.c). */
#ifndef SHEEN_FRAME_COMPUTE_H
#define SHEEN_FRAME_COMPUTE_H

#include "server/assets/slices.h"
#include "server/curves/computation.h"
#include "server/frame/compute_asked.h"
#include "server/frame/request_internal.h"

/* The computations that run at the same time: of all clients, and of one party (a client's
 * identity). */
enum { COMPUTE_MOST_RUNNING = 4, COMPUTE_MOST_OF_PARTY = 1 };

struct compute;

struct compute_kind {
    uint8_t answer;   /* type of the answer's message */
    const char *what; /* for errors, as "finding breaks" */
    /* The scene of the request: model, camera, lights, lines, deadline. */
    const sheen_Render *(*scene)(const union compute_asked *asked);
    /* The second model's SHA-256. NULL: the kind has one model. */
    const uint8_t *(*second)(const union compute_asked *asked);
    /* An upper bound of the bytes that the computation and the records of its answer take. */
    uint64_t (*bytes)(const struct compute *compute);
    /* Makes the computation; it takes compute->bytes of memory at most. NULL with *error: it cannot
     * begin. */
    struct computation *(*create)(const struct compute *compute, struct error *error);
    /* After the last phase, on the pool: fills in compute->answer, and compute->records, if there
     * are any. False with *error: there is no memory. */
    bool (*pack)(struct compute *compute, struct error *error);
};

/* The kind of a message's type. */
const struct compute_kind *compute_kind_of(uint8_t type);
extern const struct compute_kind compute_breaks_kind, compute_compare_kind, compute_lines_kind;

union compute_answer {
    sheen_Breaks breaks;
    sheen_Compared compared;
    sheen_Curves curves;
};

/* A task on the pool: begin(), a slice, or pack(). */
struct compute_task {
    struct task task;
    struct compute *compute;
    size_t slice;
    bool is_busy;
    uint64_t took_us;
};

struct compute {
    const struct compute_kind *kind;
    struct request *request;
    TAILQ_ENTRY(compute) link; /* while is_in_line */
    bool is_in_line;
    union compute_asked asked;
    struct needed second; /* the second model */

    /* Set when the models are there. */
    const struct limit_tables *tables[2]; /* the second one: NULL, if the kind has one model */
    struct frame_request scene;           /* of the first model */
    uint64_t bytes;

    struct computation *computation;
    union compute_answer answer;
    uint8_t *records; /* from the host's block_cache; NULL: none */
    size_t records_bytes;

    struct slice_source source;
    bool has_joined; /* `source` takes turns */
    enum { COMPUTE_BEGIN, COMPUTE_SLICES, COMPUTE_PACK } step;
    unsigned phase;
    size_t n_slices, next_slice, n_done;
    unsigned n_running;  /* tasks on the pool */
    uint64_t longest_us; /* of the slices so far; 0: none was run */
    bool ok;             /* false: `error` says why */
    struct error error;
    unsigned n_tasks;
    struct compute_task tasks[]; /* n_tasks */
};

/* Makes the part of a request that computes. NULL when memory is short. */
struct compute *compute_create(struct request *request, uint8_t type,
                               const union compute_asked *asked);
/* Frees it. No task of it is on the pool. NULL is safe. */
void compute_destroy(struct compute *compute);

/* All models are there: puts the request in line. */
void compute_enter_line(struct compute *compute);
/* The request has no client any more: no more slices begin, and those that run return soon. */
void compute_stop(struct compute *compute);
/* Starts the computations whose turn it is. */
void compute_start_next(struct request_host *host);
/* True if a task of it is on the pool. */
bool compute_is_running(const struct compute *compute);
/* How far the computation is. False if it has not begun. */
bool compute_progress(const struct compute *compute, sheen_Progress *progress);

#endif
