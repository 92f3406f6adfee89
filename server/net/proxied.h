/* Connections from balancers whose PROXY header (proxy_header.h) has not come yet. Their number and
 * their time are limited.
 * Thread: the loop's. */
#ifndef SHEEN_NET_PROXIED_H
#define SHEEN_NET_PROXIED_H

#include "server/net/loop.h"
#include "server/net/proxy_header.h"

#define PROXIED_MAX 256 /* beyond this number the oldest is closed */

struct listener;
struct proxied;

struct proxied_handler {
    /* The header has come. The handler owns the descriptor. `from` is the client's address, or NULL
     * for a connection of the balancer itself. */
    void (*arrived)(void *owner, const struct listener *listener, int fd,
                    const struct sockaddr *from);
    /* The header was malformed or late; the connection is closed. */
    void (*refused)(void *owner, const struct listener *listener, const char *why);
    void *owner;
};

/* NULL when memory is short. Copies *handler. */
struct proxied *proxied_create(struct loop *loop, const struct proxied_handler *handler);
void proxied_destroy(struct proxied *proxied); /* closes all connections; NULL is safe */

/* Takes over a connection that came to `listener`. */
void proxied_accept(struct proxied *proxied, const struct listener *listener, int fd);
/* Closes connections that have waited longer than patience_us. */
void proxied_tick(struct proxied *proxied, uint64_t now_us, uint64_t patience_us);
bool proxied_is_empty(const struct proxied *proxied);

#endif
