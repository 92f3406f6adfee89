/* The replies that one connection owes to its client. Each request gets a place in the list when it
 * comes; the reply is sent when it is ready. Frames of one class leave in the order of their
 * requests; all other replies leave as soon as they are ready. For a peer of minor version 0 all
 * replies leave in the order of the requests.
 * Thread: the one that runs the loop (server/net/loop.h). */
#ifndef SHEEN_SESSION_REPLY_H
#define SHEEN_SESSION_REPLY_H

#include <sys/queue.h>

#include "protocol/messages/message.h"
#include "server/net/conn.h"
#include "server/output/encode.h"
#include "server/frame/scheduler.h"

struct reply; /* a reply that is owed; the list owns it until it is sent */

struct reply_list {
    TAILQ_HEAD(replies, reply) replies; /* in the order of their requests */
    unsigned n;                         /* number of replies that are owed */
    /* All replies leave in the order of the requests (minor version 0). */
    bool is_ordered;
    /* Interactive frames that the connection has not sent yet: at most 1. */
    unsigned unsent;
    struct block_cache *block_cache; /* memory of the replies; NULL: malloc() */
};

/* Starts an empty list. Nothing is allocated. */
void reply_list_init(struct reply_list *list, struct block_cache *block_cache);

/* Adds a reply for the request with number `seq`, which asks for no frame. NULL when memory is
 * short: then the connection must end. */
struct reply *reply_expect(struct reply_list *list, uint32_t seq);
/* As reply_expect() for a request that asks for a frame of this class: later frames of the class
 * wait until the reply has left, whatever it is. */
struct reply *reply_expect_frame(struct reply_list *list, uint32_t seq,
                                 enum request_class request_class);
/* True if a reply to the request with this number is still owed. */
bool reply_list_owes(const struct reply_list *list, uint32_t seq);
/* The number of the request that the reply answers. */
uint32_t reply_seq(const struct reply *reply);
/* Frees all replies without sending them. */
void reply_list_finish(struct reply_list *list);

/* Fills in a reply: encodes `body`, the struct of message `type` (message.h), and copies it. False
 * if it breaks the schema or memory is short: then the connection must end. */
bool reply_fill(struct reply *reply, uint8_t type, const void *body);
/* As reply_fill() for a FRAME message and the DATA messages behind it. Takes the ownership of
 * `encoded` in any case. */
bool reply_fill_frame(struct reply *reply, const sheen_Frame *frame, struct encoded *encoded);
/* As reply_fill(), with the DATA of `records` behind the message; NULL: none. Takes their ownership in any case.
 * Frames do not wait for such a reply, nor does it wait for them. */
bool reply_fill_records(struct reply *reply, uint8_t type, const void *body,
                        struct encoded *records);
/* Marks the reply as the last: it is sent after all others, and the connection closes after it. */
void reply_mark_last(struct reply *reply);

/* Hands all replies that may leave now to the connection. After the last one (reply_mark_last())
 * the connection is closed. */
void reply_send_due(struct reply_list *list, struct conn *conn);

#endif
