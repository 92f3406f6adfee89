#include "server/session/reply.h"

#include <string.h>

struct answer {
    struct answer *next;
    struct block_cache *block_cache;
    uint32_t seq;
    enum request_class request_class;
    bool ready, last;
    uint8_t *message; /* header and body */
    size_t length;
    struct encoded *encoded; /* of a frame, or NULL */
};

struct answer *answer_expect(struct answer_list *list, uint32_t seq,
                             enum request_class request_class)
{
    struct answer *answer = block_cache_take(list->block_cache, sizeof *answer);
    if (!answer)
        return NULL;
    *answer = (struct answer){
        .block_cache = list->block_cache, .seq = seq, .request_class = request_class};
    if (list->tail)
        list->tail->next = answer;
    else
        list->head = answer;
    list->tail = answer;
    list->n++;
    return answer;
}

uint32_t answer_seq(const struct answer *answer)
{
    return answer->seq;
}

/* Takes out the answer behind `before` (NULL: the first). */
static void drop(struct answer_list *list, struct answer *before)
{
    struct answer **link = before ? &before->next : &list->head, *answer = *link;
    *link = answer->next;
    if (list->tail == answer)
        list->tail = before;
    list->n--;
    encoded_destroy(answer->encoded);
    block_cache_give(list->block_cache, answer->message);
    block_cache_give(list->block_cache, answer);
}

void answer_list_finish(struct answer_list *list)
{
    while (list->head)
        drop(list, NULL);
}

bool answer_fill(struct answer *answer, uint8_t type, const void *body)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    answer->ready = true;
    if (!message_encode(type, answer->seq, body, buffer, sizeof buffer, &answer->length))
        return false;
    answer->message = block_cache_take(answer->block_cache, answer->length);
    if (!answer->message)
        return false;
    memcpy(answer->message, buffer, answer->length);
    return true;
}

bool answer_fill_frame(struct answer *answer, const sheen_Frame *frame, struct encoded *encoded)
{
    answer->encoded = encoded;
    return answer_fill(answer, MESSAGE_FRAME, frame);
}

void answer_mark_last(struct answer *answer)
{
    answer->last = true;
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

/* Cuts the pieces into DATA messages. The last block gives all of them back. */
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

static void send_answer(struct answer_list *list, struct answer *answer, struct conn *conn)
{
    conn_send(conn, answer->message, answer->length);
    if (!answer->encoded)
        return;
    if (answer->request_class == CLASS_INTERACTIVE) {
        answer->encoded->unsent = &list->unsent;
        list->unsent++;
    }
    send_data(conn, answer->seq, answer->encoded);
    answer->encoded = NULL; /* the connection's now */
}

/* Whether an answer may go out when those before it, of the classes in `owed`, have not. */
static bool is_due(const struct answer_list *list, const struct answer *answer,
                   const bool owed[static N_CLASSES])
{
    if (!answer->ready)
        return false;
    if (list->is_ordered || answer->last)
        return answer == list->head;
    if (!answer->encoded)
        return true;
    bool is_clear = answer->request_class != CLASS_INTERACTIVE || list->unsent == 0;
    return is_clear && !owed[answer->request_class];
}

void answer_send_due(struct answer_list *list, struct conn *conn)
{
    bool owed[N_CLASSES] = {false}, sent = false, closes = false, is_over = false;
    struct answer *before = NULL;
    for (struct answer *answer = list->head, *next; answer && !is_over; answer = next) {
        next = answer->next;
        is_over = answer->last; /* nothing after it */
        if (is_due(list, answer, owed)) {
            closes = answer->last;
            send_answer(list, answer, conn);
            drop(list, before);
            sent = true;
        } else {
            owed[answer->request_class] = true;
            before = answer;
            is_over |= list->is_ordered; /* nothing overtakes */
        }
    }
    if (sent)
        conn_flush(conn);
    if (closes)
        conn_close_after_flush(conn);
}
