/* TLS under a conn (conn.h), in the place of the plain socket. Thread: the loop's. */
#ifndef SHEEN_NET_CONN_TLS_H
#define SHEEN_NET_CONN_TLS_H

#include "protocol/tls.h"
#include "server/net/conn.h"

/* Before the first byte of a fresh conn has moved. ERROR_SERVER without memory. */
bool conn_start_tls(struct conn *conn, struct tls_context *context, struct error *error);

/* As tls_peer(); false for a conn without TLS, or one that has closed. */
bool conn_tls_peer(const struct conn *conn, struct tls_peer *peer);

#endif
