/* Turning an uploaded file into something on the GPU: what the builders of models and of light
 * images have in common. A build is tasks on the pool and on the render thread; it starts and
 * ends on the loop's thread. */
#ifndef SHEEN_ASSETS_BUILD_H
#define SHEEN_ASSETS_BUILD_H

#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/assets/slices.h"
#include "server/threads/pool.h"
#include "server/threads/render_thread.h"
#include "server/threads/workers.h"

struct limit_tables;

/* How far a build is; written by the build, read by the loop's thread. */
struct build_progress {
    const char *stage; /* "reading", "tables", "upload"; changed on the loop's thread only */
    atomic_size_t done;
    size_t total; /* 0: cannot be counted */
};

/* What a build reads and whom it tells. Everything here stays until finished() is called. */
struct build_order {
    struct slices *slices; /* fill tables */
    struct pool *readers; /* a thread for each build: waits for the workers, and does what cannot be
                              cut */
    struct render_thread *render_thread;
    struct workers *workers;
    const uint8_t *file;
    size_t file_bytes;
    const char *name; /* the file's, for messages and to tell the format */
    struct build_progress *progress;
    uint32_t max_image_px;        /* either way */
    uint64_t tables_cpu_us;       /* of processors, for a model's tables */
    const atomic_bool *cancelled; /* soon ends with a failure once this is true */

    /* Can a result of at least so many bytes ever be kept? If not, *error says so. It reads what
     * never changes: any thread, while the result is still measured. */
    bool (*may_need)(void *owner, size_t bytes, struct error *error);
    /* May this much memory be kept until the result is destroyed? Called once, before it is
     * filled. Evicts others to make room. */
    bool (*reserve)(void *owner, size_t bytes, struct error *error);
    /* The result, or NULL and why. Called once, at the end. */
    void (*finished)(void *owner, void *result, const struct error *error);
    void *owner;
};

/* What a model with these tables takes, on the device and in main memory. */
size_t build_model_bytes(const struct build_order *order, const struct limit_tables *tables);

#endif
