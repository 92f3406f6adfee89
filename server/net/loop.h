/* The event loop of the daemon's main thread: file descriptors, one tick, and wake-ups from other
 * threads. Built on epoll, level-triggered.
 *
 * A source is embedded in its owner. In its callback a source may unwatch itself and others, but
 * its memory must stay valid until the next call of `after`: events of the same batch may still
 * refer to it (they are not delivered).
 * Thread: the one that runs the loop. */
#ifndef SHEEN_NET_LOOP_H
#define SHEEN_NET_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/epoll.h>

#include "server/base/error.h"
#include "server/base/intake.h"

struct loop_source {
    int fd;                                                     /* not owned; -1 when not watched */
    void (*ready)(struct loop_source *source, uint32_t events); /* EPOLLIN, EPOLLOUT, ... */
    void *owner;
};

/* Functions that the loop calls between batches of events, and regularly. */
struct loop_hooks {
    /* After each batch of events: to free what was closed and to start work. */
    void (*after)(void *owner);
    void (*tick)(void *owner); /* every LOOP_TICK_US while ticking is on */
    void *owner;
};
#define LOOP_TICK_US 200000u /* also the period of PROGRESS messages */

struct loop;

struct loop *loop_create(const struct loop_hooks *hooks, struct error *error);
void loop_destroy(struct loop *loop); /* NULL is safe */

/* Starts to watch source->fd. On failure returns false with ERROR_SERVER, and source->fd is -1. */
bool loop_watch(struct loop *loop, struct loop_source *source, uint32_t events,
                struct error *error);
void loop_change(struct loop *loop, struct loop_source *source, uint32_t events);
void loop_unwatch(struct loop *loop, struct loop_source *source); /* safe when not watched */

/* The intake whose sources handle input after each batch of events, for INTAKE_BATCH_US at most. */
struct intake *loop_intake(struct loop *loop);
/* The party of connections that have not shown an identity yet. */
struct intake_party *loop_strangers(struct loop *loop);

/* Has a source of the intake handled input since the last call of `after`, or does one still ask? */
bool loop_had_input(const struct loop *loop);
/* The next batch is of the events that are there, without waiting for one. */
void loop_hurry(struct loop *loop);

/* Turns ticks on or off. Each tick wakes the process, so keep them on only while something has a
 * deadline. */
void loop_set_ticking(struct loop *loop, bool on);

void loop_run(struct loop *loop); /* returns after loop_stop() */
void loop_stop(struct loop *loop);

#endif
