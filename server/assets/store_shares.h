/* Who holds how much of the store: each model and image counts for the client that brought it,
 * whether the client alone may use it or everybody. The store makes room by these shares, so that
 * no client pushes out what others use. Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_SHARES_H
#define SHEEN_ASSETS_STORE_SHARES_H

#include <stdint.h>
#include <sys/queue.h>

#include "server/assets/account.h"
#include "server/base/owner.h"

/* The two things that the store has a limited amount of: bytes of the memory budget, and entries.
 */
enum share_kind { SHARE_BYTES, SHARE_ENTRIES };

/* What one client holds. */
struct store_share {
    uint8_t id[OWNER_BYTES];
    struct account account; /* what the client's assets are charged with */
    uint64_t n_entries;
    unsigned references; /* one for each asset, and for each function that works with the share */
    uint64_t round;      /* the module's own, as what follows */
    LIST_ENTRY(store_share) link;
};

/* The shares of all clients that hold something. */
struct store_shares {
    struct account *daemon; /* the accounts' parent */
    uint64_t n;
    uint64_t round;
    LIST_HEAD(store_share_list, store_share) list;
};

void store_shares_init(struct store_shares *shares, struct account *daemon);

/* The client's share, with another reference. NULL when memory is short. */
struct store_share *store_share_get(struct store_shares *shares,
                                    const uint8_t id[static OWNER_BYTES]);
/* The same, but NULL when the client holds nothing. */
struct store_share *store_share_find(struct store_shares *shares,
                                     const uint8_t id[static OWNER_BYTES]);
void store_share_put(struct store_shares *shares, struct store_share *share); /* NULL is safe */

/* Bytes or entries. */
uint64_t store_share_held(const struct store_share *share, enum share_kind kind);

/* Visits each share once, the largest first: store_shares_begin(), then store_shares_next() until
 * it returns NULL. It leaves out shares that are no larger than `least` at that moment. */
void store_shares_begin(struct store_shares *shares);
struct store_share *store_shares_next(struct store_shares *shares, enum share_kind kind,
                                      uint64_t least);

#endif
