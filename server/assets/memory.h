/* The rules by which clients take from the memory budget: every upload and long message under way,
 * and every frame from its first tile until its last byte has gone to the socket, is charged to the
 * quota of the identity that asked for it, and so to the daemon's budget. Thread: the loop's. */
#ifndef SHEEN_ASSETS_MEMORY_H
#define SHEEN_ASSETS_MEMORY_H

#include "server/assets/client_quota.h"
#include "server/assets/store.h"
#include "server/base/block_cache.h"

struct memory {
    struct store *store;             /* has the budget, and evicts where room is needed */
    struct block_cache *block_cache; /* where charges lie, or NULL */
    struct client_quotas quotas;
};

/* In a private daemon all of the budget is its only client's, and quotas have no limit. */
void memory_init(struct memory *memory, struct store *store, const struct asset_limits *limits,
                 bool is_private, struct block_cache *block_cache);

/* One frame's. On the heap: it may outlive the request and its session. */
struct memory_charge;

enum memory_result {
    MEMORY_CHARGED,
    MEMORY_LATER, /* other frames have it, and will give it back */
    MEMORY_FAILED,
};

/* Charges what a frame takes. `class` is ACCOUNT_INTERACTIVE, or ACCOUNT_PATIENT, of which all
 * frames together take at most half of the budget (or one frame), and those of one peer at most a
 * quarter and one frame. In a shared daemon `bytes` is no more than the limits memory_budget and
 * peer_memory. `asker` as in store_reserve(). */
enum memory_result memory_charge_frame(struct memory *memory, struct client_quota *quota,
                                       const uint8_t asker[static OWNER_BYTES],
                                       enum account_class class, uint64_t bytes,
                                       struct memory_charge **charge, struct error *error);
/* It takes no more than this after all. */
void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes);
void memory_charge_release(void *charge); /* NULL is safe */

/* The same for what comes in: the bytes of an upload as they come, and messages on their way, as
 * ACCOUNT_INPUT. `name` is the file's; `asker` and `permanent` as in store_reserve(). */
bool memory_charge_input(struct memory *memory, struct client_quota *quota,
                         const uint8_t asker[static OWNER_BYTES], uint64_t bytes, const char *name,
                         enum error_kind permanent, struct error *error);
void memory_refund_input(struct client_quota *quota, uint64_t bytes);

#endif
