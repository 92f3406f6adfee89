/* The store holds everything that clients have uploaded, by owner, kind and SHA-256: files that
 * were not used yet, models and light images that are ready on the device, and the polygons of
 * models, by model and level. It also holds the memory budget of the whole daemon.
 *
 * An asset is built once, at its first use, however many requests wait for it. A client without a
 * running build gets its build started at once; all builds share the pool in slices (slices.h).
 * When room is needed, assets that no request uses are evicted: first those of clients that hold
 * more than an equal share, and of each client the least recently used first. A client that asks
 * for an evicted model is told that the model is unknown, and uploads it again. An asset in use is
 * never evicted.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_H
#define SHEEN_ASSETS_STORE_H

#include <sys/queue.h>

#include "protocol/frame.h"
#include "server/assets/build.h"
#include "server/assets/store_shares.h"
#include "server/assets/light_image.h"
#include "server/assets/model.h"
#include "server/assets/polygons.h"

#define STORE_MAX_ASSETS 4096
/* Builds at the same time, of different clients; each has a thread of `readers`. */
#define STORE_MAX_BUILDS 16
#define STORE_BUILDS_OF_ONE 2 /* builds at the same time of one client */
#define STORE_NAME_BYTES 256

/* The owner of assets that everybody may use. */
extern const uint8_t STORE_SHARED[OWNER_BYTES];

enum asset_kind { ASSET_MODEL, ASSET_IMAGE, ASSET_POLYGONS };

enum asset_state {
    /* The file is here, and is not built yet, or a build failed that may work another time;
     * polygons: not made yet. */
    ASSET_STORED,
    ASSET_BUILDING, /* being built, or waiting for its turn */
    ASSET_READY,    /* `model`, `image` or `polygons` is set, and the file is freed */
    ASSET_FAILED,   /* the file is bad and was freed; `failure` says why */
};

/* The limits of models, images and other memory. */
struct asset_limits {
    /* Bytes of everything together: the daemon itself, files, tables, polygons, texels and frames, in
     * main memory and on the device. */
    uint64_t memory_budget;
    /* Bytes for each identity: uploads, long messages being received, and frames. */
    uint64_t peer_memory;
    uint64_t max_image_side; /* largest width and height of a light image, px */
    uint64_t tables_cpu_s;   /* processor time for one model's tables, in seconds */
};

struct asset_waiter;
struct store;

struct asset {
    enum asset_kind kind;
    enum asset_state state;
    uint8_t sha256[MODEL_ID_BYTES];
    uint8_t owner[OWNER_BYTES]; /* the same file of two owners is two assets */
    uint8_t asker[OWNER_BYTES]; /* identity that first asked for the build */
    char name[STORE_NAME_BYTES];
    uint8_t *file; /* malloc'd, or NULL */
    size_t file_bytes;
    uint64_t work_bytes; /* charged beside them while ASSET_BUILDING */
    struct model *model;
    struct light_image *image;
    struct renderer_polygons *polygons; /* polygons in main memory */
    struct error failure;
    struct build_progress progress; /* valid while ASSET_BUILDING */
    uint64_t unreported_us;         /* time of the build; 0 once a frame has reported it */

    /* The store's own. */
    struct store *store;
    struct store_share *share; /* the share that the asset counts for */
    unsigned users;            /* number of requests that wait for it or use it */
    struct account account;    /* bytes charged for it, all as ACCOUNT_ASSETS */
    unsigned polygon_levels;   /* bit i: the polygons of level i on the device are charged */
    unsigned drawn_levels;     /* bit i: the device has had the polygons of level i */
    uint32_t drawn_on;         /* GPU generation for which drawn_levels is valid */
    struct asset *of;          /* polygons: their model, not NULL, which outlives them */
    uint32_t level;            /* polygons: their level */
    atomic_bool is_unwanted;   /* polygons: no request waits for them now */
    bool was_unwanted;         /* is_unwanted was true at some time since the build began */
    LIST_HEAD(asset_waiters, asset_waiter) waiters;
    TAILQ_ENTRY(asset) build_link; /* queue of builds that wait */
    TAILQ_ENTRY(asset) use_link;   /* list in order of the last use */
    LIST_ENTRY(asset) bucket_link;
};

/* A request that waits for a build. ready() is called once on the loop's thread, with NULL, or with
 * the error. */
struct asset_waiter {
    void (*ready)(struct asset_waiter *waiter, const struct error *failure);
    void *owner;

    /* The store's own. */
    struct asset *asset; /* the asset that it waits for, or NULL */
    LIST_ENTRY(asset_waiter) link;
};

struct store_counts {
    uint32_t models, images; /* ready */
    uint64_t model_bytes;    /* tables on the device */
    /* Parts of the budget that are in use: files, tables, texels, messages and frames; what frames are
     * drawn on; spare blocks; what the daemon itself takes. */
    uint64_t used_bytes, device_bytes, spare_bytes, daemon_bytes;
    /* Of used_bytes: assets, what is being received, interactive frames, other frames. */
    uint64_t assets_bytes, input_bytes, interactive_bytes, patient_bytes;
    uint64_t budget_bytes;
    /* Since the start: uses of a ready asset, and uses that had to wait. */
    uint64_t hits, misses, evictions;
};

/* `readers` must have STORE_MAX_BUILDS threads. *limits must outlive the store; memory_budget and
 * max_image_side are read now, tables_cpu_s whenever a build starts. is_private: the daemon belongs
 * to one client, which chooses the budget, and error messages say so. NULL when memory is short. */
struct store *store_create(struct pool *pool, struct pool *readers,
                           struct render_thread *render_thread, struct workers *workers,
                           const struct asset_limits *limits, bool is_private, struct error *error);
/* Frees the store. No build may be running. The render thread must still run, because it frees what
 * is on the device. */
void store_destroy(struct store *store); /* NULL is safe */

/* Finds an asset: the owner's own, else a shared one, else NULL. If the owner's own is
 * ASSET_FAILED, a shared one is preferred. If there are several shared ones, brought under
 * different names, it is the one that `asker` (the client's identity) brought, else one that can be
 * read. The result stays valid at least until control returns to the event loop. */
struct asset *store_find(struct store *store, const uint8_t owner[static OWNER_BYTES],
                         const uint8_t asker[static OWNER_BYTES], enum asset_kind kind,
                         const uint8_t sha256[static MODEL_ID_BYTES]);
/* Would the asset's file be read in the same way under this name? The ending of a name tells the
 * format, so a file that was not read yet, or could not be read, may be good under another name. */
bool store_is_known_as(const struct asset *asset, const char *name);
/* From now on every client may use the asset. */
void store_share(struct asset *asset);

/* What of the memory budget the daemon itself takes, at most all of it: its programs' code and data, and
 * the stacks of its threads. Call it before anything is charged. */
void store_set_daemon_bytes(struct store *store, uint64_t bytes);

/* Called before the store takes so many bytes: first to bring the accounts of what others keep up to
 * date and to give up what is cheap to have again, then, is_last_resort, when not even the eviction
 * of all unused assets would make room. The loop's thread. */
struct store_relief {
    void (*relieve)(void *owner, uint64_t bytes, bool is_last_resort);
    void *owner;
};
void store_set_relief(struct store *store, const struct store_relief *relief);

/* The root of all accounts; its limit is the memory budget less what the daemon itself takes. */
struct account *store_account(struct store *store);

/* Charges `bytes`, which are about to be allocated for `what` (a file's name), to `account`, which
 * is the store's or below it, as `class`. If the budget has no room, assets that no request uses
 * are evicted: first the asker's own, if it would hold more than an equal share of the budget, then
 * those of clients that do. The caller has checked the limits of the accounts below the store's. On
 * failure returns false; *error names the need, the budget and what the reader can do. Its kind is
 * `permanent` if the bytes can never fit, else ERROR_SERVER. */
bool store_reserve(struct store *store, const uint8_t asker[static OWNER_BYTES],
                   struct account *account, enum account_class class, uint64_t bytes,
                   const char *what, enum error_kind permanent, struct error *error);

/* Adds a malloc'd file whose hash was checked, and takes its ownership. Its bytes were charged to
 * `charged` as ACCOUNT_INPUT; the charge moves to the asset. The asset counts for `holder`, the
 * identity that brought it, even if everybody may use it.
 *
 * If the store has the file already, and under a name with the same meaning (store_is_known_as()),
 * the new file is freed and its charge refunded. A file with another name replaces the asset of the
 * same holder, or stands beside that of another holder. If there is no room for another asset, the
 * file is freed, its charge refunded, and false is returned with ERROR_SERVER. */
bool store_add(struct store *store, const uint8_t owner[static OWNER_BYTES],
               const uint8_t holder[static OWNER_BYTES], enum asset_kind kind,
               const uint8_t sha256[static MODEL_ID_BYTES], const char *name, uint8_t *file,
               size_t file_bytes, struct account *charged, struct error *error);

enum acquire_result { ACQUIRE_READY, ACQUIRE_WAIT, ACQUIRE_FAILED };

/* Uses an asset for the client with identity `asker`, whoever owns the asset; clients that wait for
 * builds take turns. READY: the asset may be used until store_unuse(). WAIT: waiter->ready() will
 * be called; if it gets no error, that means READY. FAILED: *error says why. */
enum acquire_result store_acquire(struct asset *asset, const uint8_t asker[static OWNER_BYTES],
                                  struct asset_waiter *waiter, struct error *error);
void store_unuse(struct asset *asset);
/* Stops waiting: ready() will not be called. The build goes on. False if the waiter does not
 * wait. */
bool store_stop_waiting(struct asset_waiter *waiter);

/* The polygons of a level (0 to 6) of a model in use, to be passed to store_acquire(), which makes
 * them if needed. They count for the client that the model counts for. Their memory on the device
 * is charged until the model goes, their main memory until they are evicted. Making them stops when
 * no request waits for them any more. NULL with *error on failure, as for store_reserve(). */
struct asset *store_find_polygons(struct asset *model, uint32_t level, struct error *error);

/* The slices by which builds share the pool. Other work that takes long joins them. */
struct slices *store_slices(struct store *store);

/* From now on every build fails soon: the daemon ends. */
void store_cancel_builds(struct store *store);
bool store_is_building(const struct store *store);
struct store_counts store_count(const struct store *store);

#endif
