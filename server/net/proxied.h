/* Connections of balancers whose header (proxy_header.h) has not come yet: bounded, each for a few
 * seconds. Thread: the loop's. */
#ifndef SHEEN_NET_PROXIED_H
#define SHEEN_NET_PROXIED_H

#include "server/net/loop.h"
#include "server/net/proxy_header.h"

#define PROXIED_MAX 256 /* with more of them the oldest leaves */

struct listener;
struct proxied;

struct proxied_handler {
    /* The header has come: the descriptor is the handler's. `from` is the client's address, NULL for a
     * connection of the balancer itself. */
    void (*arrived)(void *owner, const struct listener *listener, int fd,
                    const struct sockaddr *from);
    /* What came is no header, or not in time; the connection is closed. */
    void (*refused)(void *owner, const struct listener *listener, const char *why);
    void *owner;
};

/* NULL without memory. */
struct proxied *proxied_create(struct loop *loop, const struct proxied_handler *handler);
void proxied_destroy(struct proxied *proxied); /* closes all; NULL is safe */

/* Takes a connection over, which came to `listener`. */
void proxied_accept(struct proxied *proxied, const struct listener *listener, int fd);
/* Closes what has taken longer than that. */
void proxied_tick(struct proxied *proxied, uint64_t now_us, uint64_t patience_us);
bool proxied_is_empty(const struct proxied *proxied);

#endif
