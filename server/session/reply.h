/* The replies that one connection owes. Frames of a class go out in the order of their requests,
 * everything else as soon as it is ready; to a peer of minor version 0 all goes out in order.
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_REPLY_H
#define SHEEN_SESSION_REPLY_H

#include <sys/queue.h>

#include "protocol/message.h"
#include "server/net/conn.h"
#include "server/output/encode.h"
#include "server/frame/scheduler.h"

struct reply; /* one that is owed; lives in its list until it is sent */

struct reply_list {
    TAILQ_HEAD(replies, reply) replies; /* in the order of their requests */
    unsigned n;                         /* owed */
    bool is_ordered;                    /* as minor version 0 has it */
    unsigned unsent;                    /* interactive frames handed to the connection: at most 1 */
    struct block_cache *block_cache;    /* where the replies' memory comes from, or NULL */
};

/* None is owed. `block_cache`: as in the struct. */
void reply_list_init(struct reply_list *list, struct block_cache *block_cache);

/* A request has come; `request_class` is that of its frame, CLASS_STILL for what has none. NULL
 * when memory is short: the connection cannot go on then. */
struct reply *reply_expect(struct reply_list *list, uint32_t seq, enum request_class request_class);
/* Is a request of this number unanswered? */
bool reply_list_owes(const struct reply_list *list, uint32_t seq);
/* The number of the request. */
uint32_t reply_seq(const struct reply *reply);
/* Gives up all that is owed. */
void reply_list_finish(struct reply_list *list);

/* The reply is ready: `body` is the struct of `type` (message.h), encoded at once. False when it
 * breaks the schema or memory is short: the connection cannot go on then. */
bool reply_fill(struct reply *reply, uint8_t type, const void *body);
/* As reply_fill() for a FRAME and the DATA behind it. Takes `encoded` over in any case. */
bool reply_fill_frame(struct reply *reply, const sheen_Frame *frame, struct encoded *encoded);
/* Nothing comes after this reply, and it comes after all others: the connection closes behind
 * it. */
void reply_mark_last(struct reply *reply);

/* Hands all answers that are due to the connection, and closes it behind the last. */
void reply_send_due(struct reply_list *list, struct conn *conn);

#endif
