/* The answers that one connection owes. Frames of a class go out in the order of their requests,
 * everything else as soon as it is ready; to a peer of minor version 0 all goes out in order.
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_REPLY_H
#define SHEEN_SESSION_REPLY_H

#include "protocol/message.h"
#include "server/net/conn.h"
#include "server/output/encode.h"
#include "server/frame/scheduler.h"

struct answer; /* one that is owed; lives in its list until it is sent */

struct answer_list {
    struct answer *head, *tail;      /* in the order of their requests */
    unsigned n;                      /* owed */
    bool is_ordered;                 /* as minor version 0 has it */
    unsigned unsent;                 /* interactive frames handed to the connection: at most 1 */
    struct block_cache *block_cache; /* where the answers' memory comes from, or NULL */
};

/* A request has come; `request_class` is that of its frame, CLASS_STILL for what has none. NULL
 * when memory is short: the connection cannot go on then. */
struct answer *answer_expect(struct answer_list *list, uint32_t seq,
                             enum request_class request_class);
/* The number of the request. */
uint32_t answer_seq(const struct answer *answer);
/* Gives up all that is owed. */
void answer_list_finish(struct answer_list *list);

/* The answer is ready: `body` is the struct of `type` (message.h), encoded at once. False when it
 * breaks the schema or memory is short: the connection cannot go on then. */
bool answer_fill(struct answer *answer, uint8_t type, const void *body);
/* As answer_fill() for a FRAME and the DATA behind it. Takes `encoded` over in any case. */
bool answer_fill_frame(struct answer *answer, const sheen_Frame *frame, struct encoded *encoded);
/* Nothing comes after this answer, and it comes after all others: the connection closes behind
 * it. */
void answer_mark_last(struct answer *answer);

/* Hands all answers that are due to the connection, and closes it behind the last. */
void answer_send_due(struct answer_list *list, struct conn *conn);

#endif
