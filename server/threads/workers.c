#include "server/threads/workers.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "server/sandbox/cage_code.h"
#include "server/threads/pool.h"

/* --- the programs */

/* Gets the folder of the running program, with the last '/'. */
static bool own_folder(char path[static WORKER_PATH_BYTES])
{
    ssize_t n = readlink("/proc/self/exe", path, WORKER_PATH_BYTES - 1);
    if (n <= 0)
        return false;
    path[n] = 0;
    char *slash = strrchr(path, '/');
    if (slash)
        slash[1] = 0;
    return slash != NULL;
}

static bool find_program(const char *folder, const char *name, char path[static WORKER_PATH_BYTES],
                         struct error *error)
{
    char own[WORKER_PATH_BYTES];
    int n = -1;
    if (folder) {
        n = snprintf(path, WORKER_PATH_BYTES, "%s/%s", folder, name);
    } else if (own_folder(own)) {
        n = snprintf(path, WORKER_PATH_BYTES, "%s%s", own, name);
        if (n < WORKER_PATH_BYTES && access(path, X_OK) < 0)
            n = snprintf(path, WORKER_PATH_BYTES, "%s../libexec/sheen/%s", own, name);
    }
    if (n < 0 || n >= WORKER_PATH_BYTES || access(path, X_OK) < 0)
        return error_set(error, ERROR_SERVER,
                         "cannot find %s, which belongs beside sheend or into ../libexec/sheen: "
                         "install sheen as a whole",
                         name);
    return true;
}

static struct worker *create(const char *folder, const char *name, struct error *error)
{
    char path[WORKER_PATH_BYTES];
    return find_program(folder, name, path, error) ? worker_create(path, error) : NULL;
}

void workers_set_times(struct workers *workers, const struct workers_limits *limits)
{
    __atomic_store_n(&workers->cpu_s, (unsigned)limits->cpu_s, __ATOMIC_RELAXED);
    __atomic_store_n(&workers->wall_s, (unsigned)limits->wall_s, __ATOMIC_RELAXED);
}

bool workers_init(struct workers *workers, const char *folder, const struct workers_limits *limits,
                  uint64_t budget_bytes, struct error *error)
{
    workers->images = NULL;
    pthread_mutex_init(&workers->lock, NULL);
    pthread_cond_init(&workers->ended, NULL);
    workers->most_jobs = UINT_MAX;
    workers->budget_bytes =
        budget_bytes > WORKERS_LEAST_MEMORY_BYTES ? budget_bytes : WORKERS_LEAST_MEMORY_BYTES;
    workers->memory_bytes = limits->memory_bytes;
    workers->output_bytes = limits->output_bytes;
    workers_set_times(workers, limits);
    return (workers->cages = create(folder, "sheend-cage", error)) &&
           (workers->images = create(folder, "sheend-image", error)) &&
           worker_wake(workers->cages, error);
}

void workers_expect_images(struct workers *workers)
{
    struct error ignored = {0}; /* the job itself will report the error */
    worker_wake(workers->images, &ignored);
}

void workers_finish(struct workers *workers)
{
    worker_destroy(workers->cages);
    worker_destroy(workers->images);
    workers->cages = workers->images = NULL;
}

void workers_stop(struct workers *workers)
{
    worker_stop(workers->cages);
    worker_stop(workers->images);
}

const char *workers_trouble(struct workers *workers)
{
    static const char *const texts[2][3] = {
        {NULL, "sheend-cage does not answer: it will be started again",
         "sheend-cage cannot be started any more, so no new model is read: the daemon ends, for "
         "another to start"},
        {NULL, "sheend-image does not answer: it will be started again",
         "sheend-image cannot be started any more, so no image, EXR or TIFF is read or written: "
         "the daemon ends, for another to start"}};
    const enum worker_health cages = worker_health(workers->cages);
    return cages != WORKER_WELL ? texts[0][cages] : texts[1][worker_health(workers->images)];
}

bool workers_are_lost(struct workers *workers)
{
    return worker_health(workers->cages) == WORKER_LOST ||
           worker_health(workers->images) == WORKER_LOST;
}

void workers_limit_jobs(struct workers *workers, unsigned most)
{
    pthread_mutex_lock(&workers->lock);
    workers->most_jobs = most;
    pthread_mutex_unlock(&workers->lock);
}

/* --- the jobs */

/* Waits until the job may run, and makes its files. Call end_job() in any case. */
static bool begin_job(struct workers *workers, struct worker_call *call, struct worker *lender,
                      struct error *error)
{
    pthread_mutex_lock(&workers->lock);
    while (workers->n_jobs >= workers->most_jobs) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_sec++;
        pool_beat(); /* the thread waits, and is not stuck */
        pthread_cond_timedwait(&workers->ended, &workers->lock, &until);
    }
    workers->n_jobs++;
    pthread_mutex_unlock(&workers->lock);
    return lender ? worker_call_init_lent(call, lender, error) : worker_call_init(call, error);
}

static void end_job(struct workers *workers, struct worker_call *call)
{
    worker_call_finish(call);
    pthread_mutex_lock(&workers->lock);
    workers->n_jobs--;
    pthread_cond_signal(&workers->ended);
    pthread_mutex_unlock(&workers->lock);
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static struct job_limits limits_of(struct workers *workers, uint64_t memory_bytes)
{
    return (struct job_limits){
        .memory_bytes = least(memory_bytes, workers->memory_bytes),
        .answer_bytes = least(memory_bytes, workers->output_bytes),
        .cpu_s = __atomic_load_n(&workers->cpu_s, __ATOMIC_RELAXED),
        .wall_s = __atomic_load_n(&workers->wall_s, __ATOMIC_RELAXED),
    };
}

/* The limits of a job whose input comes from a client. */
static struct job_limits limits_within_budget(struct workers *workers, uint64_t memory_bytes)
{
    return limits_of(workers, least(memory_bytes, workers->budget_bytes));
}

bool workers_read_cage(struct workers *workers, struct cage *cage, const void *bytes, size_t size,
                       const char *name, struct error *error)
{
    const struct job_limits limits = limits_within_budget(
        workers, WORKERS_LEAST_MEMORY_BYTES + (uint64_t)size * WORKERS_CAGE_MEMORY_PER_BYTE);
    struct worker_call call;
    *cage = (struct cage){0};
    bool ok = begin_job(workers, &call, NULL, error);
    if (ok)
        job_write_file(&call.input, name, bytes, size);
    ok = ok &&
         worker_run(workers->cages, &call, JOB_READ_CAGE, &limits, name, ERROR_MODEL, error) &&
         cage_take(&call.answer, cage, name, error);
    end_job(workers, &call);
    return ok;
}

/* Runs a job that reads an image file. Call end_job() in any case. */
static bool run_image_job(struct workers *workers, struct worker_call *call, enum job_kind kind,
                          const struct job_limits *limits, const struct workers_image *file,
                          struct error *error)
{
    if (!begin_job(workers, call, NULL, error))
        return false;
    sink_u32(&call->input, file->max_px);
    job_write_file(&call->input, file->name, file->bytes, file->n_bytes);
    return worker_run(workers->images, call, kind, limits, file->name, ERROR_IMAGE, error);
}

bool workers_measure_image(struct workers *workers, struct image *size,
                           const struct workers_image *file, struct error *error)
{
    const struct job_limits limits = limits_within_budget(workers, WORKERS_IMAGE_MEMORY_BYTES);
    struct worker_call call;
    *size = (struct image){0};
    bool ok = run_image_job(workers, &call, JOB_MEASURE_IMAGE, &limits, file, error) &&
              image_size_take(&call.answer, size, file->name, file->max_px, error);
    end_job(workers, &call);
    return ok;
}

bool workers_read_image(struct workers *workers, struct image *image,
                        const struct workers_image *file, uint64_t max_bytes, struct error *error)
{
    enum { BESIDE_PIXELS = 4096 }; /* the status and the sides */
    struct job_limits limits = limits_within_budget(workers, WORKERS_IMAGE_MEMORY_BYTES);
    limits.answer_bytes = least(limits.answer_bytes, max_bytes + BESIDE_PIXELS);
    struct worker_call call;
    *image = (struct image){0};
    bool ok = run_image_job(workers, &call, JOB_READ_IMAGE, &limits, file, error) &&
              image_take(&call.answer, image, file->name, file->max_px, error);
    end_job(workers, &call);
    return ok;
}

/* Copies the rest of an answer. */
static bool take_file(struct source *answer, struct block_cache *block_cache, uint8_t **bytes,
                      size_t *size, struct error *error)
{
    *size = answer->left;
    *bytes = block_cache_take(block_cache, *size);
    if (!*bytes)
        return error_set(error, ERROR_SERVER, "no memory for a file of %zu bytes: try again later",
                         *size);
    memcpy(*bytes, source_bytes(answer, *size), *size);
    return true;
}

bool workers_write_image(struct workers *workers, const struct picture *picture,
                         const struct picture_block *blocks, size_t n_blocks,
                         struct block_cache *block_cache, uint8_t **bytes, size_t *size,
                         struct error *error)
{
    uint64_t memory_bytes = WORKERS_LEAST_MEMORY_BYTES;
    for (size_t i = 0; i < n_blocks; i++)
        /* For the file as it grows, and a copy of it. */
        memory_bytes += 4 * (uint64_t)blocks[i].size;
    const struct job_limits limits = limits_of(workers, memory_bytes);
    struct worker_call call;
    *bytes = NULL;
    *size = 0;
    bool ok = begin_job(workers, &call, workers->images, error);
    if (ok)
        picture_write(&call.input, picture, blocks, n_blocks);
    ok = ok &&
         worker_run(workers->images, &call, JOB_WRITE_IMAGE, &limits, "the picture", ERROR_IMAGE,
                    error) &&
         take_file(&call.answer, block_cache, bytes, size, error);
    end_job(workers, &call);
    return ok;
}
