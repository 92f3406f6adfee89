/* The answers that one connection owes, sent in the order of its requests, whatever order they
 * become ready in. Thread: the loop's. */
#ifndef SHEEN_SERVICE_ANSWER_H
#define SHEEN_SERVICE_ANSWER_H

#include "protocol/message.h"
#include "server/service/conn.h"
#include "server/service/encode.h"

struct answer; /* one that is owed; lives in its list until it is sent */

struct answer_list {
    struct answer *head, *tail;
    unsigned n; /* owed */
};

/* A request has come; its answer will follow those of the requests before. NULL when memory is
 * short: the connection cannot go on then. */
struct answer *answer_expect(struct answer_list *list, uint32_t seq);
/* The number of the request. */
uint32_t answer_seq(const struct answer *answer);
/* Gives up all that is owed. */
void answer_list_finish(struct answer_list *list);

/* The answer is ready: `body` is the struct of `type` (message.h), encoded at once. False when it
 * breaks the schema or memory is short: the connection cannot go on then. */
bool answer_fill(struct answer *answer, uint8_t type, const void *body);
/* As answer_fill() for a FRAME and the DATA behind it. Takes `encoded` over in any case. */
bool answer_fill_frame(struct answer *answer, const sheen_Frame *frame, struct encoded *encoded);
/* Nothing comes after this answer: the connection closes behind it. */
void answer_mark_last(struct answer *answer);

/* Hands all answers that are due to the connection, and closes it behind the last. */
void answer_send_due(struct answer_list *list, struct conn *conn);

#endif
