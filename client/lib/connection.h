/* A stream socket to a daemon, plain or with TLS. Apart from private_daemon.c this is the only part
 * of the client that makes socket calls.
 *
 * Reads and writes transfer all bytes, continue after signals and raise no SIGPIPE. The owner of
 * the struct closes it by connection_finish().
 * Thread: one at a time. */
#ifndef SHEEN_CLIENT_CONNECTION_H
#define SHEEN_CLIENT_CONNECTION_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"
#include "protocol/address.h"
#include "protocol/tls.h"

struct connection {
    int fd;                      /* non-blocking, close-on-exec; -1: closed */
    enum address_kind kind;      /* ADDRESS_UNIX for a socket pair */
    uint32_t timeout_ms;         /* longest time without a transferred byte; 0: no limit */
    struct tls_channel *channel; /* TLS, for a tls: address; NULL: plain */
    bool must_not_wait;          /* connection_read() returns SHEEN_AGAIN instead of waiting */
    /* After SHEEN_AGAIN: the events that poll() must wait for; else 0. */
    short wants;
};

/* Connects. `files` are for a tls: address, whose TLS handshake happens during the first write and
 * read. On failure the connection is closed: SHEEN_NO_SERVER names the address and the reason,
 * SHEEN_BAD_ARGUMENT a file that cannot be used. */
enum sheen_status connection_open(struct connection *connection, const struct address *address,
                                  const struct tls_files *files, uint32_t timeout_ms,
                                  struct sheen_error *error);

/* Makes a pair of connected sockets: one becomes *connection, the other goes to *peer_fd, which the
 * caller closes. Both are close-on-exec. SHEEN_NO_SERVER on failure. */
enum sheen_status connection_pair(struct connection *connection, int *peer_fd, uint32_t timeout_ms,
                                  struct sheen_error *error);

/* Write or read exactly n_bytes bytes. SHEEN_LOST_SERVER if the peer is gone; SHEEN_TIMEOUT. A read
 * starts at *n_got and advances it, so that it can be continued after SHEEN_AGAIN. */
enum sheen_status connection_write(struct connection *connection, const void *bytes, size_t n_bytes,
                                   struct sheen_error *error);
enum sheen_status connection_read(struct connection *connection, void *bytes, size_t n_bytes,
                                  size_t *n_got, struct sheen_error *error);

void connection_finish(struct connection *connection); /* closes; a closed connection is safe */

#endif
