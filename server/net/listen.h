/* Listening sockets: Unix, TCP on loopback, TLS anywhere, and those that a service manager has
 * opened. Thread: the loop's. */
#ifndef SHEEN_NET_LISTEN_H
#define SHEEN_NET_LISTEN_H

#include "protocol/address.h"
#include "server/base/error.h"
#include "server/net/loop.h"

#define LISTENER_TEXT_BYTES 320

struct listener;

/* Which TCP addresses may be listened on without TLS. Beyond the loopback, everybody on the way could
 * read and change what is sent. */
enum listener_reach { LISTENER_LOOPBACK, LISTENER_ANYWHERE };

/* May a daemon listen there? ERROR_REQUEST if not; ERROR_SERVER if the name is unknown. */
bool listener_check(const struct address *address, enum listener_reach reach, struct error *error);

/* Where a daemon listens when nobody says where: $XDG_RUNTIME_DIR/sheen.sock, else a socket in a
 * folder of this user's alone under /tmp, which is made if need be. ERROR_SERVER when somebody else
 * has put something of that name there. */
bool listener_default(struct address *address, struct error *error);

/* Gets the descriptor of every new connection, and owns it from then on. */
struct listener_handler {
    void (*accepted)(void *owner, const struct listener *listener, int fd);
    void *owner;
};

/* Opens the socket. A Unix socket is made with mode 0600; one that a dead daemon left behind is
 * replaced, one that somebody answers on, or a file of another kind, is not. NULL on failure. */
struct listener *listener_open(struct loop *loop, const struct address *address,
                               enum listener_reach reach, const struct listener_handler *handler,
                               struct error *error);
/* Takes over a listening socket that somebody else has opened; its file stays when it closes.
 * It is one for TLS if `tls` or if it is TCP beyond `reach`. Closes fd on failure. */
struct listener *listener_adopt(struct loop *loop, int fd, bool tls, enum listener_reach reach,
                                const struct listener_handler *handler, struct error *error);
enum address_kind listener_kind(const struct listener *listener);
/* Gives the file of a Unix socket made here mode 0666, for a daemon that looks at each peer itself,
 * or 0600. */
void listener_open_to_all(const struct listener *listener, bool open);
/* Closes and removes the Unix socket's file, if it is still the one made here. NULL is safe. */
void listener_close(struct listener *listener);

/* The address as people write it, with the port that the system chose. */
const char *listener_text(const struct listener *listener);

/* True while the process is out of descriptors and accepting rests; listener_resume() tries
 * again. */
bool listener_is_paused(const struct listener *listener);
void listener_resume(struct listener *listener);

#endif
