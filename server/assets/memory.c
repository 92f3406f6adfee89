#include "server/assets/memory.h"

#include <inttypes.h>

struct memory_charge {
    struct block_cache *block_cache;
    struct client_quota *quota;
    enum account_class class;
    uint64_t bytes;
};

void memory_init(struct memory *memory, struct store *store, const struct asset_limits *limits,
                 bool is_private, struct block_cache *block_cache)
{
    memory->store = store;
    memory->block_cache = block_cache;
    client_quotas_init(&memory->quotas, store_account(store),
                       is_private ? ACCOUNT_NO_LIMIT : limits->peer_memory);
}

static bool refuse_peer(const struct client_quota *quota, const char *what, uint64_t bytes,
                        struct error *error)
{
    return error_set(error, ERROR_SERVER,
                     "%s needs %" PRIu64 " bytes; of the %" PRIu64 " that uploads and frames of %s "
                     "may take (--peer-memory), %" PRIu64 " are in use now: try again later",
                     what, bytes, quota->account.limit, quota->name, account_used(&quota->account));
}

/* Stills and batches must leave room for interactive frames, and those of one identity must leave
 * room for others: a client may read its frames as slowly as stall-timeout allows. */
static bool fits_patient(const struct memory *memory, const struct client_quota *quota,
                         uint64_t bytes)
{
    const struct account *daemon = store_account(memory->store);
    uint64_t most = daemon->limit / 2, used = daemon->used[ACCOUNT_PATIENT];
    return used == 0 || (used + bytes <= most && quota->account.used[ACCOUNT_PATIENT] <= most / 2);
}

static bool take(struct memory *memory, struct client_quota *quota, const uint8_t *asker,
                 enum account_class class, uint64_t bytes, struct error *error)
{
    if (class == ACCOUNT_PATIENT && !fits_patient(memory, quota, bytes))
        return false; /* other patient frames use the memory: try later */
    if (bytes > account_room(&quota->account))
        return refuse_peer(quota, "a frame", bytes, error);
    return store_reserve(memory->store, asker, &quota->account, class, bytes, "a frame",
                         ERROR_REQUEST, error);
}

enum memory_result memory_charge_frame(struct memory *memory, struct client_quota *quota,
                                       const uint8_t asker[static OWNER_BYTES],
                                       enum account_class class, uint64_t bytes,
                                       struct memory_charge **charge, struct error *error)
{
    const uint64_t *used = store_account(memory->store)->used;
    struct memory_charge *made = block_cache_take(memory->block_cache, sizeof *made);
    if (!made) {
        error_set(error, ERROR_SERVER, "no memory for a frame: try again later");
        return MEMORY_FAILED;
    }
    if (!take(memory, quota, asker, class, bytes, error)) {
        block_cache_give(memory->block_cache, made);
        return used[ACCOUNT_INTERACTIVE] + used[ACCOUNT_PATIENT] > 0 ? MEMORY_LATER : MEMORY_FAILED;
    }
    *made =
        (struct memory_charge){memory->block_cache, client_quota_reference(quota), class, bytes};
    *charge = made;
    return MEMORY_CHARGED;
}

void memory_charge_shrink(struct memory_charge *charge, uint64_t bytes)
{
    if (bytes >= charge->bytes)
        return;
    account_refund(&charge->quota->account, charge->class, charge->bytes - bytes);
    charge->bytes = bytes;
}

void memory_charge_release(void *owner)
{
    struct memory_charge *charge = owner;
    if (!charge)
        return;
    memory_charge_shrink(charge, 0);
    client_quota_put(charge->quota);
    block_cache_give(charge->block_cache, charge);
}

bool memory_charge_input(struct memory *memory, struct client_quota *quota,
                         const uint8_t asker[static OWNER_BYTES], uint64_t bytes, const char *name,
                         enum error_kind permanent, struct error *error)
{
    if (bytes > account_room(&quota->account))
        return refuse_peer(quota, name, bytes, error);
    return store_reserve(memory->store, asker, &quota->account, ACCOUNT_INPUT, bytes, name,
                         permanent, error);
}

void memory_refund_input(struct client_quota *quota, uint64_t bytes)
{
    account_refund(&quota->account, ACCOUNT_INPUT, bytes);
}
