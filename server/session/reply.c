#include "server/session/reply.h"

#include <string.h>

struct reply {
    TAILQ_ENTRY(reply) link;
    struct block_cache *block_cache;
    uint32_t seq;
    bool asks_frame;
    enum request_class request_class; /* of the frame that is asked for */
    bool ready, last;
    uint8_t *message; /* header and body */
    size_t length;
    struct encoded *encoded; /* DATA; NULL: none */
};

void reply_list_init(struct reply_list *list, struct block_cache *block_cache)
{
    *list = (struct reply_list){.block_cache = block_cache};
    TAILQ_INIT(&list->replies);
}

struct reply *reply_expect(struct reply_list *list, uint32_t seq)
{
    struct reply *reply = block_cache_take(list->block_cache, sizeof *reply);
    if (!reply)
        return NULL;
    *reply = (struct reply){.block_cache = list->block_cache, .seq = seq};
    TAILQ_INSERT_TAIL(&list->replies, reply, link);
    list->n++;
    return reply;
}

struct reply *reply_expect_frame(struct reply_list *list, uint32_t seq,
                                 enum request_class request_class)
{
    struct reply *reply = reply_expect(list, seq);
    if (reply) {
        reply->asks_frame = true;
        reply->request_class = request_class;
    }
    return reply;
}

bool reply_list_owes(const struct reply_list *list, uint32_t seq)
{
    const struct reply *reply;
    TAILQ_FOREACH (reply, &list->replies, link)
        if (reply->seq == seq)
            return true;
    return false;
}

uint32_t reply_seq(const struct reply *reply)
{
    return reply->seq;
}

static void drop(struct reply_list *list, struct reply *reply)
{
    TAILQ_REMOVE(&list->replies, reply, link);
    list->n--;
    encoded_destroy(reply->encoded);
    block_cache_give(list->block_cache, reply->message);
    block_cache_give(list->block_cache, reply);
}

void reply_list_finish(struct reply_list *list)
{
    while (!TAILQ_EMPTY(&list->replies))
        drop(list, TAILQ_FIRST(&list->replies));
}

bool reply_fill(struct reply *reply, uint8_t type, const void *body)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    reply->ready = true;
    if (!message_encode(type, reply->seq, body, buffer, sizeof buffer, &reply->length))
        return false;
    reply->message = block_cache_take(reply->block_cache, reply->length);
    if (!reply->message)
        return false;
    memcpy(reply->message, buffer, reply->length);
    return true;
}

bool reply_fill_frame(struct reply *reply, const sheen_Frame *frame, struct encoded *encoded)
{
    reply->encoded = encoded;
    return reply_fill(reply, MESSAGE_FRAME, frame);
}

bool reply_fill_records(struct reply *reply, uint8_t type, const void *body,
                        struct encoded *records)
{
    reply->encoded = records;
    reply->request_class = CLASS_BATCH; /* whose output may be unsent for long */
    return reply_fill(reply, type, body);
}

void reply_mark_last(struct reply *reply)
{
    reply->last = true;
}

static void release_encoded(void *owner)
{
    encoded_destroy(owner);
}

static void send_data_header(struct conn *conn, uint32_t seq, uint32_t length, bool end)
{
    const struct message_header header = {.major = PROTOCOL_MAJOR,
                                          .type = MESSAGE_DATA,
                                          .flags = end ? MESSAGE_END : 0,
                                          .length = length,
                                          .seq = seq};
    uint8_t bytes[MESSAGE_HEADER_BYTES];
    message_header_encode(&header, bytes);
    conn_send(conn, bytes, sizeof bytes);
}

/* Cuts the pieces into DATA messages. When the last block is sent, all pieces are freed. */
static void send_data(struct conn *conn, uint32_t seq, struct encoded *encoded)
{
    size_t piece = 0, offset = 0;
    for (uint64_t left = encoded->size; left > 0;) {
        uint32_t length = left < PROTOCOL_MAX_DATA_BYTES ? (uint32_t)left : PROTOCOL_MAX_DATA_BYTES;
        left -= length;
        send_data_header(conn, seq, length, left == 0);
        while (length > 0) {
            const struct encoded_piece from = encoded->pieces[piece];
            size_t n = from.size - offset < length ? from.size - offset : length;
            length -= (uint32_t)n;
            bool end = left == 0 && length == 0;
            conn_send_block(conn, from.bytes + offset, n, end ? release_encoded : NULL, encoded);
            if (end)
                return;
            offset += n;
            if (offset == from.size) {
                piece++;
                offset = 0;
            }
        }
    }
}

static void send_reply(struct reply_list *list, struct reply *reply, struct conn *conn)
{
    conn_send(conn, reply->message, reply->length);
    if (!reply->encoded)
        return;
    if (reply->request_class == CLASS_INTERACTIVE) {
        reply->encoded->unsent = &list->unsent;
        list->unsent++;
    }
    send_data(conn, reply->seq, reply->encoded);
    reply->encoded = NULL; /* owned by the connection from here on */
}

/* May the reply leave now? owed[c]: the reply to an earlier request for a frame of class c has not
 * left yet. */
static bool is_due(const struct reply_list *list, const struct reply *reply,
                   const bool owed[static N_CLASSES])
{
    if (!reply->ready)
        return false;
    if (list->is_ordered || reply->last)
        return reply == TAILQ_FIRST(&list->replies);
    if (!reply->encoded || !reply->asks_frame)
        return true;
    bool is_clear = reply->request_class != CLASS_INTERACTIVE || list->unsent == 0;
    return is_clear && !owed[reply->request_class];
}

void reply_send_due(struct reply_list *list, struct conn *conn)
{
    bool owed[N_CLASSES] = {false}, sent = false, closes = false, is_over = false;
    struct reply *reply = TAILQ_FIRST(&list->replies);
    while (reply && !is_over) {
        struct reply *next = TAILQ_NEXT(reply, link);
        is_over = reply->last; /* no reply leaves after the last */
        if (is_due(list, reply, owed)) {
            closes = reply->last;
            send_reply(list, reply, conn);
            drop(list, reply);
            sent = true;
        } else {
            owed[reply->request_class] |= reply->asks_frame;
            is_over |= list->is_ordered; /* no reply may overtake this one */
        }
        reply = next;
    }
    if (sent)
        conn_flush(conn);
    if (closes)
        conn_close_after_flush(conn);
}
