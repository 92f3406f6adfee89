/* Work on surfaces that takes longer than one task may: it is cut into phases, and each phase into slices of a few
 * milliseconds. Whoever runs a computation (server/frame on the daemon's pool; a test on its own thread) can
 * therefore let other work run between two slices, stop the computation, and say how far it is.
 *
 * A particular computation has a struct computation as its first member. A function makes it from tables, which
 * stay valid until destroy(), from parameters, and from an upper bound in bytes of the memory that it may take.
 * Typed functions read its result after the last phase. The result has the same bytes for any number of threads
 * and any order of slices: what slices add up is added slice by slice, in the order of their numbers. */
#ifndef SHEEN_CURVES_COMPUTATION_H
#define SHEEN_CURVES_COMPUTATION_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include "server/base/error.h"

struct computation;

struct computation_kind {
    /* The name of each phase, which reports of progress show. NULL ends the list. */
    const char *const *stages;
    /* Prepares a phase, after all slices of the phase before have run. Sets the number of its slices; 0 means that
     * the phase has nothing to do. False with *error: the computation has failed.
     * Thread: any, but one at a time. */
    bool (*begin)(struct computation *computation, unsigned phase, size_t *n_slices,
                  struct error *error);
    /* Runs one slice, a few milliseconds of work, of the phase that begin() prepared last. Returns early when
     * `cancelled` is set. A slice whose work takes longer may return before its work is done, and set `repeats`: the
     * phase is then begun again when all its slices have run. Thread: any; different slices of a phase run at the same
     * time. */
    void (*slice)(struct computation *computation, size_t slice);
    /* Frees the computation. No slice is running. */
    void (*destroy)(struct computation *computation);
};

struct computation {
    const struct computation_kind *kind;
    atomic_bool cancelled; /* any thread sets it; the result is then undefined */
    atomic_bool repeats;   /* a slice sets it; who runs the computation clears it */
    /* Called by slices while they work: their thread is alive, however long one search takes. NULL: nobody asks. Who runs
     * the computation sets it before the first slice. */
    void (*beat)(void);
};

/* For slices, after each few microseconds of work or more: calls beat(), and returns true if the computation was
 * cancelled. */
bool computation_is_cancelled(struct computation *computation);

/* True if the phase whose slices have all run must be begun again; asks and clears. */
bool computation_repeats(struct computation *computation);

/* Runs all phases on the calling thread. False with *error: a phase could not begin, or the computation was
 * cancelled (ERROR_SERVER). */
bool computation_run(struct computation *computation, struct error *error);

/* Frees the computation. NULL is safe. */
void computation_destroy(struct computation *computation);

#endif
