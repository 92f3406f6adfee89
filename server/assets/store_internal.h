/* What the files of the store know of each other: store_entries.c has the assets, store_room.c makes
 * room for more, store_builds.c builds models and images, store_polygons.c makes polygons. Internal
 * to the folder. Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_INTERNAL_H
#define SHEEN_ASSETS_STORE_INTERNAL_H

#include "server/assets/store.h"

#define STORE_BUCKETS 1024

LIST_HEAD(asset_bucket, asset);

struct store {
    struct slices slices; /* shares the pool among builds */
    struct pool *readers;
    struct render_thread *render_thread;
    struct workers *workers;
    const struct asset_limits *limits;
    bool is_private;        /* the daemon is private */
    struct account account; /* root of all accounts */
    struct store_relief relief;
    uint64_t daemon_bytes; /* of the budget, not in the account */
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
    struct asset_bucket buckets[STORE_BUCKETS];
};

/* The bucket of an asset, by the first bytes of its SHA-256. */
static inline struct asset_bucket *store_bucket(struct store *store, const uint8_t *sha256)
{
    return &store->buckets[(sha256[0] | (size_t)sha256[1] << 8) % STORE_BUCKETS];
}

/* Makes an asset without a file, which counts for `holder`. NULL when there is no room for another or
 * memory is short. */
struct asset *store_add_entry(struct store *store, const uint8_t holder[static OWNER_BYTES]);
/* Enters the asset into the store, except into the list by use. */
void store_enter(struct asset *asset, enum asset_kind kind, const uint8_t *sha256,
                 const uint8_t *owner);
/* Frees the asset's file, if it has one, and refunds the file's charge. */
void store_drop_file(struct asset *asset);
/* Frees the asset and all that it holds. */
void store_destroy_asset(struct asset *asset);
/* Calls ready() of every waiter. Without a failure each of them uses the asset from then on. */
void store_wake_waiters(struct asset *asset, const struct error *failure);

/* Room that is needed: `needed` bytes, or entries. */
struct store_want {
    enum share_kind kind;
    uint64_t needed;
};
/* Makes room for the client `asker` by evicting assets. False, and nothing is evicted, if that is not
 * enough. */
bool store_make_room(struct store *store, const uint8_t *asker, const struct store_want *want);

/* Queues the build of a stored model or image, and starts the builds that may start. */
void store_queue_build(struct asset *asset, const uint8_t asker[static OWNER_BYTES]);
/* Starts to make polygons that are not there. Their model counts as in use until they are made. */
bool store_start_polygons(struct asset *asset, struct error *error);

#endif
