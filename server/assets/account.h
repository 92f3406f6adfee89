/* How much memory is in use, by whom and for what.
 *
 * Accounts form a tree: the daemon's at the root, below it one for each client that is connected
 * (client_quota.h) and one for each client whose files are stored (store_shares.h), below those one
 * for each model and image. What is charged to an account is charged to all above it, by class, so
 * that each level knows its sums and can have a limit. An account only counts; who charges it asks
 * first whether there is room. Plain data, no allocation. Thread: the loop's. */
#ifndef SHEEN_ASSETS_ACCOUNT_H
#define SHEEN_ASSETS_ACCOUNT_H

#include <stdint.h>

/* What bytes are used for. */
enum account_class {
    ACCOUNT_ASSETS,      /* stored files, and tables, texels and polygons made of them */
    ACCOUNT_INPUT,       /* uploads and long messages under way, files being read */
    ACCOUNT_INTERACTIVE, /* interactive frames, from the first tile to the last byte sent */
    ACCOUNT_PATIENT,     /* the same of stills and batches, which may wait for others */
};
enum { N_ACCOUNT_CLASSES = ACCOUNT_PATIENT + 1 };

#define ACCOUNT_NO_LIMIT UINT64_MAX

struct account {
    struct account *parent;           /* stays as long as this one; NULL: the root */
    uint64_t limit;                   /* bytes of all classes together */
    uint64_t used[N_ACCOUNT_CLASSES]; /* bytes, with those of the accounts below */
};

void account_init(struct account *account, struct account *parent, uint64_t limit);

/* Charges bytes, here and in all accounts above. The caller knows that they fit. */
void account_charge(struct account *account, enum account_class class, uint64_t bytes);
/* Takes back bytes that were charged to this account itself, not to one below it. */
void account_refund(struct account *account, enum account_class class, uint64_t bytes);

/* The bytes in use of all classes together. */
uint64_t account_used(const struct account *account);
/* How many bytes more this account's own limit allows. */
uint64_t account_room(const struct account *account);

#endif
