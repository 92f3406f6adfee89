#include "server/net/proxied.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/queue.h>
#include <unistd.h>

#include "server/base/clock.h"

struct waiting {
    struct loop_source source;
    struct proxied *proxied;
    const struct listener *listener;
    uint64_t since_us;
    size_t received;
    uint8_t header[PROXY_HEADER_MOST_BYTES];
    TAILQ_ENTRY(waiting) link;
};

struct proxied {
    struct loop *loop;
    struct proxied_handler handler;
    TAILQ_HEAD(waiting_list, waiting) list; /* the oldest first */
    unsigned n;
};

struct proxied *proxied_create(struct loop *loop, const struct proxied_handler *handler)
{
    struct proxied *proxied = calloc(1, sizeof *proxied);
    if (!proxied)
        return NULL;
    proxied->loop = loop;
    proxied->handler = *handler;
    TAILQ_INIT(&proxied->list);
    return proxied;
}

/* Stops waiting; the descriptor stays open. */
static void leave(struct waiting *waiting)
{
    struct proxied *proxied = waiting->proxied;
    loop_unwatch(proxied->loop, &waiting->source);
    TAILQ_REMOVE(&proxied->list, waiting, link);
    proxied->n--;
    free(waiting);
}

static void refuse(struct waiting *waiting, const char *why)
{
    const struct proxied_handler handler = waiting->proxied->handler;
    const struct listener *listener = waiting->listener;
    int fd = waiting->source.fd;
    leave(waiting);
    close(fd);
    handler.refused(handler.owner, listener, why);
}

void proxied_destroy(struct proxied *proxied)
{
    if (!proxied)
        return;
    while (!TAILQ_EMPTY(&proxied->list)) {
        struct waiting *waiting = TAILQ_FIRST(&proxied->list);
        int fd = waiting->source.fd;
        leave(waiting);
        close(fd);
    }
    free(proxied);
}

static void arrived(struct waiting *waiting)
{
    const struct proxied_handler handler = waiting->proxied->handler;
    const struct listener *listener = waiting->listener;
    struct sockaddr_storage from;
    bool is_local;
    if (!proxy_header_read(waiting->header, waiting->received, &is_local, &from)) {
        refuse(waiting, "the balancer's PROXY header is too short for its address");
        return;
    }
    int fd = waiting->source.fd;
    leave(waiting);
    handler.arrived(handler.owner, listener, fd, is_local ? NULL : (const struct sockaddr *)&from);
}

/* Reads no more than the header: the bytes behind it belong to the client. */
static void ready(struct loop_source *source, uint32_t events)
{
    (void)events;
    struct waiting *waiting = source->owner;
    size_t whole = PROXY_HEADER_FIXED_BYTES;
    for (;;) {
        if (waiting->received >= PROXY_HEADER_FIXED_BYTES &&
            (whole = proxy_header_length(waiting->header)) == 0) {
            refuse(waiting, "no PROXY header of version 2 came from the balancer");
            return;
        }
        if (waiting->received == whole) {
            arrived(waiting);
            return;
        }
        ssize_t n =
            read(source->fd, waiting->header + waiting->received, whole - waiting->received);
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
            return;
        if (n <= 0) {
            refuse(waiting, "the balancer left before its PROXY header");
            return;
        }
        waiting->received += (size_t)n;
    }
}

void proxied_accept(struct proxied *proxied, const struct listener *listener, int fd)
{
    struct waiting *waiting = calloc(1, sizeof *waiting);
    if (!waiting) {
        close(fd);
        proxied->handler.refused(proxied->handler.owner, listener, "no memory");
        return;
    }
    if (proxied->n >= PROXIED_MAX)
        refuse(TAILQ_FIRST(&proxied->list), "too many connections without a PROXY header");
    waiting->source = (struct loop_source){fd, ready, waiting};
    waiting->proxied = proxied;
    waiting->listener = listener;
    waiting->since_us = clock_now_us();
    TAILQ_INSERT_TAIL(&proxied->list, waiting, link);
    proxied->n++;
    if (!loop_watch(proxied->loop, &waiting->source, EPOLLIN, NULL)) {
        waiting->source.fd = fd;
        refuse(waiting, "it cannot be watched");
    }
}

void proxied_tick(struct proxied *proxied, uint64_t now_us, uint64_t patience_us)
{
    struct waiting *waiting;
    while ((waiting = TAILQ_FIRST(&proxied->list)) && now_us > waiting->since_us + patience_us)
        refuse(waiting, "no PROXY header came in time from the balancer");
}

bool proxied_is_empty(const struct proxied *proxied)
{
    return proxied->n == 0;
}
