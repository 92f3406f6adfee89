/* The queue of builds. */
#include <inttypes.h>
#include <string.h>

#include "server/assets/store_internal.h"

static void start_builds(struct store *store);

static void build_ended(struct asset *asset, const struct error *failure)
{
    if (!failure) {
        asset->state = ASSET_READY;
        store_drop_file(asset);
    } else {
        /* A failure that the file causes is permanent; another may pass. */
        bool bad_file = failure->kind == ERROR_MODEL || failure->kind == ERROR_IMAGE;
        account_refund(&asset->account, ACCOUNT_ASSETS,
                       account_used(&asset->account) - asset->file_bytes);
        asset->state = bad_file ? ASSET_FAILED : ASSET_STORED;
        asset->failure = *failure;
        if (bad_file)
            store_drop_file(asset);
    }
    store_wake_waiters(asset, failure);
}

static void build_finished(void *owner, void *result, const struct error *failure)
{
    struct asset *asset = owner;
    struct store *store = asset->store;
    if (asset->kind == ASSET_MODEL) {
        asset->model = result;
        asset->unreported_us = result ? asset->model->build_us : 0;
    } else {
        asset->image = result;
    }
    unsigned at = 0;
    while (store->building[at] != asset)
        at++;
    store->building[at] = store->building[--store->n_building];
    account_refund(&asset->account, ACCOUNT_INPUT, asset->work_bytes);
    asset->work_bytes = 0;
    asset->users++; /* the waiters that wake up must not evict it */
    build_ended(asset, failure);
    asset->users--;
    start_builds(store);
}

static bool build_reserve(void *owner, size_t bytes, struct error *error)
{
    struct asset *asset = owner;
    enum error_kind permanent = asset->kind == ASSET_MODEL ? ERROR_MODEL : ERROR_IMAGE;
    return store_reserve(asset->store, asset->share->id, &asset->account, ACCOUNT_ASSETS, bytes,
                         asset->name, permanent, error);
}

/* In a private daemon the size is computed to the end, so that the client learns how much to
 * give. */
static bool build_may_need(void *owner, size_t bytes, struct error *error)
{
    const struct asset *asset = owner;
    const struct store *store = asset->store;
    return bytes <= store->account.limit || store->is_private ||
           error_set(error, ERROR_MODEL,
                     "it needs at least %zu bytes and the daemon's memory budget has %" PRIu64
                     " for it: ask its operator for more (sheend --memory-budget)",
                     bytes, store->account.limit);
}

static bool build_reserve_work(void *owner, size_t bytes, struct error *error)
{
    struct asset *asset = owner;
    enum error_kind permanent = asset->kind == ASSET_MODEL ? ERROR_MODEL : ERROR_IMAGE;
    account_refund(&asset->account, ACCOUNT_INPUT, asset->work_bytes);
    asset->work_bytes = 0;
    if (bytes > 0 && !store_reserve(asset->store, asset->share->id, &asset->account, ACCOUNT_INPUT,
                                    bytes, asset->name, permanent, error))
        return false;
    asset->work_bytes = bytes;
    return true;
}

/* Charges what a build takes beside its file until it knows more: for a model the cage, its topology and the
 * plan of the tables; for an image the file's copy for the worker. In a private daemon a model's is charged
 * in any case, so that the need of the tables, which is told to the client, comes on top. */
static bool reserve_work(struct asset *asset, struct error *error)
{
    enum { WORK_PER_FILE_BYTE = 12 };
    const uint64_t bytes = (uint64_t)asset->file_bytes * WORK_PER_FILE_BYTE;
    struct error why;
    if (asset->kind == ASSET_IMAGE)
        return build_reserve_work(asset, asset->file_bytes, error);
    if (asset->store->is_private) {
        account_charge(&asset->account, ACCOUNT_INPUT, bytes);
        asset->work_bytes = bytes;
        return true;
    }
    if (!build_may_need(asset, bytes, &why))
        return error_set(error, ERROR_MODEL, "%s: %s", asset->name, why.text);
    return build_reserve_work(asset, bytes, error);
}

/* Has the client that asked for this build another one running? */
static bool is_served(const struct store *store, const struct asset *asset)
{
    for (unsigned i = 0; i < store->n_building; i++)
        if (memcmp(store->building[i]->asker, asset->asker, sizeof asset->asker) == 0)
            return true;
    return false;
}

/* Takes the next build out of the queue, or NULL if none may start. The first build whose client
 * has none running starts at once: a client with a hundred slow models must not delay a client with
 * one. A second build of one client starts only while no more than STORE_BUILDS_OF_ONE run. */
static struct asset *take_next(struct store *store)
{
    struct asset *asset;
    if (store->n_building == STORE_MAX_BUILDS)
        return NULL;
    TAILQ_FOREACH (asset, &store->builds, build_link)
        if (!is_served(store, asset))
            break;
    if (!asset && store->n_building < STORE_BUILDS_OF_ONE)
        asset = TAILQ_FIRST(&store->builds);
    if (asset)
        TAILQ_REMOVE(&store->builds, asset, build_link);
    return asset;
}

static void start_builds(struct store *store)
{
    for (struct asset *asset; (asset = take_next(store));) {
        const struct build_order order = {
            .slices = &store->slices,
            .readers = store->readers,
            .render_thread = store->render_thread,
            .workers = store->workers,
            .file = asset->file,
            .file_bytes = asset->file_bytes,
            .name = asset->name,
            .progress = &asset->progress,
            .max_image_px = store->max_image_px,
            .tables_cpu_us = store->limits->tables_cpu_s * 1000000,
            .cancelled = &store->cancelled,
            .may_need = build_may_need,
            .reserve_work = build_reserve_work,
            .reserve = build_reserve,
            .finished = build_finished,
            .owner = asset,
        };
        struct error error = {0};
        store->building[store->n_building++] = asset;
        if (!reserve_work(asset, &error) ||
            !(asset->kind == ASSET_MODEL ? model_build_start(&order, &error)
                                         : light_image_build_start(&order, &error)))
            build_finished(asset, NULL, &error);
    }
}

void store_queue_build(struct asset *asset, const uint8_t asker[static OWNER_BYTES])
{
    struct store *store = asset->store;
    memcpy(asset->asker, asker, sizeof asset->asker);
    asset->state = ASSET_BUILDING;
    asset->progress.stage = "waiting";
    asset->progress.total = 0;
    atomic_store(&asset->progress.done, 0);
    TAILQ_INSERT_TAIL(&store->builds, asset, build_link);
    start_builds(store);
}

struct slices *store_slices(struct store *store)
{
    return &store->slices;
}
