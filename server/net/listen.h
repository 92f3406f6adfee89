/* Listening sockets: Unix sockets, TCP on the loopback, TLS on any address, and sockets that a
 * service manager has opened.
 * Thread: the loop's. */
#ifndef SHEEN_NET_LISTEN_H
#define SHEEN_NET_LISTEN_H

#include "protocol/address.h"
#include "server/base/error.h"
#include "server/net/loop.h"

#define LISTENER_TEXT_BYTES 320

struct listener;

/* Which TCP addresses may be listened on without TLS. Beyond the loopback, others on the network
 * could read and change the traffic. */
enum listener_reach { LISTENER_LOOPBACK, LISTENER_ANYWHERE };

/* May a daemon listen on this address? False with ERROR_REQUEST if not, with ERROR_SERVER if the
 * host is unknown. */
bool listener_check(const struct address *address, enum listener_reach reach, struct error *error);

/* The default address: $XDG_RUNTIME_DIR/sheen.sock, else a socket in a private folder of this user
 * below /tmp, which is made if needed. False with ERROR_SERVER if somebody else owns something of
 * that name. */
bool listener_default(struct address *address, struct error *error);

/* accepted() gets the descriptor of each new connection, and owns it. */
struct listener_handler {
    void (*accepted)(void *owner, const struct listener *listener, int fd);
    void *owner;
};

/* Opens a listening socket. A Unix socket gets mode 0600. The file of a dead daemon's socket is
 * replaced; a socket on which a daemon answers, and any other file, is not. NULL on failure. */
struct listener *listener_open(struct loop *loop, const struct address *address,
                               enum listener_reach reach, const struct listener_handler *handler,
                               struct error *error);
/* Takes over a listening socket that another process has opened; its file stays when the listener
 * closes. It is for TLS if `tls`, or if it is TCP beyond `reach`. On failure closes fd and returns
 * NULL. */
struct listener *listener_adopt(struct loop *loop, int fd, bool tls, enum listener_reach reach,
                                const struct listener_handler *handler, struct error *error);
enum address_kind listener_kind(const struct listener *listener);
/* Sets the mode of a Unix socket's file made by listener_open(): 0666 if the daemon checks each
 * peer itself, else 0600. */
void listener_open_to_all(const struct listener *listener, bool open);
/* Closes the socket and removes a Unix socket's file, if it is still the one made here. NULL is
 * safe. */
void listener_close(struct listener *listener);

/* The address as text, with the port that the system chose. */
const char *listener_text(const struct listener *listener);

/* True while accepting pauses because the process has no free descriptors; listener_resume() tries
 * again. */
bool listener_is_paused(const struct listener *listener);
void listener_resume(struct listener *listener);

#endif
