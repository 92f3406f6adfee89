/* How much of the store each client holds. Each model and image counts for the client that brought
 * it, even if everybody may use it. By these shares the store makes room, so that no client evicts
 * what others use.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_SHARES_H
#define SHEEN_ASSETS_STORE_SHARES_H

#include <stdint.h>
#include <sys/queue.h>

#include "server/assets/account.h"
#include "server/base/owner.h"

/* What the store has a limited amount of: bytes of the memory budget, and entries. */
enum share_kind { SHARE_BYTES, SHARE_ENTRIES };

/* What one client holds. */
struct store_share {
    uint8_t id[OWNER_BYTES];
    struct account account; /* parent of the accounts of the client's assets */
    uint64_t n_entries;
    unsigned references; /* one for each asset, and for each caller that holds the share */
    uint64_t round;      /* private to store_shares.c, like what follows */
    LIST_ENTRY(store_share) link;
};

/* The shares of all clients that hold something. */
struct store_shares {
    struct account *daemon; /* parent of the shares' accounts */
    uint64_t n;
    uint64_t round;
    LIST_HEAD(store_share_list, store_share) list;
};

void store_shares_init(struct store_shares *shares, struct account *daemon);

/* The client's share, made if needed; adds a reference. NULL when memory is short. */
struct store_share *store_share_get(struct store_shares *shares,
                                    const uint8_t id[static OWNER_BYTES]);
/* As store_share_get(), but NULL if the client holds nothing. */
struct store_share *store_share_find(struct store_shares *shares,
                                     const uint8_t id[static OWNER_BYTES]);
void store_share_put(struct store_shares *shares, struct store_share *share); /* NULL is safe */

/* How much a share holds: bytes or entries, by `kind`. */
uint64_t store_share_held(const struct store_share *share, enum share_kind kind);

/* Visits shares, the largest first: call store_shares_begin(), then store_shares_next() until it
 * returns NULL. Shares that hold no more than `least` at that moment are left out. */
void store_shares_begin(struct store_shares *shares);
struct store_share *store_shares_next(struct store_shares *shares, enum share_kind kind,
                                      uint64_t least);

#endif
