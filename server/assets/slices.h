/* Shares the threads of the pool among builds. Each build hands over its work in slices of a few
 * milliseconds, and the builds take turns (turns.h), so that no build delays another, however
 * large.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_SLICES_H
#define SHEEN_ASSETS_SLICES_H

#include "server/base/turns.h"
#include "server/threads/pool.h"

/* The time that a slice should take, so that slices of other builds do not wait for long. */
#define SLICE_US 4000

struct slices {
    struct pool *pool;
    struct turns builds;
    unsigned n_running, most_running; /* slices submitted to the pool: now, and at most */
};

/* A build that has work for the pool; a member of the build. */
struct slice_source {
    struct turn turn;
    void *build;
    /* Returns the next slice to submit, or NULL if all are done or running. The slice's done() must
     * call slices_done(). */
    struct task *(*next)(struct slice_source *source);
    bool is_dry; /* next() returned NULL after the latest slice was done; private to slices.c */
};

void slices_init(struct slices *slices, struct pool *pool);

/* The build has work from now on, until slices_leave(). */
void slices_join(struct slices *slices, struct slice_source *source);
void slices_leave(struct slices *slices, struct slice_source *source);
/* Reports that a slice of this source is done and took took_us. */
void slices_done(struct slices *slices, struct slice_source *source, uint64_t took_us);
/* Submits slices until the pool has enough. Call it last, after any of the functions above. */
void slices_start(struct slices *slices);

#endif
