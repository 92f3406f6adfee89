#include "client/lib/connection.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include "client/lib/status.h"

static int64_t now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

/* Waits for `events`: 1 ready, 0 timed out, -1 failed with errno. */
static int wait_for(const struct connection *connection, short events)
{
    int64_t end = now_ms() + connection->timeout_ms;
    struct pollfd entry = {.fd = connection->fd, .events = events};
    for (;;) {
        int64_t left = connection->timeout_ms ? end - now_ms() : -1;
        if (connection->timeout_ms && left < 0)
            left = 0;
        int n = poll(&entry, 1, left > INT_MAX ? INT_MAX : (int)left);
        if (n >= 0 || errno != EINTR)
            return n;
    }
}

/* Connects one non-blocking socket; 0 or an errno value. */
static int connect_one(struct connection *connection, const struct sockaddr *name,
                       socklen_t name_bytes)
{
    connection->fd = socket(name->sa_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (connection->fd < 0)
        return errno;
    if (connect(connection->fd, name, name_bytes) == 0)
        return 0;
    if (errno != EINPROGRESS && errno != EINTR)
        return errno;
    int ready = wait_for(connection, POLLOUT);
    if (ready <= 0)
        return ready < 0 ? errno : ETIMEDOUT;
    int reason = 0;
    socklen_t reason_bytes = sizeof(reason);
    if (getsockopt(connection->fd, SOL_SOCKET, SO_ERROR, &reason, &reason_bytes) != 0)
        return errno;
    return reason;
}

static enum sheen_status open_unix(struct connection *connection, const char *path,
                                   struct sheen_error *error)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    _Static_assert(sizeof(name.sun_path) >= ADDRESS_PATH_BYTES, "a parsed path must fit");
    memcpy(name.sun_path, path, strlen(path) + 1);
    int reason = connect_one(connection, (const struct sockaddr *)&name, sizeof(name));
    if (reason == 0)
        return SHEEN_OK;
    connection_finish(connection);
    return status_set(error, SHEEN_NO_SERVER, "no server at unix:%s: %s; is sheend running there?",
                      path, strerror(reason));
}

static enum sheen_status open_tcp(struct connection *connection, const struct address *address,
                                  struct sheen_error *error)
{
    char port[8];
    snprintf(port, sizeof(port), "%u", (unsigned)address->port);
    const struct addrinfo hints = {.ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    struct addrinfo *list = NULL;
    int failed = getaddrinfo(address->host, port, &hints, &list);
    if (failed)
        return status_set(error, SHEEN_NO_SERVER, "no server at %s:%s:%s: %s",
                          address_scheme(address->kind), address->host, port, gai_strerror(failed));
    int reason = EADDRNOTAVAIL;
    for (const struct addrinfo *entry = list; entry; entry = entry->ai_next) {
        reason = connect_one(connection, entry->ai_addr, entry->ai_addrlen);
        if (reason == 0)
            break;
        connection_finish(connection);
    }
    freeaddrinfo(list);
    if (reason)
        return status_set(error, SHEEN_NO_SERVER,
                          "no server at %s:%s:%s: %s; is sheend running there?",
                          address_scheme(address->kind), address->host, port, strerror(reason));
    /* Requests are small and the client waits for answers: never delay a request to fill a
     * packet. */
    setsockopt(connection->fd, IPPROTO_TCP, TCP_NODELAY, &(int){1}, sizeof(int));
    return SHEEN_OK;
}

/* ---- bytes, over the socket or TLS: 0 is the end, -1 errno ---- */

static ssize_t socket_read(void *owner, void *bytes, size_t n_bytes)
{
    const struct connection *connection = owner;
    return recv(connection->fd, bytes, n_bytes, 0);
}

static ssize_t socket_write(void *owner, const void *bytes, size_t n_bytes)
{
    const struct connection *connection = owner;
    return send(connection->fd, bytes, n_bytes, MSG_NOSIGNAL);
}

/* Results as of read() or write(); *events: what to wait for after EAGAIN. */
static ssize_t tls_moved(enum tls_result result, size_t moved, short *events)
{
    *events = result == TLS_WANTS_WRITE ? POLLOUT : POLLIN;
    if (result == TLS_MOVED)
        return (ssize_t)moved;
    errno = result == TLS_FAILED ? EPROTO : EAGAIN;
    return result == TLS_ENDED ? 0 : -1;
}

static ssize_t read_some(struct connection *connection, void *bytes, size_t n_bytes, short *events)
{
    size_t moved;
    *events = POLLIN;
    if (!connection->channel)
        return socket_read(connection, bytes, n_bytes);
    enum tls_result result = tls_read(connection->channel, bytes, n_bytes, &moved);
    return tls_moved(result, moved, events);
}

static ssize_t write_some(struct connection *connection, const void *bytes, size_t n_bytes,
                          short *events)
{
    size_t moved;
    *events = POLLOUT;
    if (!connection->channel)
        return socket_write(connection, bytes, n_bytes);
    enum tls_result result = tls_write(connection->channel, bytes, n_bytes, &moved);
    return tls_moved(result, moved, events);
}

static enum sheen_status start_tls(struct connection *connection, const struct address *address,
                                   const struct tls_files *files, struct sheen_error *error)
{
    char text[TLS_TEXT_BYTES];
    const struct tls_io io = {socket_read, socket_write, connection};
    struct tls_context *context = tls_context_create(TLS_CLIENT, files, text);
    if (!context)
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    connection->channel = tls_channel_create(context, &io, address->host);
    tls_context_destroy(context);
    return connection->channel ? SHEEN_OK : status_set(error, SHEEN_NO_MEMORY, "no memory for TLS");
}

enum sheen_status connection_open(struct connection *connection, const struct address *address,
                                  const struct tls_files *files, uint32_t timeout_ms,
                                  struct sheen_error *error)
{
    *connection = (struct connection){.fd = -1, .kind = address->kind, .timeout_ms = timeout_ms};
    if (address->kind == ADDRESS_UNIX)
        return open_unix(connection, address->path, error);
    enum sheen_status status = open_tcp(connection, address, error);
    if (!status && address->kind == ADDRESS_TLS)
        status = start_tls(connection, address, files, error);
    if (status)
        connection_finish(connection);
    return status;
}

enum sheen_status connection_pair(struct connection *connection, int *peer_fd, uint32_t timeout_ms,
                                  struct sheen_error *error)
{
    int fds[2];
    *connection = (struct connection){.fd = -1, .kind = ADDRESS_UNIX, .timeout_ms = timeout_ms};
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds) != 0)
        return status_set(error, SHEEN_NO_SERVER, "cannot make a socket pair: %s", strerror(errno));
    int flags = fcntl(fds[0], F_GETFL);
    if (flags < 0 || fcntl(fds[0], F_SETFL, flags | O_NONBLOCK) != 0) {
        int reason = errno;
        close(fds[0]);
        close(fds[1]);
        return status_set(error, SHEEN_NO_SERVER, "cannot make a socket non-blocking: %s",
                          strerror(reason));
    }
    connection->fd = fds[0];
    *peer_fd = fds[1];
    return SHEEN_OK;
}

/* Called after a transfer of no bytes: waits, or reports why waiting is useless. */
static enum sheen_status retry(const struct connection *connection, short events,
                               struct sheen_error *error)
{
    if (errno == EINTR)
        return SHEEN_OK;
    if (connection->channel && *tls_reason(connection->channel))
        return status_set(error, SHEEN_LOST_SERVER, "lost server: TLS: %s",
                          tls_reason(connection->channel));
    if (errno != EAGAIN && errno != EWOULDBLOCK)
        return status_set(error, SHEEN_LOST_SERVER, "lost server: %s", strerror(errno));
    int ready = wait_for(connection, events);
    if (ready > 0)
        return SHEEN_OK;
    if (ready < 0)
        return status_set(error, SHEEN_LOST_SERVER, "lost server: %s", strerror(errno));
    return status_set(error, SHEEN_TIMEOUT, "the server said nothing for %g s",
                      connection->timeout_ms / 1e3);
}

enum sheen_status connection_write(struct connection *connection, const void *bytes, size_t n_bytes,
                                   struct sheen_error *error)
{
    const uint8_t *next = bytes;
    while (n_bytes > 0) {
        short events;
        ssize_t n = write_some(connection, next, n_bytes, &events);
        if (n > 0) {
            next += n;
            n_bytes -= (size_t)n;
            continue;
        }
        enum sheen_status status = retry(connection, events, error);
        if (status)
            return status;
    }
    return SHEEN_OK;
}

enum sheen_status connection_read(struct connection *connection, void *bytes, size_t n_bytes,
                                  size_t *n_got, struct sheen_error *error)
{
    uint8_t *first = bytes;
    connection->wants = 0;
    while (*n_got < n_bytes) {
        short events;
        ssize_t n = read_some(connection, first + *n_got, n_bytes - *n_got, &events);
        if (n > 0) {
            *n_got += (size_t)n;
            continue;
        }
        if (n == 0)
            return status_set(error, SHEEN_LOST_SERVER,
                              "lost server: it closed the connection before its answer was whole");
        if (connection->must_not_wait && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            connection->wants = events;
            return status_set(error, SHEEN_AGAIN, "no answer is whole yet");
        }
        enum sheen_status status = retry(connection, events, error);
        if (status)
            return status;
    }
    return SHEEN_OK;
}

void connection_finish(struct connection *connection)
{
    if (connection->channel)
        tls_end(connection->channel);
    tls_channel_destroy(connection->channel);
    connection->channel = NULL;
    if (connection->fd >= 0)
        close(connection->fd);
    connection->fd = -1;
}
