/* Strangers: TLS connections whose client has not identified itself yet. This module limits how
 * many there are, in all and from one address; chooses which one leaves when there are too many;
 * and refuses addresses that connect again and again without credentials (compare OpenSSH's
 * PerSourcePenalties).
 *
 * Plain data, embedded in the structs of its users: no file descriptor, no clock.
 * Thread: the loop's. */
#ifndef SHEEN_NET_STRANGERS_H
#define SHEEN_NET_STRANGERS_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/queue.h>

#include "server/net/peer.h"

/* Time to identify itself when half of the places are taken. */
#define STRANGERS_HURRY_US 1000000u
/* Penalty for leaving, or being closed, without credentials. */
#define STRANGERS_PENALTY_US 1000000u
#define STRANGERS_WRONG_US 5000000u         /* penalty for wrong credentials */
#define STRANGERS_REFUSED_FROM_US 15000000u /* an address with this much penalty is refused */
/* Addresses kept; the one whose penalty ends first is forgotten. */
#define STRANGERS_MAX_PENALTIES 1024

struct strangers_limits {
    uint64_t all, of_peer; /* connections in all; connections of one address */
    /* Longest time that an address is refused, in seconds; 0: none is refused. */
    uint64_t penalty_s;
};

struct stranger { /* one connection */
    struct peer peer;
    uint64_t since_us;
    bool is_exempt; /* the balancer's own connection: no penalty and no limit of its address */
    /* True while it has not sent a byte; silent strangers leave first. */
    bool (*is_silent)(const struct stranger *stranger);
    void *owner;
    /* private to strangers.c: */
    uint64_t number;              /* in the order of their coming */
    struct stranger *next_sorted; /* while they are sorted by address */
    TAILQ_ENTRY(stranger) link;
};

struct stranger_penalty {
    uint64_t key[2];
    uint64_t until_us; /* 0: unused */
    bool is_refused;   /* refused until until_us */
};

struct strangers {                            /* zero it, then call strangers_init() */
    TAILQ_HEAD(stranger_list, stranger) list; /* oldest first */
    uint64_t n, last_number;
    struct stranger_penalty penalties[STRANGERS_MAX_PENALTIES];
};

void strangers_init(struct strangers *strangers);

/* False if the address is refused now. */
bool strangers_admits(const struct strangers *strangers, const struct peer *peer, uint64_t now_us);

/* Adds a stranger; `peer`, `is_exempt`, `is_silent` and `owner` are set. Returns NULL if there is
 * room, else a stranger that must leave: one of the same address if that has too many, else one of
 * the address that has most; the oldest silent one, else the oldest. The caller closes its
 * connection and calls strangers_leave() for it. */
struct stranger *strangers_enter(struct strangers *strangers, const struct strangers_limits *limits,
                                 struct stranger *stranger, uint64_t now_us);

enum stranger_end {
    STRANGER_ADMITTED, /* it has identified itself; removes the penalty of its address */
    STRANGER_GONE,     /* it left, or was closed, without credentials */
    STRANGER_WRONG,    /* it had wrong credentials */
};
/* Removes a stranger. Returns true if its address is refused from now on. */
bool strangers_leave(struct strangers *strangers, const struct strangers_limits *limits,
                     struct stranger *stranger, enum stranger_end end, uint64_t now_us);

/* How long a stranger may take to identify itself: `handshake_us`, or less when there are many. */
uint64_t strangers_patience_us(const struct strangers *strangers,
                               const struct strangers_limits *limits, uint64_t handshake_us);

#endif
