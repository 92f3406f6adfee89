/* Making room in the store. */
#include <inttypes.h>
#include <string.h>

#include "server/assets/store_internal.h"

static bool is_evictable(const struct asset *asset)
{
    return asset->users == 0 && asset->state != ASSET_BUILDING;
}

static uint64_t all_of(const struct store *store, enum share_kind kind)
{
    return kind == SHARE_BYTES ? store->account.limit : STORE_MAX_ASSETS;
}

static uint64_t free_of(const struct store *store, enum share_kind kind)
{
    return kind == SHARE_BYTES ? account_room(&store->account) : STORE_MAX_ASSETS - store->n_assets;
}

static bool has_room(const struct store *store, const struct store_want *want)
{
    return want->needed <= free_of(store, want->kind);
}

/* Would there be room if all assets that no request uses were evicted? */
static bool could_have_room(const struct store *store, const struct store_want *want)
{
    uint64_t room = free_of(store, want->kind);
    const struct asset *asset;
    TAILQ_FOREACH (asset, &store->by_use, use_link) {
        if (room >= want->needed)
            break;
        if (is_evictable(asset))
            room += want->kind == SHARE_BYTES ? account_used(&asset->account) : 1;
    }
    return room >= want->needed;
}

/* Evicts assets, least recently used first, of one share or of all (NULL), until there is room or
 * the share holds no more than `keep`. */
static void evict(struct store *store, const struct store_want *want,
                  const struct store_share *share, uint64_t keep)
{
    struct asset *asset = TAILQ_LAST(&store->by_use, asset_uses);
    while (asset && !has_room(store, want)) {
        struct asset *newer = TAILQ_PREV(asset, asset_uses, use_link);
        if (share && store_share_held(share, want->kind) <= keep)
            return;
        if (is_evictable(asset) && (!share || asset->share == share)) {
            store_destroy_asset(asset);
            store->n_evictions++;
        }
        asset = newer;
    }
}

/* Makes room. If the asker would hold more than an equal share, its own assets go first. Then those
 * of clients that hold more than an equal share, the largest first; then the least recently used of
 * all. Evicts nothing if that is not enough. */
bool store_make_room(struct store *store, const uint8_t *asker, const struct store_want *want)
{
    if (has_room(store, want))
        return true;
    if (!could_have_room(store, want))
        return false;
    struct store_share *own = store_share_find(&store->shares, asker), *other;
    uint64_t equal = all_of(store, want->kind) / (store->shares.n + !own);
    if (own && store_share_held(own, want->kind) + want->needed > equal)
        evict(store, want, own, 0);
    store_share_put(&store->shares, own);
    store_shares_begin(&store->shares);
    while (!has_room(store, want) &&
           (other = store_shares_next(&store->shares, want->kind, equal))) {
        other->references++; /* evict() may destroy its last asset */
        evict(store, want, other, equal);
        store_share_put(&store->shares, other);
    }
    evict(store, want, NULL, 0);
    return true;
}

/* Refuses in a private daemon, whose only client holds all memory: waiting would not help. */
static bool refuse_private(const struct store *store, uint64_t bytes, const char *what,
                           enum error_kind permanent, struct error *error)
{
    const uint64_t mib = 1 << 20, budget = store->limits->memory_budget;
    const uint64_t used = account_used(&store->account) + store->daemon_bytes;
    return error_set(error, permanent,
                     "%s needs %" PRIu64 " bytes beside %" PRIu64
                     " in use, and this command's daemon has a memory budget of %" PRIu64
                     ": give more, as --memory-budget %" PRIu64 "M, if the machine has it",
                     what, bytes, used, budget, (used + bytes) / 8 * 9 / mib + 1);
}

static void relieve(struct store *store, uint64_t bytes, bool is_last_resort)
{
    if (store->relief.relieve)
        store->relief.relieve(store->relief.owner, bytes, is_last_resort);
}

static bool make_room(struct store *store, const uint8_t *asker, uint64_t bytes)
{
    const struct store_want want = {SHARE_BYTES, bytes};
    relieve(store, bytes, false);
    if (store_make_room(store, asker, &want))
        return true;
    relieve(store, bytes, true);
    return store_make_room(store, asker, &want);
}

bool store_reserve(struct store *store, const uint8_t asker[static OWNER_BYTES],
                   struct account *account, enum account_class class, uint64_t bytes,
                   const char *what, enum error_kind permanent, struct error *error)
{
    const uint64_t budget = store->account.limit;
    if (bytes > budget && !store->is_private)
        return error_set(error, permanent,
                         "%s needs %" PRIu64 " bytes and the daemon's memory budget has %" PRIu64
                         " for it: ask its operator for more (sheend --memory-budget)",
                         what, bytes, budget);
    if (bytes <= budget && make_room(store, asker, bytes)) {
        account_charge(account, class, bytes);
        return true;
    }
    if (store->is_private)
        return refuse_private(store, bytes, what, permanent, error);
    return error_set(error, ERROR_SERVER,
                     "%s needs %" PRIu64 " bytes; of the daemon's memory budget of %" PRIu64
                     ", %" PRIu64 " are in use now: try again later",
                     what, bytes, budget, account_used(&store->account));
}
