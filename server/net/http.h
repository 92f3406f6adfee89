/* A minimal web server for health and metrics, on the loopback or a Unix socket: HTTP/1.1, GET only,
 * one request for each connection, no request body, no keep-alive. Everything is bounded: a request
 * has HTTP_MAX_REQUEST_BYTES, there are HTTP_MAX_CONNECTIONS at once, a connection takes at most
 * HTTP_TIMEOUT_US from accept to the end, and HTTP_LINGER_US of it after the answer, for the peer to
 * read it and close. A connection that goes over a bound is closed.
 * Thread: the loop's. */
#ifndef SHEEN_NET_HTTP_H
#define SHEEN_NET_HTTP_H

#include <stddef.h>

#include "server/base/error.h"
#include "server/net/loop.h"
#include "server/base/text_buffer.h"

#define HTTP_MAX_REQUEST_BYTES 4096
#define HTTP_MAX_CONNECTIONS 8
#define HTTP_MAX_ANSWER_BYTES (256u * 1024)
#define HTTP_TIMEOUT_US 5000000u
#define HTTP_LINGER_US 2000000u

struct http;

/* Writes the answer to GET `path` and returns its status: 200, 404 or 503. */
struct http_handler {
    int (*get)(void *owner, const char *path, struct text_buffer *body);
    void *owner;
};

/* Reads what has come of a request: `length` bytes and a 0 behind them. Returns 0 when its end is
 * still to come, 200 when it GETs *path, which begins with '/' and lies in `request` (which is cut
 * up for it), without a query; else what to answer: 400, 405 or 431. Pure. */
int http_parse(char *request, size_t length, const char **path);

struct http *http_create(struct loop *loop, const struct http_handler *handler,
                         struct error *error);
void http_destroy(struct http *http); /* closes all; NULL is safe */

/* Takes a connection over. With HTTP_MAX_CONNECTIONS there already one makes room: the oldest that
 * has its answer and does not close, else the oldest that has not asked yet, else the oldest. */
void http_accept(struct http *http, int fd);
/* Closes what has taken too long. */
void http_tick(struct http *http, uint64_t now_us);

#endif
