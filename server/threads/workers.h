/* The work that sheend does in worker programs with sandboxed processes: reading cages and images,
 * writing images. So tinygltf and OpenImageIO are not in the daemon itself.
 *
 * All results are checked as if a stranger had sent them.
 * Thread: any. Each call blocks until it is done. */
#ifndef SHEEN_THREADS_WORKERS_H
#define SHEEN_THREADS_WORKERS_H

#include <pthread.h>

#include "server/cage/cage.h"
#include "server/image/image.h"
#include "server/threads/worker.h"
#include "server/base/block_cache.h"
#include "server/sandbox/image_code.h"

/* Memory that the process of a job may use in addition to what it holds at its start; its answer
 * may have the same size. It is limited by the memory budget, but never below the least, and by
 * struct workers_limits. */
#define WORKERS_LEAST_MEMORY_BYTES (256ull << 20)
#define WORKERS_CAGE_MEMORY_PER_BYTE 24 /* bytes for each byte of the file */
#define WORKERS_IMAGE_MEMORY_BYTES (IMAGE_MAX_BYTES + (512ull << 20))

/* The limits of one process; all are at least 1. */
struct workers_limits {
    uint64_t memory_bytes, output_bytes;
    uint64_t cpu_s, wall_s; /* processor time and elapsed time, in seconds */
};

struct workers {
    struct worker *cages, *images;
    pthread_mutex_t lock; /* of the next three */
    pthread_cond_t ended; /* a job has */
    unsigned n_jobs, most_jobs;
    uint64_t budget_bytes, memory_bytes, output_bytes;
    /* Read and written by any thread, only by __atomic_load_n() and __atomic_store_n(). */
    unsigned cpu_s, wall_s;
};

/* Finds the programs sheend-cage and sheend-image in `folder`, or, if that is NULL, in the folder
 * of the running program or in ../libexec/sheen beside it; starts sheend-cage. budget_bytes is the
 * daemon's memory budget. False with ERROR_SERVER on failure. Call workers_finish() in both
 * cases. */
bool workers_init(struct workers *workers, const char *folder, const struct workers_limits *limits,
                  uint64_t budget_bytes, struct error *error);
/* Sets new limits of time, for jobs that begin from now on. */
void workers_set_times(struct workers *workers, const struct workers_limits *limits);
void workers_finish(struct workers *workers);
/* Starts the program for images, because such a job will come. Loading its libraries
 * keeps a processor busy for 0.2 s, so a daemon that is about to draw its first frame does not
 * start it earlier. */
void workers_expect_images(struct workers *workers);
/* At most so many jobs run at once from now on (at least 1); others wait. */
void workers_limit_jobs(struct workers *workers, unsigned most);
/* NULL if both programs are well, else one line for health checks: which is not, and why. */
const char *workers_trouble(struct workers *workers);
/* Can one of the programs not be started again? A daemon that is confined cannot mend this. */
bool workers_are_lost(struct workers *workers);
/* worker_stop() for both programs. */
void workers_stop(struct workers *workers);

/* cage_read() in a worker. */
bool workers_read_cage(struct workers *workers, struct cage *cage, const void *bytes, size_t size,
                       const char *name, struct error *error);
/* An image file for a worker. max_px: the largest side that is taken. */
struct workers_image {
    const void *bytes;
    size_t n_bytes;
    const char *name;
    uint32_t max_px;
};
/* image_measure() in a worker. */
bool workers_measure_image(struct workers *workers, struct image *size,
                           const struct workers_image *file, struct error *error);
/* image_decode() in a worker, which cannot hand back more than max_bytes bytes of pixels. */
bool workers_read_image(struct workers *workers, struct image *image,
                        const struct workers_image *file, uint64_t max_bytes, struct error *error);
/* image_encode() in a worker. The picture's channels lie in the blocks. *bytes is from
 * `block_cache` and owned by the caller. */
bool workers_write_image(struct workers *workers, const struct picture *picture,
                         const struct picture_block *blocks, size_t n_blocks,
                         struct block_cache *block_cache, uint8_t **bytes, size_t *size,
                         struct error *error);
#endif
