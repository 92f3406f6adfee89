/* The memory budget as clients take from it: every upload and long message under way and every
 * frame, from its first tile until its last byte has gone to the socket, is charged to the store's
 * budget and to the peer that asked. Thread: the loop's. */
#ifndef SHEEN_ASSETS_MEMORY_H
#define SHEEN_ASSETS_MEMORY_H

#include "server/assets/client_quota.h"
#include "server/frame/scheduler.h"
#include "server/assets/store.h"
#include "server/base/block_cache.h"

struct memory {
    struct store *store;
    const struct asset_limits *limits;
    struct block_cache *block_cache; /* where charges lie, or NULL */
    struct peers peers;
    uint64_t frame_bytes;   /* of all frames */
    uint64_t patient_bytes; /* of stills and batches: at most half of the budget, or one frame; of
                             * one peer at most a quarter and one frame */
};

/* One frame's. On the heap: it may outlive the request and its session. */
struct memory_charge;

enum memory_result {
    MEMORY_CHARGED,
    MEMORY_LATER, /* other frames have it, and will give it back */
    MEMORY_FAILED,
};

/* Charges what a frame takes. In a shared daemon `bytes` is no more than
 * limits->memory_budget and peer_memory;
 * `asker` as in store_reserve(). */
enum memory_result memory_charge_frame(struct memory *memory, struct peer *peer,
                                       const uint8_t asker[static STORE_OWNER_BYTES],
                                       enum request_class request_class, uint64_t bytes,
                                       struct memory_charge **charge, struct error *error);
/* It takes no more than this after all. */
void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes);
void memory_charge_release(void *charge); /* NULL is safe */

/* The same for what comes in: the bytes of an upload as they come, and messages on their way.
 * `name` is the file's; `asker` and `permanent` as in store_reserve(). */
bool memory_charge_input(struct memory *memory, struct peer *peer,
                         const uint8_t asker[static STORE_OWNER_BYTES], uint64_t bytes,
                         const char *name, enum error_kind permanent, struct error *error);
/* They are gone, or the store's: then they stay charged to the budget. */
void memory_release_input(struct memory *memory, struct peer *peer, uint64_t bytes, bool stored);

#endif
