/* Shares the threads of the pool among builds. Each build hands over its work in slices of a few
 * milliseconds, and the builds take turns (turns.h), so that no build delays another, however
 * large.
 * Thread: the one that runs the loop (server/net/loop.h). */
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
    /* Returns the next slice to submit, or NULL if there is none now: all slices are done or running.
     * After NULL it is called again only when one of its slices is done, or after slices_join(). A
     * slice's done() must call slices_done(). */
    struct task *(*next)(struct slice_source *source);
    bool is_dry; /* the latest call of next() returned NULL; private to slices.c */
};

void slices_init(struct slices *slices, struct pool *pool);

/* The build has work from now on, until slices_leave(). */
void slices_join(struct slices *slices, struct slice_source *source);
void slices_leave(struct slices *slices, struct slice_source *source);
/* Reports that a slice of this source is done and took took_us. */
void slices_done(struct slices *slices, struct slice_source *source, uint64_t took_us);
/* For the thread of a slice that takes long: reports that the slice is alive (pool_beat()). */
void slices_beat(void);
/* Submits slices until the pool has enough. Call it last, after any of the functions above. */
void slices_start(struct slices *slices);

#endif
