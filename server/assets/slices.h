/* The pool's threads, as builds share them: each hands over its work in slices of a few milliseconds, and
 * no build holds up another, however large (turns.h). Thread: the loop's. */
#ifndef SHEEN_ASSETS_SLICES_H
#define SHEEN_ASSETS_SLICES_H

#include "server/base/turns.h"
#include "server/threads/pool.h"

/* What a slice should take, so that another build's does not wait for long. */
#define SLICE_US 4000

struct slices {
    struct pool *pool;
    struct turns builds;
    unsigned n_running, most_running; /* slices in the pool */
};

/* A build that has work for the pool; part of it. */
struct slice_source {
    struct turn turn;
    void *build;
    /* The next slice, or NULL while there is none: all are done, or running. Its `done` calls
     * slices_done(). */
    struct task *(*next)(struct slice_source *source);
    bool is_dry; /* next() has said NULL since the last slice was done; the module's own */
};

void slices_init(struct slices *slices, struct pool *pool);

/* A build has work, from now on until slices_leave(). */
void slices_join(struct slices *slices, struct slice_source *source);
void slices_leave(struct slices *slices, struct slice_source *source);
/* One of the source's slices is done, and took so long. */
void slices_done(struct slices *slices, struct slice_source *source, uint64_t took_us);
/* Fills the pool again: at the end of whatever has called one of the above. */
void slices_start(struct slices *slices);

#endif
