/* A minimal web server for health and metrics, on the loopback or a Unix socket: HTTP/1.1, only
 * GET, one request for each connection, no request body, no keep-alive. Everything is bounded: a
 * request has at most HTTP_MAX_REQUEST_BYTES, there are at most HTTP_MAX_CONNECTIONS, and a
 * connection lasts at most HTTP_TIMEOUT_US. After the answer it has HTTP_LINGER_US of that time for
 * the peer to read the answer and to close. A connection that exceeds a bound is closed.
 * Thread: the loop's. */
#ifndef SHEEN_NET_HTTP_H
#define SHEEN_NET_HTTP_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/net/loop.h"
#include "server/base/text_buffer.h"

#define HTTP_MAX_REQUEST_BYTES 4096
#define HTTP_MAX_CONNECTIONS 32
#define HTTP_MAX_ANSWER_BYTES (256u * 1024)
#define HTTP_TIMEOUT_US 5000000u
#define HTTP_LINGER_US 2000000u

struct http;

/* get() writes the body of the answer to GET `path` and returns its status: 200, 404 or 503. */
struct http_handler {
    int (*get)(void *owner, const char *path, struct text_buffer *body);
    void *owner;
};

/* Parses the bytes of a request received so far: `length` bytes and a 0 behind them. Returns 0
 * while the request is incomplete; 200 for a GET, and sets *path to the path without a query, which
 * begins with '/' and points into `request` (which is modified); else the status to answer: 400,
 * 405 or 431. Pure. */
int http_parse(char *request, size_t length, const char **path);

struct http *http_create(struct loop *loop, const struct http_handler *handler,
                         struct error *error);
void http_destroy(struct http *http); /* closes all connections; NULL is safe */

/* From now on there are at most `most` connections, 1 to HTTP_MAX_CONNECTIONS. Call it before the first. */
void http_limit(struct http *http, unsigned most);
/* Takes over a connected socket, and answers at once if the request is there already: no number of
 * other connections can keep a health probe from its answer. If there are too many already, one is closed for it:
 * the oldest one that was answered but does not close, else the oldest that has not sent its
 * request, else the oldest. */
void http_accept(struct http *http, int fd);
/* Closes connections that have lasted too long. */
void http_tick(struct http *http, uint64_t now_us);

#endif
