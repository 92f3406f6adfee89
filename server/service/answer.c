#include "server/service/answer.h"

#include <stdlib.h>
#include <string.h>

struct answer {
    struct answer *next;
    uint32_t seq;
    bool ready, last;
    uint8_t *message; /* header and body */
    size_t length;
    struct encoded *encoded; /* of a frame, or NULL */
};

struct answer *answer_expect(struct answer_list *list, uint32_t seq)
{
    struct answer *answer = calloc(1, sizeof *answer);
    if (!answer)
        return NULL;
    answer->seq = seq;
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

static void drop_head(struct answer_list *list)
{
    struct answer *answer = list->head;
    list->head = answer->next;
    if (!list->head)
        list->tail = NULL;
    list->n--;
    encoded_destroy(answer->encoded);
    free(answer->message);
    free(answer);
}

void answer_list_finish(struct answer_list *list)
{
    while (list->head)
        drop_head(list);
}

bool answer_fill(struct answer *answer, uint8_t type, const void *body)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    answer->ready = true;
    if (!message_encode(type, answer->seq, body, buffer, sizeof buffer, &answer->length))
        return false;
    answer->message = malloc(answer->length);
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

void answer_send_due(struct answer_list *list, struct conn *conn)
{
    if (!list->head || !list->head->ready)
        return;
    bool last = false;
    while (list->head && list->head->ready && !last) {
        struct answer *answer = list->head;
        last = answer->last;
        conn_send(conn, answer->message, answer->length);
        if (answer->encoded)
            send_data(conn, answer->seq, answer->encoded);
        answer->encoded = NULL; /* the connection's now */
        drop_head(list);
    }
    conn_flush(conn);
    if (last)
        conn_close_after_flush(conn);
}
