/* Who is connected over TLS and has not shown who he is: how many may be at once, from one address and in
 * all, who leaves first when there are more, and which addresses are turned away at once because they
 * come without credentials again and again (as OpenSSH's PerSourcePenalties has it).
 *
 * Plain bookkeeping over nodes embedded in their owners: no descriptor, no clock. Thread: the loop's. */
#ifndef SHEEN_NET_STRANGERS_H
#define SHEEN_NET_STRANGERS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "server/net/peer.h"

#define STRANGERS_HURRY_US 1000000u   /* to say who he is, when half of the places are taken */
#define STRANGERS_PENALTY_US 1000000u /* of one who left, or was sent away, without credentials */
#define STRANGERS_WRONG_US 5000000u   /* of one whose credentials were wrong */
#define STRANGERS_REFUSED_FROM_US 15000000u /* so much at once, and the address is turned away */
#define STRANGERS_MAX_PENALTIES 1024        /* addresses; the least guilty is forgotten */

struct strangers_limits {
    uint64_t all, of_peer; /* connections */
    uint64_t penalty_s;    /* an address is turned away for so long at most; 0: none ever is */
};

struct stranger { /* one connection */
    struct peer peer;
    uint64_t since_us;
    bool is_exempt; /* a balancer's own: no penalty, no limit of its address */
    /* Has not sent a byte yet; such ones leave first. */
    bool (*is_silent)(const struct stranger *stranger);
    void *owner;
    TAILQ_ENTRY(stranger) link;
};

struct stranger_penalty {
    uint64_t key[2];
    uint64_t until_us; /* 0: free */
    bool is_refused;   /* until then */
};

struct strangers {                            /* zeroed, then strangers_init() */
    TAILQ_HEAD(stranger_list, stranger) list; /* the oldest first */
    uint64_t n;
    struct stranger_penalty penalties[STRANGERS_MAX_PENALTIES];
};

void strangers_init(struct strangers *strangers);

/* Is the address not one that is turned away? */
bool strangers_admits(const struct strangers *strangers, const struct peer *peer, uint64_t now_us);

/* One has come; `peer`, `is_exempt`, `is_silent` and `owner` are set. Returns one who has to leave for
 * him, NULL when there is room: of his address if it has too many, else of the address that has most;
 * the oldest that is silent, else the oldest. The caller closes its connection, and calls
 * strangers_leave(). */
struct stranger *strangers_enter(struct strangers *strangers, const struct strangers_limits *limits,
                                 struct stranger *stranger, uint64_t now_us);

enum stranger_end {
    STRANGER_ADMITTED, /* is none any more; takes the penalty from his address */
    STRANGER_GONE,     /* without credentials, by himself or sent away */
    STRANGER_WRONG,    /* with wrong ones */
};
/* Returns true when his address is turned away from now on. */
bool strangers_leave(struct strangers *strangers, const struct strangers_limits *limits,
                     struct stranger *stranger, enum stranger_end end, uint64_t now_us);

/* How long a stranger may take: `handshake_us`, or less when there are many. */
uint64_t strangers_patience_us(const struct strangers *strangers,
                               const struct strangers_limits *limits, uint64_t handshake_us);

#endif
