/* One connected socket: messages in, bytes out, both bounded, neither blocking.
 *
 * Input lies in one buffer, which is small until a long message comes; whole messages are handed to
 * the owner. Output is a list of blocks, some of them borrowed (pixels), which are written as fast as
 * the socket takes them. The owner decides how much may wait: it asks conn_unsent_bytes() before it
 * sends more.
 * Thread: the loop's. Callbacks come from the loop or from conn_deliver(); a callback must not
 * finish the conn, only close it. */
#ifndef SHEEN_NET_CONN_H
#define SHEEN_NET_CONN_H

#include <stddef.h>
#include <stdint.h>
#include <sys/queue.h>
#include <sys/types.h>

#include "protocol/frame.h"
#include "protocol/limits.h"
#include "server/base/error.h"
#include "server/net/loop.h"
#include "server/base/block_cache.h"

#define CONN_IN_BYTES 4096u /* of the buffer at first and again when the client is idle */
#define CONN_MOST_IN_BYTES (MESSAGE_HEADER_BYTES + PROTOCOL_MAX_CHUNK_BYTES)

struct conn;
struct iovec;
struct tls_channel;

struct conn_handler {
    void (*message)(void *owner, const struct message_header *header, const uint8_t *body);
    /* The input is no message. It has been thrown away, and the conn is held until the owner closes
     * it. Only those members of *header are set that could be read before the error. */
    void (*malformed)(void *owner, const struct message_header *header, enum header_error error);
    /* A message begins for which the buffer is too small. May the buffer have so many bytes from now
     * on, until conn_trim() or the end? If not, the body of the message is thrown away as it comes,
     * unless the owner has closed the conn. */
    bool (*make_room)(void *owner, const struct message_header *header, size_t bytes);
};

/* How bytes move: over the plain socket, or TLS (conn_tls.h). */
struct conn_transport {
    /* Results and errno as those of read() and sendmsg(). */
    ssize_t (*read)(struct conn *conn, void *bytes, size_t size);
    ssize_t (*write)(struct conn *conn, struct iovec *pieces, size_t n);
    /* Does the transport hold bytes for read() that the socket no longer reports? */
    bool (*pending)(const struct conn *conn);
    void (*end)(struct conn *conn);    /* nothing more is written */
    void (*finish)(struct conn *conn); /* the socket goes */
};

enum conn_state {
    CONN_OPEN,
    CONN_FLUSHING,  /* what is unsent goes out, input is thrown away */
    CONN_LINGERING, /* all is sent; input is thrown away until the peer has seen the end */
    CONN_CLOSED,
};

struct conn_block; /* a piece of output */

struct conn {
    enum conn_state state;
    struct loop *loop;
    struct loop_source source;
    const struct conn_handler *handler;
    void *owner;
    const struct conn_transport *transport;
    struct tls_channel *channel; /* the TLS transport's; NULL: plain */
    bool read_wants_write;       /* the transport must write before it can read */
    char reason[160];            /* why the transport broke, "" when there is nothing to say */

    uint8_t *in;
    size_t in_used, in_capacity;
    size_t skipped;  /* bytes to come that are thrown away: of a message that has no room */
    bool held;       /* no message is delivered and nothing read */
    bool peer_ended; /* the peer will send no more */

    STAILQ_HEAD(conn_blocks, conn_block) unsent;
    struct block_cache *block_cache; /* where their memory comes from; NULL until the owner says */
    size_t unsent_bytes;
    uint64_t *sent_bytes; /* everybody's; counted up here */

    uint64_t last_in_us, last_out_us; /* when bytes last moved; clock_now_us() */
    uint64_t message_since_us; /* when the oldest byte in the buffer came, or input resumed */
};

/* Takes the socket over, makes it non-blocking and watches it. On failure the fd is closed.
 * *sent_bytes is counted up by what is sent. */
bool conn_init(struct conn *conn, struct loop *loop, int fd, const struct conn_handler *handler,
               void *owner, uint64_t *sent_bytes, struct error *error);
/* Closes the connection at once and releases all unsent blocks. */
void conn_finish(struct conn *conn);

/* Closes a socket that gets no conn, after up to `size` bytes: what the socket does not take at once
 * is lost. */
void conn_turn_away(int fd, const void *bytes, size_t size);

/* Queue output; it is written by conn_flush() and then as the socket takes it. On a closed conn,
 * or without memory (which closes it), the bytes are dropped. */
void conn_send(struct conn *conn, const void *bytes, size_t size); /* copies */
/* Borrows: `bytes` must stay until release(owner) is called, once, sent or not. release may be
 * NULL for a piece that another, later block keeps. */
void conn_send_block(struct conn *conn, const void *bytes, size_t size, void (*release)(void *),
                     void *owner);
void conn_flush(struct conn *conn);

/* Stops and resumes input. After resuming, messages already read wait for conn_deliver(). */
void conn_hold(struct conn *conn, bool held);
void conn_deliver(struct conn *conn);
/* Frees the large input buffer that a long message needed, unless it still holds input. */
void conn_trim(struct conn *conn);

void conn_close_after_flush(struct conn *conn);
void conn_close(struct conn *conn); /* now; unsent output is dropped */

static inline size_t conn_unsent_bytes(const struct conn *conn)
{
    return conn->unsent_bytes;
}

#endif
