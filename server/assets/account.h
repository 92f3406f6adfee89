/* Counts how much memory is in use, by whom and for what.
 *
 * Accounts form a tree. The root is the daemon's account. Below it are an account for each
 * connected client (client_quota.h) and one for each client whose files are stored
 * (store_shares.h), and below the latter one for each model and image. A charge to an account is
 * also added to all accounts above it, separately for each class, so that each level knows its sums
 * and can have a limit. An account only counts: the caller checks first whether there is room.
 * Plain data, no allocation.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_ACCOUNT_H
#define SHEEN_ASSETS_ACCOUNT_H

#include <stdint.h>

/* What bytes are used for. */
enum account_class {
    ACCOUNT_ASSETS,      /* stored files, and tables, texels and polygons made of them */
    ACCOUNT_INPUT,       /* uploads and long messages being received, files being read */
    ACCOUNT_INTERACTIVE, /* interactive frames, from the first tile to the last byte sent */
    ACCOUNT_PATIENT,     /* the same for stills and batches, which may wait for other frames */
    ACCOUNT_DEVICE,      /* what the device draws frames into, and keeps for later frames */
    ACCOUNT_SPARES,      /* memory of sent frames that is kept for the next ones */
};
enum { N_ACCOUNT_CLASSES = ACCOUNT_SPARES + 1 };

#define ACCOUNT_NO_LIMIT UINT64_MAX

struct account {
    struct account *parent;           /* outlives this account; NULL: this is the root */
    uint64_t limit;                   /* bytes of all classes together */
    uint64_t used[N_ACCOUNT_CLASSES]; /* bytes, including those of the accounts below */
};

void account_init(struct account *account, struct account *parent, uint64_t limit);

/* Charges bytes to this account and to all above it. The caller has checked that they fit. */
void account_charge(struct account *account, enum account_class class, uint64_t bytes);
/* Takes back bytes that were charged to this account itself, not to an account below it. */
void account_refund(struct account *account, enum account_class class, uint64_t bytes);

/* The bytes in use by all classes together. */
uint64_t account_used(const struct account *account);
/* The bytes that may still be charged within this account's own limit (not those of the accounts
 * above). */
uint64_t account_room(const struct account *account);

#endif
