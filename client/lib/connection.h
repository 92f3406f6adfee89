/* A stream socket to a daemon, plain or with TLS: the one place of the client that makes socket
 * calls.
 *
 * Reads and writes are exact, survive signals and raise no SIGPIPE. The owner of the struct closes
 * it with connection_finish(). Thread: one at a time. */
#ifndef SHEEN_CLIENT_CONNECTION_H
#define SHEEN_CLIENT_CONNECTION_H

#include <stddef.h>
#include <stdint.h>

#include "client/lib/sheen.h"
#include "protocol/address.h"
#include "protocol/tls.h"

struct connection {
    int fd;                      /* non-blocking, close-on-exec; -1: closed */
    enum address_kind kind;      /* of a pair: ADDRESS_UNIX */
    uint32_t timeout_ms;         /* without a byte moved; 0: for ever */
    struct tls_channel *channel; /* of a tls: address; NULL: plain */
    bool must_not_wait;          /* connection_read() says SHEEN_AGAIN instead */
    short wants;                 /* what poll() is to wait for, after SHEEN_AGAIN; else 0 */
};

/* Connects. `files` are for a tls: address, whose handshake happens in the first write and read.
 * SHEEN_NO_SERVER names the address and the reason, SHEEN_BAD_ARGUMENT a file that is no good;
 * *connection is then closed. */
enum sheen_status connection_open(struct connection *connection, const struct address *address,
                                  const struct tls_files *files, uint32_t timeout_ms,
                                  struct sheen_error *error);

/* Makes a pair of connected sockets: one is *connection, the other goes to the caller, who closes
 * it. Both are close-on-exec. SHEEN_NO_SERVER on failure. */
enum sheen_status connection_pair(struct connection *connection, int *peer_fd, uint32_t timeout_ms,
                                  struct sheen_error *error);

/* SHEEN_LOST_SERVER when the peer is gone, SHEEN_TIMEOUT. A read goes on at *n_got and counts it up
 * to n_bytes, so that it can be asked again after SHEEN_AGAIN. */
enum sheen_status connection_write(struct connection *connection, const void *bytes, size_t n_bytes,
                                   struct sheen_error *error);
enum sheen_status connection_read(struct connection *connection, void *bytes, size_t n_bytes,
                                  size_t *n_got, struct sheen_error *error);

void connection_finish(struct connection *connection); /* closes; closed is safe */

#endif
