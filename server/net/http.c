#include "server/net/http.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/base/clock.h"

#define HEAD_BYTES 256

struct http_connection {
    struct loop_source source; /* fd -1: free */
    struct http *http;
    enum { HTTP_READING, HTTP_ANSWERING, HTTP_LINGERING } state;
    uint64_t end_us; /* latest time when it is closed */
    size_t received;
    char request[HTTP_MAX_REQUEST_BYTES + 1];
    char head[HEAD_BYTES];
    size_t head_length, sent; /* sent: bytes of head and body together */
    struct text_buffer body;
};

struct http {
    struct loop *loop;
    struct http_handler handler;
    int most; /* connections used */
    struct http_connection connections[HTTP_MAX_CONNECTIONS];
};

static void drop(struct http_connection *connection)
{
    int fd = connection->source.fd;
    if (fd < 0)
        return;
    loop_unwatch(connection->http->loop, &connection->source);
    close(fd);
    text_buffer_finish(&connection->body);
}

static const char *reason_of(int status)
{
    switch (status) {
    case 200:
        return "OK";
    case 400:
        return "Bad Request";
    case 404:
        return "Not Found";
    case 405:
        return "Method Not Allowed";
    case 431:
        return "Request Header Fields Too Large";
    case 503:
        return "Service Unavailable";
    default:
        return "Internal Server Error";
    }
}

/* Shuts down writing and waits for the peer to close. Closing a socket with unread input would
 * reset the connection, and the peer would lose the answer. */
static void linger(struct http_connection *connection)
{
    uint64_t end_us = clock_now_us() + HTTP_LINGER_US;
    connection->state = HTTP_LINGERING;
    if (end_us < connection->end_us)
        connection->end_us = end_us;
    shutdown(connection->source.fd, SHUT_WR);
    loop_change(connection->http->loop, &connection->source, EPOLLIN);
}

/* Throws away input until the peer closes too. */
static void throw_away(struct http_connection *connection)
{
    ssize_t n = read(connection->source.fd, connection->request, HTTP_MAX_REQUEST_BYTES);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR))
        drop(connection);
}

/* Writes as much of the answer as the socket takes, and shuts down after the last byte. */
static void send_some(struct http_connection *connection)
{
    size_t all = connection->head_length + connection->body.length;
    while (connection->sent < all) {
        bool head = connection->sent < connection->head_length;
        const char *from =
            head ? connection->head + connection->sent
                 : connection->body.bytes + connection->sent - connection->head_length;
        size_t n = head ? connection->head_length - connection->sent : all - connection->sent;
        ssize_t sent = send(connection->source.fd, from, n, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            loop_change(connection->http->loop, &connection->source, EPOLLOUT);
            return;
        }
        if (sent < 0) {
            drop(connection);
            return;
        }
        connection->sent += (size_t)sent;
    }
    linger(connection);
}

static void answer(struct http_connection *connection, int status)
{
    struct text_buffer *body = &connection->body;
    if (status == 200 && body->failed)
        status = 500; /* do not send half an answer */
    if (status != 200 && status != 503) {
        text_buffer_finish(body);
        text_buffer_add(body, "%s\n", reason_of(status));
    }
    int n =
        snprintf(connection->head, sizeof connection->head,
                 "HTTP/1.1 %d %s\r\nContent-Type: text/plain; version=0.0.4; "
                 "charset=utf-8\r\nContent-Length: %zu\r\n%sConnection: close\r\n\r\n",
                 status, reason_of(status), body->length, status == 405 ? "Allow: GET\r\n" : "");
    connection->head_length = (size_t)n;
    connection->state = HTTP_ANSWERING;
    send_some(connection);
}

/* Parses the request line, "GET /path HTTP/1.x". Header fields are ignored. */
static int parse_line(char *line, const char **path)
{
    line[strcspn(line, "\r\n")] = 0;
    char *start = strchr(line, ' '), *version = start ? strchr(start + 1, ' ') : NULL;
    if (!version || start[1] != '/' || strncmp(version, " HTTP/1.", 8) != 0)
        return 400;
    *start++ = *version = 0;
    start[strcspn(start, "?")] = 0;
    *path = start;
    return strcmp(line, "GET") == 0 ? 200 : 405;
}

int http_parse(char *request, size_t length, const char **path)
{
    if (memchr(request, 0, length))
        return 400;
    if (strstr(request, "\r\n\r\n") || strstr(request, "\n\n"))
        return parse_line(request, path);
    return length == HTTP_MAX_REQUEST_BYTES ? 431 : 0;
}

static void read_some(struct http_connection *connection)
{
    ssize_t n = recv(connection->source.fd, connection->request + connection->received,
                     HTTP_MAX_REQUEST_BYTES - connection->received, MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
        return;
    if (n <= 0) {
        drop(connection);
        return;
    }
    connection->received += (size_t)n;
    connection->request[connection->received] = 0;
    const struct http_handler *handler = &connection->http->handler;
    const char *path = NULL;
    int status = http_parse(connection->request, connection->received, &path);
    if (status == 200)
        status = handler->get(handler->owner, path, &connection->body);
    if (status != 0)
        answer(connection, status);
}

static void connection_ready(struct loop_source *source, uint32_t events)
{
    struct http_connection *connection = source->owner;
    if (connection->state != HTTP_READING && events & (EPOLLHUP | EPOLLERR))
        drop(connection);
    else if (connection->state == HTTP_ANSWERING)
        send_some(connection);
    else if (connection->state == HTTP_LINGERING)
        throw_away(connection);
    else
        read_some(connection);
}

struct http *http_create(struct loop *loop, const struct http_handler *handler, struct error *error)
{
    struct http *http = calloc(1, sizeof *http);
    if (!http) {
        error_set(error, ERROR_SERVER, "no memory for the metrics' connections");
        return NULL;
    }
    http->loop = loop;
    http->handler = *handler;
    http->most = HTTP_MAX_CONNECTIONS;
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++) {
        http->connections[i].http = http;
        http->connections[i].source.fd = -1;
    }
    return http;
}

void http_destroy(struct http *http)
{
    if (!http)
        return;
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++)
        drop(&http->connections[i]);
    free(http);
}

/* Ranks connections; the lowest is closed for a new one: 0 was answered but does not close, 1 has
 * not sent its request, 2 is being answered. */
static int value_of(const struct http_connection *connection)
{
    return connection->state == HTTP_LINGERING ? 0 : connection->state == HTTP_READING ? 1 : 2;
}

/* Returns a free place, or that of the oldest connection of the lowest rank. So idle peers cannot
 * keep a health probe out. */
static struct http_connection *find_place(struct http *http)
{
    struct http_connection *least = &http->connections[0];
    for (int i = 0; i < http->most; i++) {
        struct http_connection *connection = &http->connections[i];
        if (connection->source.fd < 0)
            return connection;
        int below = value_of(connection) - value_of(least);
        if (below < 0 || (below == 0 && connection->end_us < least->end_us))
            least = connection;
    }
    drop(least);
    return least;
}

void http_limit(struct http *http, unsigned most)
{
    http->most = (int)most;
}

void http_accept(struct http *http, int fd)
{
    struct http_connection *connection = find_place(http);
    connection->source = (struct loop_source){fd, connection_ready, connection};
    connection->end_us = clock_now_us() + HTTP_TIMEOUT_US;
    connection->received = connection->sent = connection->head_length = 0;
    connection->state = HTTP_READING;
    text_buffer_init(&connection->body, HTTP_MAX_ANSWER_BYTES);
    if (!loop_watch(http->loop, &connection->source, EPOLLIN, NULL))
        close(fd);
    else
        read_some(
            connection); /* a request that has come is answered before others take the place */
}

void http_tick(struct http *http, uint64_t now_us)
{
    for (int i = 0; i < HTTP_MAX_CONNECTIONS; i++)
        if (now_us > http->connections[i].end_us)
            drop(&http->connections[i]);
}
