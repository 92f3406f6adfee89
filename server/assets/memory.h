/* The rules by which clients use the memory budget. Uploads, long messages being received, and
 * frames (from the first tile until the last byte is handed to the socket) are charged to the quota
 * of the identity that asked for them, and thereby to the daemon's budget.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_MEMORY_H
#define SHEEN_ASSETS_MEMORY_H

#include "server/assets/client_quota.h"
#include "server/assets/store.h"
#include "server/base/block_cache.h"

struct memory {
    struct store *store; /* holds the budget, and evicts assets to make room */
    struct render_thread *render_thread;
    struct block_cache *block_cache; /* memory of charges; NULL: malloc() */
    struct client_quotas quotas;
    /* Charged to the store's account for what nobody in particular uses: what the device holds for
     * frames, its driver's programs, and spare blocks. */
    uint64_t held_bytes, programs_bytes, spare_bytes;
    struct task drop;          /* the device frees what it holds */
    struct renderer_held left; /* after that */
    bool is_dropping;
};

/* In a private daemon the only client may use the whole budget, so quotas have no limit. */
void memory_init(struct memory *memory, struct store *store, const struct asset_limits *limits,
                 bool is_private, struct render_thread *render_thread,
                 struct block_cache *block_cache);

/* Charges what the device holds now, after each step of a frame. When nothing else makes room, the
 * device has to give it up. */
void memory_set_held(struct memory *memory, const struct renderer_held *held);
/* Brings the account of spare blocks up to date. */
void memory_count(struct memory *memory);

/* The charge of one frame. It may outlive the request and its session. */
struct memory_charge;

enum memory_result {
    MEMORY_CHARGED,
    MEMORY_LATER, /* other frames use the memory now and will free it */
    MEMORY_FAILED,
};

/* What a frame takes, bytes: its planes and their encoding; and on the device, to be drawn into. Or what a
 * computation and its answer take. */
struct memory_frame {
    uint64_t bytes, device_bytes;
    const char *what; /* for errors, such as "a frame" */
};

/* Charges the memory of a frame. `class` is ACCOUNT_INTERACTIVE or ACCOUNT_PATIENT. All patient
 * frames together may use half of the budget (or one frame), those of one identity a quarter and
 * one frame. In a shared daemon the caller has checked them against the limits memory_budget and
 * peer_memory. `asker` is as in store_reserve(). Sets *charge if charged, *error if failed. */
enum memory_result memory_charge_frame(struct memory *memory, struct client_quota *quota,
                                       const uint8_t asker[static OWNER_BYTES],
                                       enum account_class class, const struct memory_frame *frame,
                                       struct memory_charge **charge, struct error *error);
/* The device holds what it needed for the frame, or needs it no more: from now on it counts as what
 * the device holds (memory_set_held()). */
void memory_charge_drawn(struct memory_charge *charge);
/* Reduces a charge to `bytes`. */
void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes);
void memory_charge_release(void *charge); /* NULL is safe */

/* Charges bytes of an upload, or of a long message, as ACCOUNT_INPUT. `name` is the file's name for
 * the error; `asker` and `permanent` are as in store_reserve(). False with *error if there is no
 * room. */
bool memory_charge_input(struct memory *memory, struct client_quota *quota,
                         const uint8_t asker[static OWNER_BYTES], uint64_t bytes, const char *name,
                         enum error_kind permanent, struct error *error);
void memory_refund_input(struct client_quota *quota, uint64_t bytes);

#endif
