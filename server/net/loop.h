/* The event loop of the daemon's main thread: file descriptors, one tick, signals, and a wake-up
 * from other threads. Raw epoll, level-triggered.
 *
 * Sources are embedded in their owners and not owned here. A source may unwatch itself or others
 * in its callback, but its memory must stay until the next call of `after`: events of the same
 * batch may still name it (they are not delivered once it is unwatched).
 * Thread: the one that runs the loop. */
#ifndef SHEEN_NET_LOOP_H
#define SHEEN_NET_LOOP_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/epoll.h>

#include "server/base/error.h"

struct loop_source {
    int fd;                                                     /* not owned; -1 when not watched */
    void (*ready)(struct loop_source *source, uint32_t events); /* EPOLLIN, EPOLLOUT, ... */
    void *owner;
};

/* What the loop calls on its own account. */
struct loop_hooks {
    void (*after)(void *owner); /* after every batch of events: free what was closed, start work */
    void (*tick)(void *owner);  /* every LOOP_TICK_US while ticking is on */
    void *owner;
};
#define LOOP_TICK_US 200000u /* also how often PROGRESS is sent */

struct loop;

struct loop *loop_create(const struct loop_hooks *hooks, struct error *error);
void loop_destroy(struct loop *loop); /* NULL is safe */

/* Starts watching source->fd. ERROR_SERVER on failure, source->fd is then -1. */
bool loop_watch(struct loop *loop, struct loop_source *source, uint32_t events,
                struct error *error);
void loop_change(struct loop *loop, struct loop_source *source, uint32_t events);
void loop_unwatch(struct loop *loop, struct loop_source *source); /* safe when not watched */

/* Ticks cost wake-ups: on only while somebody waits for a deadline. */
void loop_set_ticking(struct loop *loop, bool on);

void loop_run(struct loop *loop); /* returns after loop_stop() */
void loop_stop(struct loop *loop);

#endif
