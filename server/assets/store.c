#include "server/assets/store.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define N_BUCKETS 1024

LIST_HEAD(bucket, asset);

struct store {
    struct slices slices; /* shares the pool among builds */
    struct pool *readers;
    struct render_thread *render_thread;
    struct workers *workers;
    const struct asset_limits *limits;
    bool is_private;        /* the daemon is private */
    struct account account; /* root of all accounts */
    uint32_t max_image_px;
    size_t n_assets;
    struct store_shares shares;
    uint64_t n_hits, n_misses, n_evictions;
    unsigned n_building;
    unsigned n_polygons_made; /* builds of polygons that run now */
    const struct asset *building[STORE_MAX_BUILDS];
    atomic_bool cancelled;
    TAILQ_HEAD(asset_builds, asset) builds; /* builds that wait for their turn */
    TAILQ_HEAD(asset_uses, asset) by_use;   /* latest use first */
    struct bucket buckets[N_BUCKETS];
};

const uint8_t STORE_SHARED[OWNER_BYTES] = {0};

/* The bucket of an asset, by the first bytes of its SHA-256. */
static struct bucket *bucket_of(struct store *store, const uint8_t *sha256)
{
    return &store->buckets[(sha256[0] | (size_t)sha256[1] << 8) % N_BUCKETS];
}

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
    for (int i = 0; i < N_BUCKETS; i++)
        LIST_INIT(&store->buckets[i]);
    store->max_image_px = (uint32_t)limits->max_image_side;
    return store;
}

struct account *store_account(struct store *store)
{
    return &store->account;
}

static void drop_file(struct asset *asset)
{
    if (!asset->file)
        return;
    free(asset->file);
    asset->file = NULL;
    account_refund(&asset->account, ACCOUNT_ASSETS, asset->file_bytes);
}

static void asset_destroy(struct asset *asset)
{
    struct store *store = asset->store;
    LIST_REMOVE(asset, bucket_link);
    TAILQ_REMOVE(&store->by_use, asset, use_link);
    store->n_assets--;
    drop_file(asset);
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
        asset_destroy(TAILQ_FIRST(&store->by_use));
    free(store);
}

static bool is_evictable(const struct asset *asset)
{
    return asset->users == 0 && asset->state != ASSET_BUILDING;
}

/* --- making room */

/* Room that is needed: `needed` bytes, or entries. */
struct want {
    enum share_kind kind;
    uint64_t needed;
};

static uint64_t all_of(const struct store *store, enum share_kind kind)
{
    return kind == SHARE_BYTES ? store->account.limit : STORE_MAX_ASSETS;
}

static uint64_t free_of(const struct store *store, enum share_kind kind)
{
    return kind == SHARE_BYTES ? account_room(&store->account) : STORE_MAX_ASSETS - store->n_assets;
}

static bool has_room(const struct store *store, const struct want *want)
{
    return want->needed <= free_of(store, want->kind);
}

/* Would there be room if all assets that no request uses were evicted? */
static bool could_have_room(const struct store *store, const struct want *want)
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
static void evict(struct store *store, const struct want *want, const struct store_share *share,
                  uint64_t keep)
{
    struct asset *asset = TAILQ_LAST(&store->by_use, asset_uses);
    while (asset && !has_room(store, want)) {
        struct asset *newer = TAILQ_PREV(asset, asset_uses, use_link);
        if (share && store_share_held(share, want->kind) <= keep)
            return;
        if (is_evictable(asset) && (!share || asset->share == share)) {
            asset_destroy(asset);
            store->n_evictions++;
        }
        asset = newer;
    }
}

/* Makes room. If the asker would hold more than an equal share, its own assets go first. Then those
 * of clients that hold more than an equal share, the largest first; then the least recently used of
 * all. Evicts nothing if that is not enough. */
static bool make_room(struct store *store, const uint8_t *asker, const struct want *want)
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
    LIST_FOREACH (asset, bucket_of(store, sha256), bucket_link)
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

/* Refuses in a private daemon, whose only client holds all memory: waiting would not help. */
static bool refuse_private(const struct store *store, uint64_t bytes, const char *what,
                           enum error_kind permanent, struct error *error)
{
    const uint64_t mib = 1 << 20, used = account_used(&store->account);
    return error_set(error, permanent,
                     "%s needs %" PRIu64 " bytes beside %" PRIu64
                     " in use, and this command's daemon has a memory budget of %" PRIu64
                     ": give more, as --memory-budget %" PRIu64 "M, if the machine has it",
                     what, bytes, used, store->account.limit, (used + bytes) / 8 * 9 / mib + 1);
}

bool store_reserve(struct store *store, const uint8_t asker[static OWNER_BYTES],
                   struct account *account, enum account_class class, uint64_t bytes,
                   const char *what, enum error_kind permanent, struct error *error)
{
    const struct want want = {SHARE_BYTES, bytes};
    const uint64_t budget = store->account.limit;
    if (bytes > budget && !store->is_private)
        return error_set(error, permanent,
                         "%s needs %" PRIu64 " bytes and the daemon's memory budget is %" PRIu64
                         ": ask its operator for more (sheend --memory-budget)",
                         what, bytes, budget);
    if (bytes <= budget && make_room(store, asker, &want)) {
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

/* Gives the asset a file, in place of the old one if any, and moves the file's charge to it. */
static void take_file(struct asset *asset, const char *name, uint8_t *file, size_t file_bytes,
                      struct account *charged)
{
    drop_file(asset);
    snprintf(asset->name, sizeof asset->name, "%s", name);
    asset->state = ASSET_STORED;
    asset->file = file;
    asset->file_bytes = file_bytes;
    account_refund(charged, ACCOUNT_INPUT, file_bytes);
    account_charge(&asset->account, ACCOUNT_ASSETS, file_bytes);
}

/* Makes an asset without a file. NULL when there is no room for another or memory is short. */
static struct asset *add_entry(struct store *store, const uint8_t *holder)
{
    static const struct want one = {SHARE_ENTRIES, 1};
    if (!make_room(store, holder, &one))
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

/* Enters the asset into the store, except into the list by use. */
static void enter(struct asset *asset, enum asset_kind kind, const uint8_t *sha256,
                  const uint8_t *owner)
{
    asset->kind = kind;
    memcpy(asset->sha256, sha256, MODEL_ID_BYTES);
    memcpy(asset->owner, owner, sizeof asset->owner);
    LIST_INSERT_HEAD(bucket_of(asset->store, sha256), asset, bucket_link);
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
        asset = add_entry(store, holder);
    if (!asset) {
        free(file);
        account_refund(charged, ACCOUNT_INPUT, file_bytes);
        return known || error_set(error, ERROR_SERVER,
                                  "%s: no room for another model or image: try again later", name);
    }
    enter(asset, kind, sha256, owner);
    take_file(asset, name, file, file_bytes, charged);
    TAILQ_INSERT_HEAD(&store->by_use, asset, use_link);
    return true;
}

/* --- building */

static void start_builds(struct store *store);

static void unlink_waiter(struct asset_waiter *waiter)
{
    LIST_REMOVE(waiter, link);
    waiter->asset = NULL;
}

/* Wakes the waiters one by one: what one of them does may make others stop waiting or evict
 * assets. */
static void wake_waiters(struct asset *asset, const struct error *failure)
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

static void build_ended(struct asset *asset, const struct error *failure)
{
    if (!failure) {
        asset->state = ASSET_READY;
        drop_file(asset);
    } else {
        /* A failure that the file causes is permanent; another may pass. */
        bool bad_file = failure->kind == ERROR_MODEL || failure->kind == ERROR_IMAGE;
        account_refund(&asset->account, ACCOUNT_ASSETS,
                       account_used(&asset->account) - asset->file_bytes);
        asset->state = bad_file ? ASSET_FAILED : ASSET_STORED;
        asset->failure = *failure;
        if (bad_file)
            drop_file(asset);
    }
    wake_waiters(asset, failure);
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
                     "it needs at least %zu bytes and the daemon's memory budget is %" PRIu64
                     ": ask its operator for more (sheend --memory-budget)",
                     bytes, store->account.limit);
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
            .reserve = build_reserve,
            .finished = build_finished,
            .owner = asset,
        };
        struct error error = {0};
        store->building[store->n_building++] = asset;
        if (!(asset->kind == ASSET_MODEL ? model_build_start(&order, &error)
                                         : light_image_build_start(&order, &error)))
            build_finished(asset, NULL, &error);
    }
}

static void queue_build(struct asset *asset, const uint8_t asker[static OWNER_BYTES])
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

/* --- polygons */

/* Charges the memory of polygons, on the device or in main memory, to an account of the model's
 * holder. */
static bool reserve_polygons(struct asset *charged, struct asset *model, uint32_t level,
                             struct error *error)
{
    size_t bytes = renderer_polygon_bytes(&model->model->tables, level);
    return store_reserve(model->store, model->share->id, &charged->account, ACCOUNT_ASSETS, bytes,
                         model->name, ERROR_REQUEST, error);
}

static bool start_polygons(struct asset *asset, struct error *error);

static void polygons_finished(void *owner, struct renderer_polygons *polygons,
                              const struct error *failure)
{
    struct asset *asset = owner, *model = asset->of;
    struct error again = {0};
    asset->store->n_polygons_made--;
    asset->polygons = polygons;
    asset->state = polygons ? ASSET_READY : ASSET_STORED;
    if (!polygons)
        account_refund(&asset->account, ACCOUNT_ASSETS, account_used(&asset->account));
    /* The build was given up, but a request has asked for the polygons since. */
    if (!polygons && asset->was_unwanted && !LIST_EMPTY(&asset->waiters)) {
        if (start_polygons(asset, &again)) {
            model->users--;
            return;
        }
        failure = &again;
    }
    wake_waiters(asset, failure);
    model->users--;
}

/* The model counts as in use while its polygons are made. */
static bool start_polygons(struct asset *asset, struct error *error)
{
    struct store *store = asset->store;
    const struct polygons_order order = {
        .pool = store->slices.pool,
        .tables = &asset->of->model->tables,
        .level = asset->level,
        .cancelled = &store->cancelled,
        .is_unwanted = &asset->is_unwanted,
        .finished = polygons_finished,
        .owner = asset,
    };
    if (!reserve_polygons(asset, asset->of, asset->level, error))
        return false;
    if (!polygons_build_start(&order, error)) {
        account_refund(&asset->account, ACCOUNT_ASSETS, account_used(&asset->account));
        return false;
    }
    asset->was_unwanted = false;
    asset->state = ASSET_BUILDING;
    asset->of->users++;
    store->n_polygons_made++;
    return true;
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
        !start_polygons(asset, error)) {
        store_stop_waiting(waiter);
        return ACQUIRE_FAILED;
    }
    if (asset->state == ASSET_STORED)
        queue_build(asset, asker);
    return ACQUIRE_WAIT;
}

struct asset *store_find_polygons(struct asset *model, uint32_t level, struct error *error)
{
    struct store *store = model->store;
    struct asset *asset;
    if (!(model->polygon_levels & 1u << level) && !reserve_polygons(model, model, level, error))
        return NULL;
    model->polygon_levels |= 1u << level;
    LIST_FOREACH (asset, bucket_of(store, model->sha256), bucket_link)
        if (asset->of == model && asset->level == level)
            return asset;
    asset = add_entry(store, model->share->id);
    if (!asset) {
        error_set(error, ERROR_SERVER, "%s: no room for its polygons: try again later",
                  model->name);
        return NULL;
    }
    enter(asset, ASSET_POLYGONS, model->sha256, model->owner);
    memcpy(asset->name, model->name, sizeof asset->name);
    asset->of = model;
    asset->level = level;
    TAILQ_INSERT_AFTER(&store->by_use, model, asset, use_link);
    return asset;
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
    struct store_counts counts = {.used_bytes = account_used(&store->account),
                                  .budget_bytes = store->account.limit,
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
