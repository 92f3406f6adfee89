/* Everything that clients have uploaded, by owner, kind and SHA-256: files that wait to be used,
 * models and light images that are ready on the GPU; and the memory budget for all that the daemon
 * holds.
 *
 * An asset is built on first use, once, however many requests wait for it, and a few at a time.
 * What no request uses is evicted when room is needed, of those first who hold more than an equal
 * share, and of each the least recently used first; the client is then told that the model is
 * unknown and uploads it again. Nothing in use is ever evicted.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_STORE_H
#define SHEEN_ASSETS_STORE_H

#include "protocol/frame.h"
#include "server/assets/build.h"
#include "server/assets/store_shares.h"
#include "server/assets/light_image.h"
#include "server/assets/model.h"

#define STORE_MAX_ASSETS 4096
#define STORE_MAX_BUILDS 2 /* at once; bounds the queues of the pool and the GL thread */
#define STORE_NAME_BYTES 256
#define STORE_OWNER_BYTES 32

/* The owner of what everybody may use. */
extern const uint8_t STORE_SHARED[STORE_OWNER_BYTES];

enum asset_kind { ASSET_MODEL, ASSET_IMAGE };

enum asset_state {
    ASSET_STORED,   /* the file is here; also after a build that may work another time */
    ASSET_BUILDING, /* or waiting for its turn */
    ASSET_READY,    /* `model` or `image` is set, the file is gone */
    ASSET_FAILED,   /* the file is bad and gone; `failure` says why */
};

/* What models, images and everything beside them may take. */
struct asset_limits {
    uint64_t memory_budget; /* bytes: files, tables, polygons, texels, frames, all together, in main
                               memory and on the device */
    uint64_t peer_memory;   /* bytes: uploads, long messages under way and frames of one user or
                               address */
    uint64_t max_image_side; /* px of a light image, either way */
    uint64_t tables_cpu_s;   /* of processors, for one model's tables */
};

struct asset_waiter;
struct store;

struct asset {
    enum asset_kind kind;
    enum asset_state state;
    uint8_t sha256[MODEL_ID_BYTES];
    uint8_t owner[STORE_OWNER_BYTES]; /* equal files of two owners are two assets */
    uint8_t asker[STORE_OWNER_BYTES]; /* whoever asked for the build first */
    char name[STORE_NAME_BYTES];
    uint8_t *file; /* malloc'd, or NULL */
    size_t file_bytes;
    struct model *model;
    struct light_image *image;
    struct error failure;
    struct build_progress progress; /* while BUILDING */
    uint64_t unreported_us;         /* time of the build until a frame has reported it */

    /* The store's own. */
    struct store *store;
    struct holder *holder;
    unsigned users; /* requests that wait for it or use it */
    size_t charged_bytes;
    unsigned polygon_levels; /* bits: levels whose polygons are charged */
    unsigned drawn_levels;   /* bits: levels that the device has had polygons of */
    uint32_t drawn_on;       /* the generation of the device that drawn_levels is of */
    struct asset_waiter *waiters;
    struct asset *next_build;    /* in the queue for a turn */
    struct asset *newer, *older; /* by last use */
    struct asset *bucket_next;
};

/* A request that waits for a build. ready() is called once, with why it failed or NULL. */
struct asset_waiter {
    void (*ready)(struct asset_waiter *waiter, const struct error *failure);
    void *owner;

    /* The store's own. */
    struct asset *asset; /* that it waits for, or NULL */
    struct asset_waiter *next, *previous;
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
/* No build may be running. The GL thread must run on until it has freed what it holds. */
void store_destroy(struct store *store); /* NULL is safe */

/* The owner's own, else the shared one, else NULL; the shared one, too, where his own cannot be
 * read. The asset stays at least until the loop's next turn. */
struct asset *store_find(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
                         enum asset_kind kind, const uint8_t sha256[static MODEL_ID_BYTES]);
/* Is what comes under this name the same to its readers? The ending of a name tells the format:
 * what could not be read, or has not been yet, may be a good file under another name. */
bool store_is_known_as(const struct asset *asset, const char *name);
/* From now on everybody may use it. */
void store_share(struct asset *asset);

/* Charges bytes that are about to be allocated for `what` (a file's name), evicting if need be: the
 * asker's own, if he would hold more than an equal share of the budget, then of those who do.
 * The error names the need and the budget, and what its reader can do: `permanent` kind if it can
 * never fit, else ERROR_SERVER. */
bool store_reserve(struct store *store, const uint8_t asker[static STORE_OWNER_BYTES], size_t bytes,
                   const char *what, enum error_kind permanent, struct error *error);
void store_release(struct store *store, size_t bytes);

/* Takes over a malloc'd file whose bytes have been charged, and whose hash has been checked. It
 * counts for `holder`, the identity of whoever brought it, also where all may use it. A file that
 * is here already, and known as this, is freed. ERROR_SERVER when there is no room for another
 * entry; the file is freed then too. */
bool store_add(struct store *store, const uint8_t owner[static STORE_OWNER_BYTES],
               const uint8_t holder[static HOLDER_ID_BYTES], enum asset_kind kind,
               const uint8_t sha256[static MODEL_ID_BYTES], const char *name, uint8_t *file,
               size_t file_bytes, struct error *error);

enum acquire_result { ACQUIRE_READY, ACQUIRE_WAIT, ACQUIRE_FAILED };

/* Wants to use an asset, for the client of this identity, whoever owns it: of those who wait for
 * builds each has his turn. READY: it is, until store_unuse(). WAIT: waiter->ready() will be
 * called; without a failure that is as READY. FAILED: *error says why. */
enum acquire_result store_acquire(struct asset *asset,
                                  const uint8_t asker[static STORE_OWNER_BYTES],
                                  struct asset_waiter *waiter, struct error *error);
void store_unuse(struct asset *asset);
/* The waiter wants the asset no more: ready() will not be called. False if it does not wait. The
 * build goes on. */
bool store_stop_waiting(struct asset_waiter *waiter);

/* A model in use will be drawn as polygons of this level (0 to 6): they are charged once, until the
 * model goes. False as store_reserve(). */
bool store_charge_polygons(struct asset *asset, uint32_t level, struct error *error);

/* From now on every build fails soon: nobody waits for it any more. */
void store_cancel_builds(struct store *store);
bool store_is_building(const struct store *store);
bool store_is_private(const struct store *store);   /* of one client alone */
size_t store_used_bytes(const struct store *store); /* of the budget */
struct store_counts store_count(const struct store *store);

#endif
