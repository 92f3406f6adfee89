/* Model files in the daemon's own folder (--models), which clients ask for by name.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_MODEL_FILE_H
#define SHEEN_ASSETS_MODEL_FILE_H

#include "protocol/frame.h"
#include "server/threads/pool.h"
#include "server/assets/store.h"

/* Opens the folder. Returns a descriptor that the caller owns, or -1 with ERROR_REQUEST. */
int model_folder_open(const char *path, struct error *error);

/* Reads the file `name`, a path below the folder, on the pool, and puts it into the store for
 * everybody. Symbolic links, '..', absolute paths, other mounts and anything but plain files are
 * refused. If true is returned, loaded() is called once on the loop's thread, with the file's
 * SHA-256, or with NULL and the error. If the file cannot be opened, ERROR_MODEL says only that
 * there is no such file, so that a client learns nothing about other files. */
struct model_file_order {
    int folder_fd;
    const char *name;
    size_t max_bytes;
    /* [OWNER_BYTES]: the identity in the store that the file counts for, whoever asks for it. */
    const uint8_t *holder;
    struct pool *pool;
    struct store *store;
    void (*loaded)(void *owner, const uint8_t *sha256, const struct error *error);
    void *owner;
};
bool model_file_load(const struct model_file_order *order, struct error *error);

#endif
