/* One connected socket: it delivers incoming messages and sends outgoing bytes. Both directions are
 * bounded, and neither blocks.
 *
 * Input is collected in one buffer, which is small until a long message comes; whole messages go to
 * the owner. Output is a list of blocks, some of them borrowed (pixels), written as fast as the
 * socket takes them. The owner decides how much may wait: it looks at conn_unsent_bytes() before it
 * sends more.
 *
 * The loop's intake (intake.h) decides which conn handles input next: one message in each turn.
 *
 * Thread: the loop's. Callbacks are called from the loop. A callback may close the conn, but must not
 * finish it. */
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

#define CONN_IN_BYTES 4096u /* size of the buffer at first, and again when the client is idle */
#define CONN_MOST_IN_BYTES (MESSAGE_HEADER_BYTES + PROTOCOL_MAX_CHUNK_BYTES)

struct conn;
struct iovec;
struct tls_channel;

struct conn_handler {
    /* A whole message has come. `body` has header->length bytes and is valid during the call. */
    void (*message)(void *owner, const struct message_header *header, const uint8_t *body);
    /* The input is not a message. The input was thrown away, and nothing is read until the owner
     * closes the conn. Only those members of *header are set that were read before the error. */
    void (*malformed)(void *owner, const struct message_header *header, enum header_error error);
    /* A message begins that needs a larger buffer. May the buffer have `bytes` bytes from now on,
     * until conn_trim() or the end? If not, the message's body is thrown away as it comes, unless
     * the owner has closed the conn. */
    bool (*make_room)(void *owner, const struct message_header *header, size_t bytes);
};

/* How bytes are transferred: over the plain socket, or by TLS (conn_tls.h). */
struct conn_transport {
    /* Results and errno as those of read() and sendmsg(). */
    ssize_t (*read)(struct conn *conn, void *bytes, size_t size);
    ssize_t (*write)(struct conn *conn, struct iovec *pieces, size_t n);
    /* Does the transport hold bytes for read() that the socket no longer reports? */
    bool (*pending)(const struct conn *conn);
    void (*end)(struct conn *conn); /* announces that nothing more will be written */
    /* Frees what belongs to the socket, which is about to be closed. */
    void (*finish)(struct conn *conn);
};

enum conn_state {
    CONN_OPEN,
    CONN_FLUSHING,  /* unsent output is sent, input is thrown away */
    CONN_LINGERING, /* all is sent; input is thrown away until the peer closes too */
    CONN_CLOSED,
};

struct conn_block; /* a block of output */

struct conn {
    enum conn_state state;
    struct loop *loop;
    struct loop_source source;
    uint32_t events;             /* that the loop watches for */
    struct intake_source intake; /* asks while there may be input to handle */
    const struct conn_handler *handler;
    void *owner;
    const struct conn_transport *transport;
    struct tls_channel *channel; /* used by the TLS transport; NULL: plain */
    bool read_wants_write;       /* TLS must write before it can read */
    char reason[160];            /* why the transport failed; "": no reason known */

    uint8_t *in;
    size_t in_at, in_used, in_capacity; /* where unhandled input begins, and its length */
    size_t skipped;  /* bytes still to come of a message without room, which are thrown away */
    bool held;       /* delivers no message and reads nothing */
    bool postponed;  /* reads nothing until its turn in the intake comes */
    bool peer_ended; /* the peer will send no more */

    STAILQ_HEAD(conn_blocks, conn_block) unsent;
    struct block_cache *block_cache; /* memory of the blocks; set by the owner; NULL: malloc() */
    size_t unsent_bytes;
    uint64_t *sent_bytes; /* counter of all sent bytes, shared by all conns */

    /* When bytes were last received and sent, by clock_now_us(). */
    uint64_t last_in_us, last_out_us;
    uint64_t message_since_us; /* when the oldest byte in the buffer came, or when input resumed */
};

/* Takes over the socket, makes it non-blocking and watches it. Bytes sent are added to *sent_bytes.
 * On failure closes the socket and x
 * due. */
bool conn_init(struct conn *conn, struct loop *loop, int fd, const struct conn_handler *handler,
               void *owner, uint64_t *sent_bytes, struct error *error);
/* Closes the connection at once and releases all unsent blocks. */
void conn_finish(struct conn *conn);

/* Closes a socket without a conn, after sending up to `size` bytes. Bytes that the socket does not
 * take at once are lost. */
void conn_turn_away(int fd, const void *bytes, size_t size);

/* conn_send() and conn_send_block() queue output; conn_flush() starts to write it, and the rest
 * follows as the socket takes it. On a closed conn the bytes are dropped. If memory is short the
 * conn closes. */
void conn_send(struct conn *conn, const void *bytes, size_t size); /* copies the bytes */
/* Borrows the bytes: they must stay valid until release(owner) is called, which happens exactly
 * once, whether they were sent or not. release may be NULL if a later block of the same conn keeps
 * the bytes. */
void conn_send_block(struct conn *conn, const void *bytes, size_t size, void (*release)(void *),
                     void *owner);
void conn_flush(struct conn *conn);

/* Gives the conn's input its turns in this party, which must outlive the conn. Before this call the
 * input has its turns in the party of strangers. */
void conn_join(struct conn *conn, struct intake_party *party);

/* Stops or resumes input. */
void conn_hold(struct conn *conn, bool held);
/* Frees the large input buffer that a long message needed, unless it still holds input. */
void conn_trim(struct conn *conn);

/* Closes the connection after all queued output is sent. */
void conn_close_after_flush(struct conn *conn);
void conn_close(struct conn *conn); /* at once; unsent output is dropped */

static inline size_t conn_unsent_bytes(const struct conn *conn)
{
    return conn->unsent_bytes;
}

#endif
