#include "server/assets/store_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const uint8_t STORE_SHARED[OWNER_BYTES] = {0};

struct store *store_create(struct pool *pool, struct pool *readers,
                           struct render_thread *render_thread, struct workers *workers,
                           const struct asset_limits *limits, bool is_private, struct error *error)
{
    struct store *store = calloc(1, sizeof *store);
    if (!store) {
        error_set(error, ERROR_SERVER, "no memory for the model store");
        return NULL;
    }
    atomic_init(&store->cancelled, false);
    slices_init(&store->slices, pool);
    store->readers = readers;
    store->render_thread = render_thread;
    store->workers = workers;
    store->limits = limits;
    store->is_private = is_private;
    account_init(&store->account, NULL, limits->memory_budget);
    store_shares_init(&store->shares, &store->account);
    TAILQ_INIT(&store->builds);
    TAILQ_INIT(&store->by_use);
    for (int i = 0; i < STORE_BUCKETS; i++)
        LIST_INIT(&store->buckets[i]);
    store->max_image_px = (uint32_t)limits->max_image_side;
    return store;
}

void store_set_daemon_bytes(struct store *store, uint64_t bytes)
{
    store->daemon_bytes = bytes;
    store->account.limit = store->limits->memory_budget - bytes;
}

void store_set_relief(struct store *store, const struct store_relief *relief)
{
    store->relief = *relief;
}

struct account *store_account(struct store *store)
{
    return &store->account;
}

void store_drop_file(struct asset *asset)
{
    if (!asset->file)
        return;
    free(asset->file);
    asset->file = NULL;
    account_refund(&asset->account, ACCOUNT_ASSETS, asset->file_bytes);
}

void store_destroy_asset(struct asset *asset)
{
    struct store *store = asset->store;
    LIST_REMOVE(asset, bucket_link);
    TAILQ_REMOVE(&store->by_use, asset, use_link);
    store->n_assets--;
    store_drop_file(asset);
    account_refund(&asset->account, ACCOUNT_ASSETS, account_used(&asset->account));
    asset->share->n_entries--;
    store_share_put(&store->shares, asset->share);
    if (asset->model)
        model_destroy(asset->model, store->render_thread);
    if (asset->image)
        light_image_destroy(asset->image, store->render_thread);
    renderer_polygons_destroy(asset->polygons);
    free(asset);
}

void store_destroy(struct store *store)
{
    if (!store)
        return;
    while (!TAILQ_EMPTY(&store->by_use))
        store_destroy_asset(TAILQ_FIRST(&store->by_use));
    free(store);
}

/* Ranks assets with the same bytes for a client; the lowest rank is best. Several clients may have
 * brought the same shared file under different names; each client should get the one with his
 * name. */
static int rank_of(const struct asset *asset, const uint8_t *asker)
{
    bool is_own = memcmp(asset->share->id, asker, OWNER_BYTES) == 0;
    if (asset->state == ASSET_FAILED)
        return is_own ? 3 : 4;
    return is_own ? 0 : asset->state == ASSET_READY ? 1 : 2;
}

/* Finds an asset of exactly this owner: the best for the asker, and among equals the oldest. */
static struct asset *find_owned(struct store *store, const uint8_t *owner, const uint8_t *asker,
                                enum asset_kind kind, const uint8_t *sha256)
{
    struct asset *asset, *best = NULL;
    LIST_FOREACH (asset, store_bucket(store, sha256), bucket_link)
        if (asset->kind == kind && memcmp(asset->sha256, sha256, MODEL_ID_BYTES) == 0 &&
            memcmp(asset->owner, owner, OWNER_BYTES) == 0 &&
            (!best || rank_of(asset, asker) <= rank_of(best, asker)))
            best = asset;
    return best;
}

struct asset *store_find(struct store *store, const uint8_t owner[static OWNER_BYTES],
                         const uint8_t asker[static OWNER_BYTES], enum asset_kind kind,
                         const uint8_t sha256[static MODEL_ID_BYTES])
{
    struct asset *own = find_owned(store, owner, asker, kind, sha256);
    if (own && own->state != ASSET_FAILED)
        return own;
    struct asset *shared = find_owned(store, STORE_SHARED, asker, kind, sha256);
    return shared ? shared : own;
}

bool store_is_known_as(const struct asset *asset, const char *name)
{
    return asset->state == ASSET_READY || strcmp(asset->name, name) == 0;
}

void store_share(struct asset *asset)
{
    const struct asset *shared =
        find_owned(asset->store, STORE_SHARED, asset->share->id, asset->kind, asset->sha256);
    if (!shared || (shared->share != asset->share && !store_is_known_as(shared, asset->name)))
        memcpy(asset->owner, STORE_SHARED, sizeof asset->owner);
}

/* Gives the asset a file, in place of the old one if any, and moves the file's charge to it. */
static void take_file(struct asset *asset, const char *name, uint8_t *file, size_t file_bytes,
                      struct account *charged)
{
    store_drop_file(asset);
    snprintf(asset->name, sizeof asset->name, "%s", name);
    asset->state = ASSET_STORED;
    asset->file = file;
    asset->file_bytes = file_bytes;
    account_refund(charged, ACCOUNT_INPUT, file_bytes);
    account_charge(&asset->account, ACCOUNT_ASSETS, file_bytes);
}

struct asset *store_add_entry(struct store *store, const uint8_t holder[static OWNER_BYTES])
{
    static const struct store_want one = {SHARE_ENTRIES, 1};
    if (!store_make_room(store, holder, &one))
        return NULL;
    struct asset *asset = calloc(1, sizeof *asset);
    if (!asset)
        return NULL;
    asset->store = store;
    asset->share = store_share_get(&store->shares, holder);
    if (!asset->share) {
        free(asset);
        return NULL;
    }
    asset->share->n_entries++;
    account_init(&asset->account, &asset->share->account, ACCOUNT_NO_LIMIT);
    LIST_INIT(&asset->waiters);
    atomic_init(&asset->is_unwanted, false);
    return asset;
}

void store_enter(struct asset *asset, enum asset_kind kind, const uint8_t *sha256,
                 const uint8_t *owner)
{
    asset->kind = kind;
    memcpy(asset->sha256, sha256, MODEL_ID_BYTES);
    memcpy(asset->owner, owner, sizeof asset->owner);
    LIST_INSERT_HEAD(store_bucket(asset->store, sha256), asset, bucket_link);
    asset->store->n_assets++;
}

bool store_add(struct store *store, const uint8_t owner[static OWNER_BYTES],
               const uint8_t holder[static OWNER_BYTES], enum asset_kind kind,
               const uint8_t sha256[static MODEL_ID_BYTES], const char *name, uint8_t *file,
               size_t file_bytes, struct account *charged, struct error *error)
{
    struct asset *asset = NULL, *known = find_owned(store, owner, holder, kind, sha256);
    bool is_own = known && memcmp(known->share->id, holder, OWNER_BYTES) == 0;
    if (is_own && known->state != ASSET_BUILDING && !store_is_known_as(known, name)) {
        take_file(known, name, file, file_bytes, charged);
        return true;
    }
    if (known && !is_own && !store_is_known_as(known, name))
        /* Another holder's asset: this client's name must not decide how the others' is read. */
        known = NULL;
    if (!known)
        asset = store_add_entry(store, holder);
    if (!asset) {
        free(file);
        account_refund(charged, ACCOUNT_INPUT, file_bytes);
        return known || error_set(error, ERROR_SERVER,
                                  "%s: no room for another model or image: try again later", name);
    }
    store_enter(asset, kind, sha256, owner);
    take_file(asset, name, file, file_bytes, charged);
    TAILQ_INSERT_HEAD(&store->by_use, asset, use_link);
    return true;
}

static void unlink_waiter(struct asset_waiter *waiter)
{
    LIST_REMOVE(waiter, link);
    waiter->asset = NULL;
}

/* Wakes the waiters one by one: what one of them does may make others stop waiting or evict
 * assets. */
void store_wake_waiters(struct asset *asset, const struct error *failure)
{
    asset->users++;
    for (struct asset_waiter *waiter; (waiter = LIST_FIRST(&asset->waiters));) {
        unlink_waiter(waiter);
        if (failure)
            asset->users--;
        waiter->ready(waiter, failure);
    }
    asset->users--;
}

static void add_waiter(struct asset *asset, struct asset_waiter *waiter)
{
    waiter->asset = asset;
    LIST_INSERT_HEAD(&asset->waiters, waiter, link);
}

/* Marks the asset as the latest used. Polygons are placed behind their model, so that they are
 * evicted before it. */
static void touch(struct asset *asset)
{
    struct store *store = asset->store;
    TAILQ_REMOVE(&store->by_use, asset, use_link);
    if (asset->of)
        TAILQ_INSERT_AFTER(&store->by_use, asset->of, asset, use_link);
    else
        TAILQ_INSERT_HEAD(&store->by_use, asset, use_link);
}

enum acquire_result store_acquire(struct asset *asset, const uint8_t asker[static OWNER_BYTES],
                                  struct asset_waiter *waiter, struct error *error)
{
    struct store *store = asset->store;
    touch(asset);
    if (asset->state == ASSET_FAILED) {
        *error = asset->failure;
        return ACQUIRE_FAILED;
    }
    asset->users++;
    if (asset->state == ASSET_READY) {
        store->n_hits++;
        return ACQUIRE_READY;
    }
    store->n_misses++;
    add_waiter(asset, waiter);
    atomic_store(&asset->is_unwanted, false);
    if (asset->kind == ASSET_POLYGONS && asset->state == ASSET_STORED &&
        !store_start_polygons(asset, error)) {
        store_stop_waiting(waiter);
        return ACQUIRE_FAILED;
    }
    if (asset->state == ASSET_STORED)
        store_queue_build(asset, asker);
    return ACQUIRE_WAIT;
}

void store_unuse(struct asset *asset)
{
    asset->users--;
}

bool store_stop_waiting(struct asset_waiter *waiter)
{
    struct asset *asset = waiter->asset;
    if (!asset)
        return false;
    unlink_waiter(waiter);
    asset->users--;
    if (LIST_EMPTY(&asset->waiters) && asset->state == ASSET_BUILDING) {
        asset->was_unwanted = true;
        atomic_store(&asset->is_unwanted, true);
    }
    return true;
}

void store_cancel_builds(struct store *store)
{
    atomic_store(&store->cancelled, true);
}

bool store_is_building(const struct store *store)
{
    return store->n_building > 0 || store->n_polygons_made > 0 || !TAILQ_EMPTY(&store->builds);
}

struct store_counts store_count(const struct store *store)
{
    const uint64_t *used = store->account.used;
    const uint64_t device = used[ACCOUNT_DEVICE], spares = used[ACCOUNT_SPARES];
    struct store_counts counts = {.used_bytes = account_used(&store->account) - device - spares,
                                  .assets_bytes = used[ACCOUNT_ASSETS],
                                  .input_bytes = used[ACCOUNT_INPUT],
                                  .interactive_bytes = used[ACCOUNT_INTERACTIVE],
                                  .patient_bytes = used[ACCOUNT_PATIENT],
                                  .device_bytes = device,
                                  .spare_bytes = spares,
                                  .daemon_bytes = store->daemon_bytes,
                                  .budget_bytes = store->limits->memory_budget,
                                  .hits = store->n_hits,
                                  .misses = store->n_misses,
                                  .evictions = store->n_evictions};
    const struct asset *asset;
    TAILQ_FOREACH (asset, &store->by_use, use_link) {
        if (asset->state != ASSET_READY)
            continue;
        counts.models += asset->kind == ASSET_MODEL;
        counts.images += asset->kind == ASSET_IMAGE;
        counts.model_bytes += asset->model ? asset->model->device_bytes : 0;
    }
    return counts;
}
