#include "server/net/loop.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"

/* Events for each call of epoll_wait(): so many that finished work of other threads is among them even if
 * hundreds of clients have sent something. */
#define BATCH 512

struct loop {
    int epoll_fd;
    struct loop_hooks hooks;
    struct epoll_event events[BATCH];
    int n_events; /* of the batch being delivered */
    bool ticking, stopped, had_input, hurries;
    uint64_t next_tick_us;
    struct intake intake;
    struct intake_party strangers;
};

struct loop *loop_create(const struct loop_hooks *hooks, struct error *error)
{
    struct loop *loop = calloc(1, sizeof *loop);
    if (!loop) {
        error_set(error, ERROR_SERVER, "no memory for the event loop");
        return NULL;
    }
    loop->hooks = *hooks;
    intake_add_party(&loop->strangers);
    loop->epoll_fd = epoll_create1(EPOLL_CLOEXEC);
    if (loop->epoll_fd < 0) {
        error_set(error, ERROR_SERVER, "epoll_create1: %s", strerror(errno));
        free(loop);
        return NULL;
    }
    return loop;
}

void loop_destroy(struct loop *loop)
{
    if (!loop)
        return;
    close(loop->epoll_fd);
    free(loop);
}

bool loop_watch(struct loop *loop, struct loop_source *source, uint32_t events, struct error *error)
{
    struct epoll_event event = {.events = events, .data.ptr = source};
    if (epoll_ctl(loop->epoll_fd, EPOLL_CTL_ADD, source->fd, &event) == 0)
        return true;
    source->fd = -1;
    return error_set(error, ERROR_SERVER, "epoll_ctl: %s", strerror(errno));
}

void loop_change(struct loop *loop, struct loop_source *source, uint32_t events)
{
    struct epoll_event event = {.events = events, .data.ptr = source};
    if (source->fd >= 0)
        epoll_ctl(loop->epoll_fd, EPOLL_CTL_MOD, source->fd, &event);
}

void loop_unwatch(struct loop *loop, struct loop_source *source)
{
    if (source->fd < 0)
        return;
    epoll_ctl(loop->epoll_fd, EPOLL_CTL_DEL, source->fd, NULL);
    source->fd = -1;
    for (int i = 0; i < loop->n_events; i++)
        if (loop->events[i].data.ptr == source)
            loop->events[i].data.ptr = NULL;
}

struct intake *loop_intake(struct loop *loop)
{
    return &loop->intake;
}

struct intake_party *loop_strangers(struct loop *loop)
{
    return &loop->strangers;
}

void loop_set_ticking(struct loop *loop, bool on)
{
    if (on && !loop->ticking)
        loop->next_tick_us = clock_now_us() + LOOP_TICK_US;
    loop->ticking = on;
}

bool loop_had_input(const struct loop *loop)
{
    return loop->had_input || intake_due_us(&loop->intake) != UINT64_MAX;
}

void loop_hurry(struct loop *loop)
{
    loop->hurries = true;
}

static int wait_ms(const struct loop *loop)
{
    uint64_t due_us = intake_due_us(&loop->intake);
    if (loop->ticking && loop->next_tick_us < due_us)
        due_us = loop->next_tick_us;
    if (loop->hurries || due_us == 0)
        return 0;
    if (due_us == UINT64_MAX)
        return -1;
    uint64_t now_us = clock_now_us();
    return due_us <= now_us ? 0 : (int)((due_us - now_us + 999) / 1000);
}

static void handle_input(struct intake *intake)
{
    if (intake_due_us(intake) == UINT64_MAX)
        return;
    uint64_t begin_us = clock_now_us(), now_us = begin_us;
    struct intake_source *source;
    while (now_us - begin_us < INTAKE_BATCH_US && (source = intake_next(intake, now_us))) {
        uint64_t before_us = now_us;
        source->handle(source);
        now_us = clock_now_us();
        intake_charge(source, now_us - before_us);
    }
}

void loop_run(struct loop *loop)
{
    while (!loop->stopped) {
        loop->n_events = epoll_wait(loop->epoll_fd, loop->events, BATCH, wait_ms(loop));
        for (int i = 0; i < loop->n_events; i++) {
            struct loop_source *source = loop->events[i].data.ptr;
            if (source)
                source->ready(source, loop->events[i].events);
        }
        loop->n_events = 0;
        loop->hurries = false;
        loop->had_input = intake_due_us(&loop->intake) != UINT64_MAX;
        handle_input(&loop->intake);
        if (loop->ticking && clock_now_us() >= loop->next_tick_us) {
            loop->next_tick_us = clock_now_us() + LOOP_TICK_US;
            loop->hooks.tick(loop->hooks.owner);
        }
        loop->hooks.after(loop->hooks.owner);
    }
}

void loop_stop(struct loop *loop)
{
    loop->stopped = true;
}
