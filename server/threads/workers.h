/* What sheend leaves to worker programs, whose processes are sandboxed: reading cages and images,
 * writing images, drawing text. Neither tinygltf nor OpenImageIO is in the daemon itself.
 *
 * What comes back has been checked as if a stranger had sent it. Each call blocks until it is done;
 * any thread may make it. */
#ifndef SHEEN_THREADS_WORKERS_H
#define SHEEN_THREADS_WORKERS_H

#include "server/cage/cage.h"
#include "server/image/image.h"
#include "server/threads/worker.h"
#include "server/base/block_cache.h"
#include "server/sandbox/image_code.h"

/* What a process may take of memory, beyond what it starts with; as much it may answer. Within the
 * memory budget, which counts for no less than the least, and within struct workers_limits. */
#define WORKERS_LEAST_MEMORY_BYTES (256ull << 20)
#define WORKERS_CAGE_MEMORY_PER_BYTE 24 /* of the file */
#define WORKERS_IMAGE_MEMORY_BYTES (IMAGE_MAX_BYTES + (512ull << 20))

/* What one process may take and how long; all of these are at least 1. */
struct workers_limits {
    uint64_t memory_bytes, output_bytes;
    uint64_t cpu_s, wall_s; /* of processors, and by the clock on the wall */
};

struct workers {
    struct worker *cages, *images;
    uint64_t budget_bytes, memory_bytes, output_bytes;
    unsigned cpu_s, wall_s; /* any thread, by __atomic_load_n() and __atomic_store_n() alone */
};

/* Finds sheend-cage and sheend-image in `folder`; NULL: in the folder of the running program, or in
 * ../libexec/sheen beside it; and starts the first. budget_bytes: of memory, for all that the
 * daemon holds. ERROR_SERVER on failure; workers_finish() is due in both cases. */
bool workers_init(struct workers *workers, const char *folder, const struct workers_limits *limits,
                  uint64_t budget_bytes, struct error *error);
/* Takes new times over, for jobs that begin from now on. */
void workers_set_times(struct workers *workers, const struct workers_limits *limits);
void workers_finish(struct workers *workers);
/* Starts the program for images and texts, of which one will come. To load its libraries keeps a
 * processor busy for 0.2 s, so a daemon that may be about to draw its first frame does not start it
 * before. */
void workers_expect_images(struct workers *workers);
/* As worker_stop(), for all. */
void workers_stop(struct workers *workers);

/* As cage_read(). */
bool workers_read_cage(struct workers *workers, struct cage *cage, const void *bytes, size_t size,
                       const char *name, struct error *error);
/* As image_decode(). */
bool workers_read_image(struct workers *workers, struct image *image, const void *bytes,
                        size_t size, const char *name, uint32_t max_px, struct error *error);
/* As image_encode(); the picture's channels lie in the blocks. The bytes are of `block_cache`. */
bool workers_write_image(struct workers *workers, const struct picture *picture,
                         const struct picture_block *blocks, size_t n_blocks,
                         struct block_cache *block_cache, uint8_t **bytes, size_t *size,
                         struct error *error);
/* As text_create(), but that the mask is of `block_cache`. */
bool workers_draw_text(struct workers *workers, struct block_cache *block_cache, struct text *text,
                       const char *line, int size_px, struct error *error);

#endif
