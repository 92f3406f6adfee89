/* What the builders of models (model.h) and light images (light_image.h) have in common: a build
 * turns an uploaded file into tables or texels on the device. It consists of tasks on the pool and
 * on the render thread; it starts and ends on the loop's thread. */
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

/* The progress of a build. The build writes it; the loop's thread reads it. */
struct build_progress {
    /* "reading", "tables" or "upload"; a static string, changed only on the loop's thread. */
    const char *stage;
    atomic_size_t done;
    size_t total; /* units of `done`, which depend on the stage; 0: unknown */
};

/* The input of a build and its callbacks. Everything here must stay valid until finished() is
 * called. */
struct build_order {
    struct slices *slices; /* the pool, shared with other builds */
    /* Threads for work that cannot be cut into slices, such as waiting for worker programs; there
     * is one for each build. */
    struct pool *readers;
    struct render_thread *render_thread;
    struct workers *workers;
    const uint8_t *file;
    size_t file_bytes;
    const char *name; /* the file's name: for messages, and its ending tells the format */
    struct build_progress *progress;
    uint32_t max_image_px; /* largest width and height */
    /* Limit of processor time for a model's tables, of all threads together. */
    uint64_t tables_cpu_us;
    const atomic_bool *cancelled; /* the build fails soon after this becomes true */

    /* Can a result of at least `bytes` bytes ever be kept? False with *error if not. Any thread may
     * call it, while the size of the result is still being computed. */
    bool (*may_need)(void *owner, size_t bytes, struct error *error);
    /* Makes what is reserved for the build's own work `bytes` bytes, until finished() is called; may evict
     * other assets. On the loop's thread; 0 never fails. */
    bool (*reserve_work)(void *owner, size_t bytes, struct error *error);
    /* Reserves `bytes` bytes until the result is destroyed; may evict other assets. Called once, on
     * the loop's thread, before the result is filled in. */
    bool (*reserve)(void *owner, size_t bytes, struct error *error);
    /* Called once at the end, on the loop's thread: with the result, or with NULL and the error. */
    void (*finished)(void *owner, void *result, const struct error *error);
    void *owner;
};

/* The bytes that a model with these tables takes, on the device and in main memory. */
size_t build_model_bytes(const struct build_order *order, const struct limit_tables *tables);
/* order->may_need() for a model with these tables and for `plan_bytes` more while it is built, and
 * order->reserve() for the model. Where a device that stores tables has no room for them, the error also
 * names the device that needs less. */
bool build_may_need_model(const struct build_order *order, const struct limit_tables *tables,
                          size_t plan_bytes, struct error *error);
bool build_reserve_model(const struct build_order *order, const struct limit_tables *tables,
                         struct error *error);

#endif
