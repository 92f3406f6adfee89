#include "server/net/conn_tls.h"

#include <errno.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

/* --- below: the socket */

static ssize_t socket_read(void *owner, void *bytes, size_t size)
{
    const struct conn *conn = owner;
    return read(conn->source.fd, bytes, size);
}

static ssize_t socket_write(void *owner, const void *bytes, size_t size)
{
    const struct conn *conn = owner;
    return send(conn->source.fd, bytes, size, MSG_NOSIGNAL);
}

/* --- above: the conn */

/* Translates a result of TLS to a result and errno as of read() and sendmsg(). */
static ssize_t result_of(struct conn *conn, enum tls_result result, size_t moved)
{
    switch (result) {
    case TLS_MOVED:
        return (ssize_t)moved;
    case TLS_ENDED:
        return 0;
    case TLS_WANTS_READ:
    case TLS_WANTS_WRITE:
        errno = EAGAIN;
        return -1;
    case TLS_FAILED:
        break;
    }
    snprintf(conn->reason, sizeof conn->reason, "TLS: %s", tls_reason(conn->channel));
    errno = EPROTO;
    return -1;
}

static ssize_t tls_conn_read(struct conn *conn, void *bytes, size_t size)
{
    size_t moved;
    enum tls_result result = tls_read(conn->channel, bytes, size, &moved);
    conn->read_wants_write = result == TLS_WANTS_WRITE;
    return result_of(conn, result, moved);
}

static ssize_t tls_conn_write(struct conn *conn, struct iovec *pieces, size_t n)
{
    ssize_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        for (size_t done = 0, moved; done < pieces[i].iov_len; done += moved) {
            enum tls_result result =
                tls_write(conn->channel, (const char *)pieces[i].iov_base + done,
                          pieces[i].iov_len - done, &moved);
            if (result != TLS_MOVED)
                return sum ? sum : result_of(conn, result, 0);
            sum += (ssize_t)moved;
        }
    }
    return sum;
}

static bool tls_conn_pending(const struct conn *conn)
{
    return tls_pending(conn->channel) > 0;
}

static void tls_conn_end(struct conn *conn)
{
    tls_end(conn->channel);
}

static void tls_conn_finish(struct conn *conn)
{
    tls_channel_destroy(conn->channel);
    conn->channel = NULL;
}

static const struct conn_transport TLS_TRANSPORT = {tls_conn_read, tls_conn_write, tls_conn_pending,
                                                    tls_conn_end, tls_conn_finish};

bool conn_start_tls(struct conn *conn, struct tls_context *context, struct error *error)
{
    const struct tls_io io = {socket_read, socket_write, conn};
    conn->channel = tls_channel_create(context, &io, NULL);
    if (!conn->channel)
        return error_set(error, ERROR_SERVER, "no memory for TLS");
    conn->transport = &TLS_TRANSPORT;
    return true;
}

bool conn_tls_peer(const struct conn *conn, struct tls_peer *peer)
{
    return conn->channel && tls_peer(conn->channel, peer);
}
