#include "server/assets/store.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define N_BUCKETS 1024

struct store {
    struct pool *pool, *readers;
    struct render_thread *render_thread;
    struct workers *workers;
    const struct asset_limits *limits;
    bool is_private; /* the daemon is */
    size_t budget_bytes, used_bytes;
    uint32_t max_image_px;
    size_t n_assets;
    struct holders holders;
    uint64_t n_hits, n_misses, n_evictions;
    unsigned n_building;
    const struct asset *building[STORE_MAX_BUILDS];
    atomic_bool cancelled;
    struct asset *build_head, *build_tail; /* wait for a turn */
    struct asset *newest, *oldest;
    struct asset *buckets[N_BUCKETS];
};

const uint8_t STORE_SHARED[STORE_OWNER_BYTES] = {0};

/* SHA-256 is its own hash. */
static struct asset **bucket_of(struct store *store, const uint8_t *sha256)
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
    store->pool = pool;
    store->readers = readers;
    store->render_thread = render_thread;
    store->workers = workers;
    store->limits = limits;
    store->is_private = is_private;
    store->budget_bytes = limits->memory_budget;
    store->max_image_px = (uint32_t)limits->max_image_side;
    return store;
}

static void unlink_by_use(struct store *store, struct asset *asset)
{
    *(asset->newer ? &asset->newer->older : &store->newest) = asset->older;
    *(asset->older ? &asset->older->newer : &store->oldest) = asset->newer;
}

static void link_newest(struct store *store, struct asset *asset)
{
    asset->newer = NULL;
    asset->older = store->newest;
    *(store->newest ? &store->newest->newer : &store->oldest) = asset;
    store->newest = asset;
}

/* Bytes that have been reserved are the asset's now. */
static void charge(struct asset *asset, size_t bytes)
{
    asset->charged_bytes += bytes;
    asset->holder->held[HOLDING_BYTES] += bytes;
}

static void uncharge(struct asset *asset, size_t bytes)
{
    asset->charged_bytes -= bytes;
    asset->holder->held[HOLDING_BYTES] -= bytes;
    store_release(asset->store, bytes);
}

static void drop_file(struct asset *asset)
{
    if (!asset->file)
        return;
    free(asset->file);
    asset->file = NULL;
    uncharge(asset, asset->file_bytes);
}

static void asset_destroy(struct asset *asset)
{
    struct store *store = asset->store;
    struct asset **link = bucket_of(store, asset->sha256);
    while (*link != asset)
        link = &(*link)->bucket_next;
    *link = asset->bucket_next;
    unlink_by_use(store, asset);
    store->n_assets--;
    drop_file(asset);
    uncharge(asset, asset->charged_bytes);
    asset->holder->held[HOLDING_ASSETS]--;
    holder_put(&store->holders, asset->holder);
    if (asset->model)
        model_destroy(asset->model, store->render_thread);
    if (asset->image)
        light_image_destroy(asset->image, store->render_thread);
    free(asset);
}

void store_destroy(struct store *store)
{
    if (!store)
        return;
    while (store->newest)
        asset_destroy(store->newest);
    free(store);
}

static bool is_evictable(const struct asset *asset)
{
    return asset->users == 0 && asset->state != ASSET_BUILDING;
}

/* --- making room */

/* What is wanted: `needed` bytes, or entries. */
struct want {
    enum holding what;
    size_t needed;
};

static size_t all_of(const struct store *store, enum holding what)
{
    return what == HOLDING_BYTES ? store->budget_bytes : STORE_MAX_ASSETS;
}

static bool is_there(const struct store *store, const struct want *want)
{
    size_t used = want->what == HOLDING_BYTES ? store->used_bytes : store->n_assets;
    return want->needed <= all_of(store, want->what) - used;
}

static bool could_be_there(const struct store *store, const struct want *want)
{
    size_t used = want->what == HOLDING_BYTES ? store->used_bytes : store->n_assets;
    size_t room = all_of(store, want->what) - used;
    for (const struct asset *asset = store->oldest; asset && room < want->needed;
         asset = asset->newer)
        if (is_evictable(asset))
            room += want->what == HOLDING_BYTES ? asset->charged_bytes : 1;
    return room >= want->needed;
}

/* Of the holder's, or of all for NULL, what has not been used for longest, until there is room or
 * he has no more than `keep` of it. */
static void evict(struct store *store, const struct want *want, const struct holder *holder,
                  size_t keep)
{
    for (struct asset *asset = store->oldest, *newer; asset && !is_there(store, want);
         asset = newer) {
        newer = asset->newer;
        if (holder && holder->held[want->what] <= keep)
            return;
        if (!is_evictable(asset) || (holder && asset->holder != holder))
            continue;
        asset_destroy(asset);
        store->n_evictions++;
    }
}

/* Who wants more than an equal share makes room by what is his own; then those do who hold more
 * than a share, the largest first; then whatever has not been used for longest goes. Evicts only if
 * that is enough. */
static bool make_room(struct store *store, const uint8_t *asker, const struct want *want)
{
    if (is_there(store, want))
        return true;
    if (!could_be_there(store, want))
        return false;
    struct holder *own = holder_find(&store->holders, asker), *other;
    size_t share = all_of(store, want->what) / (store->holders.n + !own);
    if (own && own->held[want->what] + want->needed > share)
        evict(store, want, own, 0);
    holder_put(&store->holders, own);
    holders_begin(&store->holders);
    while (!is_there(store, want) && (other = holders_next(&store->holders, want->what, share))) {
        other->references++; /* his last asset may go */
        evict(store, want, other, share);
        holder_put(&store->holders, other);
    }
    evict(store, want, NULL, 0);
    return true;
}

/* Exactly this owner's. */
static struct asset *find_owned(struct store *store, const uint8_t *owner, enum asset_kind kind,
                                const uint8_t *sha256)
{
    struct asset *asset = *bucket_of(store, sha256);
    while (asset && (asset->kind != kind || memcmp(asset->sha256, sha256, MODEL_ID_BYTES) != 0 ||
                     memcmp(asset->owner, owner, STORE_OWNER_BYTES) != 0))
        asset = asset->bucket_next;
    return asset;
}

struct asset *store_find(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
                         enum asset_kind kind, const uint8_t sha256[static MODEL_ID_BYTES])
{
    struct asset *own = find_owned(store, owner, kind, sha256);
    if (own && own->state != ASSET_FAILED)
        return own;
    struct asset *shared = find_owned(store, STORE_SHARED, kind, sha256);
    return shared ? shared : own;
}

bool store_is_known_as(const struct asset *asset, const char *name)
{
    return asset->state == ASSET_READY || strcmp(asset->name, name) == 0;
}

void store_share(struct asset *asset)
{
    if (!find_owned(asset->store, STORE_SHARED, asset->kind, asset->sha256))
        memcpy(asset->owner, STORE_SHARED, sizeof asset->owner);
}

/* All memory is this one client's: nobody else will give any back. */
static bool refuse_private(const struct store *store, size_t bytes, const char *what,
                           enum error_kind permanent, struct error *error)
{
    const uint64_t mib = 1 << 20;
    uint64_t enough = ((uint64_t)store->used_bytes + bytes) / 8 * 9 / mib + 1;
    return error_set(error, permanent,
                     "%s needs %zu bytes beside %zu in use, and this command's daemon has a memory "
                     "budget of %zu: give more, as --memory-budget %" PRIu64
                     "M, if the machine has "
                     "it",
                     what, bytes, store->used_bytes, store->budget_bytes, enough);
}

bool store_reserve(struct store *store, const uint8_t asker[static STORE_OWNER_BYTES], size_t bytes,
                   const char *what, enum error_kind permanent, struct error *error)
{
    const struct want want = {HOLDING_BYTES, bytes};
    if (bytes > store->budget_bytes && !store->is_private)
        return error_set(error, permanent,
                         "%s needs %zu bytes and the daemon's memory budget is %zu: ask its "
                         "operator for more (sheend --memory-budget)",
                         what, bytes, store->budget_bytes);
    bool has_room = bytes <= store->budget_bytes && make_room(store, asker, &want);
    if (!has_room && store->is_private)
        return refuse_private(store, bytes, what, permanent, error);
    if (!has_room)
        return error_set(error, ERROR_SERVER,
                         "%s needs %zu bytes; of the daemon's memory budget of %zu, %zu are in use "
                         "now: try again later",
                         what, bytes, store->budget_bytes, store->used_bytes);
    store->used_bytes += bytes;
    return true;
}

bool store_is_private(const struct store *store)
{
    return store->is_private;
}

void store_release(struct store *store, size_t bytes)
{
    store->used_bytes -= bytes;
}

/* Takes a file, whose bytes have been reserved, in the place of another or of none. */
static void take_file(struct asset *asset, const char *name, uint8_t *file, size_t file_bytes)
{
    drop_file(asset);
    snprintf(asset->name, sizeof asset->name, "%s", name);
    asset->state = ASSET_STORED;
    asset->file = file;
    asset->file_bytes = file_bytes;
    charge(asset, file_bytes);
}

/* An entry without a file. NULL when there is no room for another, or no memory. */
static struct asset *add_entry(struct store *store, const uint8_t *holder)
{
    static const struct want one = {HOLDING_ASSETS, 1};
    if (!make_room(store, holder, &one))
        return NULL;
    struct asset *asset = calloc(1, sizeof *asset);
    if (asset && !(asset->holder = holder_get(&store->holders, holder))) {
        free(asset);
        return NULL;
    }
    if (asset) {
        asset->store = store;
        asset->holder->held[HOLDING_ASSETS]++;
    }
    return asset;
}

bool store_add(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
               const uint8_t holder[static HOLDER_ID_BYTES], enum asset_kind kind,
               const uint8_t sha256[static MODEL_ID_BYTES], const char *name, uint8_t *file,
               size_t file_bytes, struct error *error)
{
    struct asset *asset = NULL, *known = find_owned(store, owner, kind, sha256);
    if (known && known->state != ASSET_BUILDING && !store_is_known_as(known, name)) {
        take_file(known, name, file, file_bytes);
        return true;
    }
    if (!known)
        asset = add_entry(store, holder);
    if (!asset) {
        free(file);
        store_release(store, file_bytes);
        return known || error_set(error, ERROR_SERVER,
                                  "%s: no room for another model or image: try again later", name);
    }
    asset->kind = kind;
    memcpy(asset->sha256, sha256, MODEL_ID_BYTES);
    memcpy(asset->owner, owner, sizeof asset->owner);
    take_file(asset, name, file, file_bytes);
    asset->bucket_next = *bucket_of(store, sha256);
    *bucket_of(store, sha256) = asset;
    link_newest(store, asset);
    store->n_assets++;
    return true;
}

/* --- building */

static void start_builds(struct store *store);

static void unlink_waiter(struct asset_waiter *waiter)
{
    *(waiter->previous ? &waiter->previous->next : &waiter->asset->waiters) = waiter->next;
    if (waiter->next)
        waiter->next->previous = waiter->previous;
    waiter->asset = NULL;
}

/* One by one: what one of them does may make others stop waiting, and room where this was. */
static void wake_waiters(struct asset *asset, const struct error *failure)
{
    asset->users++;
    for (struct asset_waiter *waiter; (waiter = asset->waiters);) {
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
        /* What the file causes stays so; what the moment causes may pass. */
        bool bad_file = failure->kind == ERROR_MODEL || failure->kind == ERROR_IMAGE;
        uncharge(asset, asset->charged_bytes - asset->file_bytes);
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
    asset->users++; /* nobody woken may see it evicted */
    build_ended(asset, failure);
    asset->users--;
    start_builds(store);
}

static bool build_reserve(void *owner, size_t bytes, struct error *error)
{
    struct asset *asset = owner;
    enum error_kind permanent = asset->kind == ASSET_MODEL ? ERROR_MODEL : ERROR_IMAGE;
    if (!store_reserve(asset->store, asset->holder->id, bytes, asset->name, permanent, error))
        return false;
    charge(asset, bytes);
    return true;
}

/* Does whoever asked for it have another build running? */
static bool is_served(const struct store *store, const struct asset *asset)
{
    for (unsigned i = 0; i < store->n_building; i++)
        if (memcmp(store->building[i]->asker, asset->asker, sizeof asset->asker) == 0)
            return true;
    return false;
}

/* The first of those that wait whose asker has nothing running, else the first: who asks for a
 * hundred models that take a minute each must not hold up who asks for one. Some wait. */
static struct asset *take_next(struct store *store)
{
    struct asset *before = NULL, *asset = store->build_head;
    while (asset && is_served(store, asset)) {
        before = asset;
        asset = asset->next_build;
    }
    if (!asset) {
        before = NULL;
        asset = store->build_head;
    }
    *(before ? &before->next_build : &store->build_head) = asset->next_build;
    if (store->build_tail == asset)
        store->build_tail = before;
    return asset;
}

static void start_builds(struct store *store)
{
    while (store->n_building < STORE_MAX_BUILDS && store->build_head) {
        struct asset *asset = take_next(store);
        const struct build_order order = {
            .pool = store->pool,
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

static void queue_build(struct asset *asset, const uint8_t asker[static STORE_OWNER_BYTES])
{
    struct store *store = asset->store;
    memcpy(asset->asker, asker, sizeof asset->asker);
    asset->state = ASSET_BUILDING;
    asset->progress.stage = "waiting";
    asset->progress.total = 0;
    atomic_store(&asset->progress.done, 0);
    asset->next_build = NULL;
    if (store->build_head)
        store->build_tail->next_build = asset;
    else
        store->build_head = asset;
    store->build_tail = asset;
    start_builds(store);
}

static void add_waiter(struct asset *asset, struct asset_waiter *waiter)
{
    waiter->asset = asset;
    waiter->previous = NULL;
    waiter->next = asset->waiters;
    if (waiter->next)
        waiter->next->previous = waiter;
    asset->waiters = waiter;
}

enum acquire_result store_acquire(struct asset *asset,
                                  const uint8_t asker[static STORE_OWNER_BYTES],
                                  struct asset_waiter *waiter, struct error *error)
{
    unlink_by_use(asset->store, asset);
    link_newest(asset->store, asset);
    if (asset->state == ASSET_FAILED) {
        *error = asset->failure;
        return ACQUIRE_FAILED;
    }
    asset->users++;
    if (asset->state == ASSET_READY) {
        asset->store->n_hits++;
        return ACQUIRE_READY;
    }
    asset->store->n_misses++;
    add_waiter(asset, waiter);
    if (asset->state == ASSET_STORED)
        queue_build(asset, asker);
    return ACQUIRE_WAIT;
}

bool store_charge_polygons(struct asset *asset, uint32_t level, struct error *error)
{
    if (asset->polygon_levels & 1u << level)
        return true;
    size_t bytes = renderer_polygon_bytes(&asset->model->tables, level);
    if (!store_reserve(asset->store, asset->holder->id, bytes, asset->name, ERROR_REQUEST, error))
        return false;
    charge(asset, bytes);
    asset->polygon_levels |= 1u << level;
    return true;
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
    return true;
}

void store_cancel_builds(struct store *store)
{
    atomic_store(&store->cancelled, true);
}

bool store_is_building(const struct store *store)
{
    return store->n_building > 0 || store->build_head;
}

size_t store_used_bytes(const struct store *store)
{
    return store->used_bytes;
}

struct store_counts store_count(const struct store *store)
{
    struct store_counts counts = {.used_bytes = store->used_bytes,
                                  .budget_bytes = store->budget_bytes,
                                  .hits = store->n_hits,
                                  .misses = store->n_misses,
                                  .evictions = store->n_evictions};
    for (const struct asset *asset = store->newest; asset; asset = asset->older) {
        if (asset->state != ASSET_READY)
            continue;
        counts.models += asset->kind == ASSET_MODEL;
        counts.images += asset->kind == ASSET_IMAGE;
        counts.model_bytes += asset->model ? asset->model->device_bytes : 0;
    }
    return counts;
}
