/* TLS as the transport of a conn (conn.h), instead of the plain socket.
 * Thread: the loop's. */
#ifndef SHEEN_NET_CONN_TLS_H
#define SHEEN_NET_CONN_TLS_H

#include "protocol/tls.h"
#include "server/net/conn.h"

/* Starts TLS on a new conn, before any byte was transferred. False with ERROR_SERVER when memory is
 * short. */
bool conn_start_tls(struct conn *conn, struct tls_context *context, struct error *error);

/* As tls_peer(). False for a conn without TLS, or for a closed one. */
bool conn_tls_peer(const struct conn *conn, struct tls_peer *peer);

#endif
