/* Everything that clients have uploaded, by owner, kind and SHA-256: files that wait to be used,
 * models and light images that are ready on the GPU; the polygons of models, by model and level; and
 * the memory budget for all that the daemon holds.
 *
 * An asset is built once, when it is first used, however many requests wait for it. A client that has
 * no build running gets one started at once, and all share the pool by slices (slices.h). When room is needed, assets that no request uses are evicted: first those of clients
 * that hold more than an equal share, and of each client the least recently used first. A client
 * that asks for an evicted model is told that the model is unknown, and uploads it again. Nothing in
 * use is ever evicted.
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
#define STORE_MAX_BUILDS 16   /* at once, of as many clients; each has a thread of `readers` */
#define STORE_BUILDS_OF_ONE 2 /* of one client alone */
#define STORE_NAME_BYTES 256

/* The owner of what everybody may use. */
extern const uint8_t STORE_SHARED[OWNER_BYTES];

enum asset_kind { ASSET_MODEL, ASSET_IMAGE, ASSET_POLYGONS };

enum asset_state {
    ASSET_STORED,   /* the file is here; also after a build that may work another time. Of polygons:
                       they are not made yet */
    ASSET_BUILDING, /* or waiting for its turn */
    ASSET_READY,    /* `model`, `image` or `polygons` is set, the file is gone */
    ASSET_FAILED,   /* the file is bad and gone; `failure` says why */
};

/* What models, images and everything beside them may take. */
struct asset_limits {
    uint64_t memory_budget; /* bytes: files, tables, polygons, texels, frames, all together, in main
                               memory and on the device */
    uint64_t peer_memory;   /* bytes: uploads, long messages under way and frames of one
                               identity */
    uint64_t max_image_side; /* px of a light image, either way */
    uint64_t tables_cpu_s;   /* of processors, for one model's tables */
};

struct asset_waiter;
struct store;

struct asset {
    enum asset_kind kind;
    enum asset_state state;
    uint8_t sha256[MODEL_ID_BYTES];
    uint8_t owner[OWNER_BYTES]; /* equal files of two owners are two assets */
    uint8_t asker[OWNER_BYTES]; /* whoever asked for the build first */
    char name[STORE_NAME_BYTES];
    uint8_t *file; /* malloc'd, or NULL */
    size_t file_bytes;
    struct model *model;
    struct light_image *image;
    struct renderer_polygons *polygons; /* in main memory */
    struct error failure;
    struct build_progress progress; /* while BUILDING */
    uint64_t unreported_us;         /* time of the build until a frame has reported it */

    /* The store's own. */
    struct store *store;
    struct store_share *share; /* that it counts for */
    unsigned users;            /* requests that wait for it or use it */
    struct account account;    /* what it is charged with, all of it ACCOUNT_ASSETS */
    unsigned polygon_levels;   /* bits: levels whose polygons on the device are charged */
    unsigned drawn_levels;     /* bits: levels that the device has had polygons of */
    uint32_t drawn_on;         /* the generation of the device that drawn_levels is of */
    struct asset *of;          /* of polygons: their model; not NULL, and it stays as long */
    uint32_t level;            /* of polygons */
    atomic_bool is_unwanted;   /* of polygons: nobody waits for them now */
    bool was_unwanted;         /* so it was at some time since the build began */
    LIST_HEAD(asset_waiters, asset_waiter) waiters;
    TAILQ_ENTRY(asset) build_link; /* in the queue for a turn */
    TAILQ_ENTRY(asset) use_link;   /* by last use */
    LIST_ENTRY(asset) bucket_link;
};

/* A request that waits for a build. ready() is called once, with why it failed or NULL. */
struct asset_waiter {
    void (*ready)(struct asset_waiter *waiter, const struct error *failure);
    void *owner;

    /* The store's own. */
    struct asset *asset; /* that it waits for, or NULL */
    LIST_ENTRY(asset_waiter) link;
};

struct store_counts {
    uint32_t models, images; /* ready */
    uint64_t model_bytes;    /* tables on the GPU */
    uint64_t used_bytes, budget_bytes;
    uint64_t hits, misses, evictions; /* ever: uses of what was ready, uses that had to wait */
};

/* `readers` has STORE_MAX_BUILDS threads. Of the limits, which must stay, the budget and the size
 * of images are read now, the time of a build when it starts. A private daemon's client chooses
 * the budget himself, and errors about it tell him so. */
struct store *store_create(struct pool *pool, struct pool *readers,
                           struct render_thread *render_thread, struct workers *workers,
                           const struct asset_limits *limits, bool is_private, struct error *error);
/* No build may be running. The render thread must run on until it has freed what it holds. */
void store_destroy(struct store *store); /* NULL is safe */

/* The owner's own, else the shared one, else NULL; the shared one, too, where his own cannot be
 * read. Of several shared ones, which were brought under different names, the one that `asker`, the
 * client's identity, brought himself, else one that can be read. The asset stays at least until the
 * loop's next turn. */
struct asset *store_find(struct store *store, const uint8_t owner[static OWNER_BYTES],
                         const uint8_t asker[static OWNER_BYTES], enum asset_kind kind,
                         const uint8_t sha256[static MODEL_ID_BYTES]);
/* Would the asset's file be read in the same way under this name? The ending of a name tells the
 * format. A file that has not been read yet, or could not be, may be good under another name. */
bool store_is_known_as(const struct asset *asset, const char *name);
/* From now on every client may use the asset. */
void store_share(struct asset *asset);

/* The root of all accounts, whose limit is the memory budget. */
struct account *store_account(struct store *store);

/* Charges bytes that are about to be allocated for `what` (a file's name) to `account`, which is
 * the store's or below it, as `class`. Where the budget has no room, assets that nobody uses are
 * evicted first: the asker's own, if it would hold more than an equal share of the budget, then
 * those of clients that do. The caller has checked the limits of accounts below the store's. The
 * error names the need and the budget, and what its reader can do: `permanent` kind if the bytes
 * can never fit, else ERROR_SERVER. */
bool store_reserve(struct store *store, const uint8_t asker[static OWNER_BYTES],
                   struct account *account, enum account_class class, uint64_t bytes,
                   const char *what, enum error_kind permanent, struct error *error);

/* Takes over a malloc'd file whose hash has been checked, and whose bytes have been charged to
 * `charged` as ACCOUNT_INPUT, from where the charge moves to the asset. The asset counts for
 * `holder`, the identity of the client that brought it, also where everybody may use it. A file
 * that is here already, and known as this, is freed and its charge refunded; so it is when there is
 * no room for another entry: ERROR_SERVER. Under another name it takes the place of what the same
 * holder brought, and stands beside what another did. */
bool store_add(struct store *store, const uint8_t owner[static OWNER_BYTES],
               const uint8_t holder[static OWNER_BYTES], enum asset_kind kind,
               const uint8_t sha256[static MODEL_ID_BYTES], const char *name, uint8_t *file,
               size_t file_bytes, struct account *charged, struct error *error);

enum acquire_result { ACQUIRE_READY, ACQUIRE_WAIT, ACQUIRE_FAILED };

/* Wants to use an asset, for the client of this identity, whoever owns it: of those who wait for
 * builds each has his turn. READY: it is, until store_unuse(). WAIT: waiter->ready() will be
 * called; without a failure that is as READY. FAILED: *error says why. */
enum acquire_result store_acquire(struct asset *asset, const uint8_t asker[static OWNER_BYTES],
                                  struct asset_waiter *waiter, struct error *error);
void store_unuse(struct asset *asset);
/* The waiter wants the asset no more: ready() will not be called. False if it does not wait. The
 * build goes on. */
bool store_stop_waiting(struct asset_waiter *waiter);

/* The polygons of a level (0 to 6) of a model that is in use, for store_acquire(): they are made
 * when they are first acquired, and count for whom the model counts. What the device takes for them
 * is charged once, until the model goes; what they take in main memory, until they are evicted.
 * Making them is given up when nobody waits for them any more. NULL on failure, as
 * store_reserve(). */
struct asset *store_find_polygons(struct asset *model, uint32_t level, struct error *error);

/* From now on every build fails soon: nobody waits for it any more. */
void store_cancel_builds(struct store *store);
bool store_is_building(const struct store *store);
struct store_counts store_count(const struct store *store);

#endif
