#include "server/net/conn.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/fault.h"

#define MAX_PIECES 64 /* blocks per sendmsg() */

struct conn_block {
    STAILQ_ENTRY(conn_block) link;
    const uint8_t *bytes;
    size_t size, sent;
    void (*release)(void *);
    void *owner;
    uint8_t copy[]; /* the bytes of conn_send() */
};

/* --- the plain socket */

static ssize_t plain_read(struct conn *conn, void *bytes, size_t size)
{
    return read(conn->source.fd, bytes, size);
}

static ssize_t plain_write(struct conn *conn, struct iovec *pieces, size_t n)
{
    const struct msghdr message = {.msg_iov = pieces, .msg_iovlen = n};
    return sendmsg(conn->source.fd, &message, MSG_NOSIGNAL);
}

static bool plain_pending(const struct conn *conn)
{
    (void)conn;
    return false;
}

static void plain_nothing(struct conn *conn)
{
    (void)conn;
}

static const struct conn_transport PLAIN = {plain_read, plain_write, plain_pending, plain_nothing,
                                            plain_nothing};

/* --- output and the end */

static void update_events(struct conn *conn)
{
    bool waits = conn->held || conn->postponed;
    bool reads = !conn->peer_ended && (conn->state != CONN_OPEN || !waits);
    bool writes = !STAILQ_EMPTY(&conn->unsent) || conn->read_wants_write;
    uint32_t events = (reads ? EPOLLIN : 0u) | (writes ? EPOLLOUT : 0u);
    if (events != conn->events)
        loop_change(conn->loop, &conn->source, events);
    conn->events = events;
}

static void ask_for_turn(struct conn *conn, bool asks)
{
    intake_ask(loop_intake(conn->loop), &conn->intake, asks);
}

static void drop_block(struct conn *conn)
{
    struct conn_block *block = STAILQ_FIRST(&conn->unsent);
    STAILQ_REMOVE_HEAD(&conn->unsent, link);
    conn->unsent_bytes -= block->size - block->sent;
    if (block->release)
        block->release(block->owner);
    block_cache_give(conn->block_cache, block);
}

void conn_close(struct conn *conn)
{
    if (conn->state == CONN_CLOSED)
        return;
    conn->state = CONN_CLOSED;
    int fd = conn->source.fd;
    ask_for_turn(conn, false);
    loop_unwatch(conn->loop, &conn->source);
    conn->transport->finish(conn);
    close(fd);
    while (!STAILQ_EMPTY(&conn->unsent))
        drop_block(conn);
    conn->in_used = 0;
}

void conn_finish(struct conn *conn)
{
    conn_close(conn);
    free(conn->in);
    conn->in = NULL;
}

/* Shuts down writing and waits for the peer to close. Closing a socket with unread input would
 * reset the connection, and the peer would lose what was sent before. */
static void linger(struct conn *conn)
{
    conn->state = CONN_LINGERING;
    conn->last_in_us = clock_now_us();
    conn->transport->end(conn);
    shutdown(conn->source.fd, SHUT_WR);
    if (conn->peer_ended)
        conn_close(conn);
}

void conn_close_after_flush(struct conn *conn)
{
    if (conn->state != CONN_OPEN)
        return;
    conn->state = CONN_FLUSHING;
    conn->in_used = 0;
    conn_flush(conn);
    if (conn->state == CONN_FLUSHING)
        update_events(conn);
}

static struct conn_block *append(struct conn *conn, size_t size, size_t copied)
{
    struct conn_block *block = conn->state == CONN_OPEN
                                   ? block_cache_take(conn->block_cache, sizeof *block + copied)
                                   : NULL;
    if (!block) {
        if (conn->state == CONN_OPEN)
            conn_close(conn);
        return NULL;
    }
    *block = (struct conn_block){.bytes = block->copy, .size = size};
    STAILQ_INSERT_TAIL(&conn->unsent, block, link);
    if (conn->unsent_bytes == 0) /* the clock starts with the first byte to send */
        conn->last_out_us = clock_now_us();
    conn->unsent_bytes += size;
    return block;
}

void conn_send(struct conn *conn, const void *bytes, size_t size)
{
    struct conn_block *block = append(conn, size, size);
    if (block)
        memcpy(block->copy, bytes, size);
}

void conn_send_block(struct conn *conn, const void *bytes, size_t size, void (*release)(void *),
                     void *owner)
{
    struct conn_block *block = append(conn, size, 0);
    if (block) {
        block->bytes = bytes;
        block->release = release;
        block->owner = owner;
    } else if (release) {
        release(owner);
    }
}

/* Fault injection: a socket that takes nothing now, or that is broken. */
static bool fails_to_write(void)
{
    errno = fault_at("send.full") ? EAGAIN : fault_at("send.broken") ? EPIPE : 0;
    return errno != 0;
}

static ssize_t write_some(struct conn *conn)
{
    struct iovec pieces[MAX_PIECES];
    size_t n = 0;
    const struct conn_block *b;
    STAILQ_FOREACH (b, &conn->unsent, link) {
        if (n == MAX_PIECES)
            break;
        struct iovec *piece = &pieces[n++];
        memcpy(&piece->iov_base, &(const void *){b->bytes + b->sent}, sizeof(void *));
        piece->iov_len = b->size - b->sent;
    }
    if (fails_to_write())
        return -1;
    if (pieces[0].iov_len > 1 && fault_at("send.short"))
        pieces[0].iov_len = n = 1; /* one byte of the first block */
    return conn->transport->write(conn, pieces, n);
}

static void count_sent(struct conn *conn, size_t n)
{
    *conn->sent_bytes += n;
    conn->last_out_us = clock_now_us();
    struct conn_block *first;
    while ((first = STAILQ_FIRST(&conn->unsent)) && n >= first->size - first->sent) {
        n -= first->size - first->sent;
        drop_block(conn);
    }
    if (n > 0) {
        first->sent += n;
        conn->unsent_bytes -= n;
    }
}

void conn_flush(struct conn *conn)
{
    if (conn->state == CONN_CLOSED)
        return;
    while (!STAILQ_EMPTY(&conn->unsent)) {
        ssize_t n = write_some(conn);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
            conn_close(conn);
            return;
        }
        if (n < 0)
            break;
        count_sent(conn, (size_t)n);
    }
    if (STAILQ_EMPTY(&conn->unsent) && conn->state == CONN_FLUSHING)
        linger(conn);
    if (conn->state != CONN_CLOSED)
        update_events(conn);
}

void conn_hold(struct conn *conn, bool held)
{
    if (conn->held == held || conn->state == CONN_CLOSED)
        return;
    conn->held = held;
    conn->message_since_us = clock_now_us();
    update_events(conn);
    ask_for_turn(conn, conn->state != CONN_OPEN || !held);
}

static void refuse_input(struct conn *conn, const struct message_header *header,
                         enum header_error error)
{
    conn->in_used = 0;
    conn_hold(conn, true);
    conn->handler->malformed(conn->owner, header, error);
}

/* Moves unhandled input to the start of the buffer. */
static void make_compact(struct conn *conn)
{
    if (conn->in_at > 0)
        memmove(conn->in, conn->in + conn->in_at, conn->in_used);
    conn->in_at = 0;
}

/* The buffer must be compact. */
static bool resize(struct conn *conn, size_t capacity)
{
    uint8_t *in = realloc(conn->in, capacity);
    if (!in)
        return false;
    conn->in = in;
    conn->in_capacity = capacity;
    return true;
}

/* A message of this size begins. */
static void expect(struct conn *conn, const struct message_header *header, size_t size)
{
    if (size <= conn->in_capacity)
        return;
    make_compact(conn);
    if (conn->handler->make_room(conn->owner, header, size)) {
        if (!resize(conn, size))
            conn_close(conn);
    } else if (conn->state == CONN_OPEN && !conn->held) {
        conn->skipped = size - conn->in_used;
        conn->in_used = 0;
    }
}

/* Throws away bytes of a message that has no room. */
static void skip(struct conn *conn)
{
    size_t n = conn->in_used < conn->skipped ? conn->in_used : conn->skipped;
    if (n == 0)
        return;
    conn->skipped -= n;
    conn->in_used -= n;
    conn->in_at += n;
    if (conn->skipped == 0)
        conn->message_since_us = clock_now_us(); /* for the next message */
}

/* Delivers the first message if it is whole. False: more input must be read first. */
static bool deliver_one(struct conn *conn)
{
    struct message_header header = {0};
    skip(conn);
    if (conn->in_used < MESSAGE_HEADER_BYTES)
        return false;
    enum header_error error = message_header_decode(&header, conn->in + conn->in_at);
    size_t size = MESSAGE_HEADER_BYTES + (size_t)header.length;
    if (error == HEADER_OK && size > CONN_MOST_IN_BYTES)
        error = HEADER_TOO_LONG; /* a type that only servers may send */
    if (error != HEADER_OK) {
        refuse_input(conn, &header, error);
        return true;
    }
    if (conn->in_used < size) {
        expect(conn, &header, size);
        return false;
    }
    const uint8_t *body = conn->in + conn->in_at + MESSAGE_HEADER_BYTES;
    conn->in_at += size;
    conn->in_used -= size;
    conn->message_since_us = clock_now_us();
    conn->handler->message(conn->owner, &header, body);
    return true;
}

void conn_trim(struct conn *conn)
{
    if (conn->state != CONN_OPEN || conn->in_used > 0 || conn->in_capacity <= CONN_IN_BYTES)
        return;
    conn->in_at = 0;
    resize(conn, CONN_IN_BYTES); /* if that fails, the large buffer stays */
}

void conn_join(struct conn *conn, struct intake_party *party)
{
    intake_move(loop_intake(conn->loop), &conn->intake, party);
}

/* Reads once. True if input came, which may hold messages. */
static bool read_more(struct conn *conn)
{
    bool open = conn->state == CONN_OPEN, wanted_write = conn->read_wants_write;
    make_compact(conn);
    size_t room = open ? conn->in_capacity - conn->in_used : conn->in_capacity;
    if (room == 0)
        return false;
    ssize_t n = conn->transport->read(conn, conn->in + (open ? conn->in_used : 0), room);
    if (conn->read_wants_write != wanted_write)
        update_events(conn);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
        return false;
    if (n < 0 || (n == 0 && conn->state == CONN_LINGERING)) {
        conn_close(conn);
        return false;
    }
    if (n == 0) {
        conn->peer_ended = true;
        update_events(conn);
        return false;
    }
    if (open) {
        conn->last_in_us = clock_now_us();
        if (conn->in_used == 0 && conn->skipped == 0)
            conn->message_since_us = conn->last_in_us;
        conn->in_used += (size_t)n;
    }
    return open;
}

/* One turn of the intake: delivers one message, and reads once before that if no message is whole.
 * After shutdown the turn only reads, to throw the input away. The conn asks for another turn only if
 * the buffer may hold another message: of unread bytes epoll tells. */
static void handle_turn(struct intake_source *source)
{
    struct conn *conn = source->owner;
    bool delivered = false;
    conn->postponed = false;
    if (conn->state != CONN_OPEN)
        read_more(conn);
    else if (!conn->held)
        delivered = deliver_one(conn) || (conn->state == CONN_OPEN && !conn->held &&
                                          read_more(conn) && deliver_one(conn));
    bool more = (delivered && conn->in_used >= MESSAGE_HEADER_BYTES) ||
                (conn->state == CONN_OPEN && conn->transport->pending(conn));
    ask_for_turn(conn, conn->state == CONN_OPEN && !conn->held && more);
    update_events(conn);
}

static void conn_ready(struct loop_source *source, uint32_t events)
{
    struct conn *conn = source->owner;
    if (events & EPOLLIN || (events & EPOLLOUT && conn->read_wants_write)) {
        ask_for_turn(conn, true);
        /* Without this the loop would wake up for the unread input again and again. */
        conn->postponed = intake_is_postponed(&conn->intake, clock_now_us());
        update_events(conn);
    }
    if (conn->state != CONN_CLOSED && (events & EPOLLOUT))
        conn_flush(conn);
    /* Both directions are closed. All input has been read, unless it was held. */
    if (conn->state != CONN_CLOSED && (events & (EPOLLHUP | EPOLLERR)) &&
        (!(events & EPOLLIN) || conn->peer_ended))
        conn_close(conn);
}

bool conn_init(struct conn *conn, struct loop *loop, int fd, const struct conn_handler *handler,
               void *owner, uint64_t *sent_bytes, struct error *error)
{
    *conn = (struct conn){
        .loop = loop,
        .source = {fd, conn_ready, conn},
        .events = EPOLLIN,
        .handler = handler,
        .owner = owner,
        .transport = &PLAIN,
        .sent_bytes = sent_bytes,
        .last_in_us = clock_now_us(),
        .last_out_us = clock_now_us(),
        .in = malloc(CONN_IN_BYTES),
        .in_capacity = CONN_IN_BYTES,
    };
    STAILQ_INIT(&conn->unsent);
    intake_add_source(&conn->intake, loop_strangers(loop), handle_turn, conn);
    int flags = fcntl(fd, F_GETFL);
    if (!conn->in)
        error_set(error, ERROR_SERVER, "no memory for another connection");
    else if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0)
        error_set(error, ERROR_SERVER, "fcntl: %s", strerror(errno));
    else if (loop_watch(loop, &conn->source, EPOLLIN, error))
        return true;
    close(fd);
    conn->source.fd = -1;
    conn->state = CONN_CLOSED;
    free(conn->in);
    conn->in = NULL;
    return false;
}

void conn_turn_away(int fd, const void *bytes, size_t size)
{
    if (size > 0 && send(fd, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) > 0)
        shutdown(fd, SHUT_WR);
    close(fd);
}
