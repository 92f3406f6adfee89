/* Model files that lie at the daemon, below --models, and are asked for by name. Thread: the
 * loop's.
 */
#ifndef SHEEN_ASSETS_MODEL_FILE_H
#define SHEEN_ASSETS_MODEL_FILE_H

#include "protocol/frame.h"
#include "server/threads/pool.h"
#include "server/assets/store.h"

/* Opens the folder. -1 with ERROR_REQUEST when there is none. */
int model_folder_open(const char *path, struct error *error);

/* Reads the file `name`, a path below the folder, on the pool, and puts it into the store for
 * everybody. Symbolic links, '..', absolute paths, other mounts and whatever is no plain file are
 * refused. loaded() is called once, unless false is returned, with the file's SHA-256, or NULL and
 * why. ERROR_MODEL says that there is no such file, and not why. */
struct model_file_order {
    int folder_fd;
    const char *name;
    size_t max_bytes;
    const uint8_t *holder; /* OWNER_BYTES: for whom it counts, whoever asked first */
    struct pool *pool;
    struct store *store;
    void (*loaded)(void *owner, const uint8_t *sha256, const struct error *error);
    void *owner;
};
bool model_file_load(const struct model_file_order *order, struct error *error);

#endif
