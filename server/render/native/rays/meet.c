#include "server/render/native/native.h"
#include "server/render/native/rays/rays.h"

enum { COLUMNS = 1024 };
/* A number below COLUMNS by which pixels are sorted. */
static uint32_t column_of(uint32_t listed, uint32_t origin, int shift)
{
    return ((listed & 0x7fffffff) + origin) >> shift & (COLUMNS - 1);
}

static void sort_by(const uint32_t *from, uint32_t n, uint32_t origin, int shift, uint32_t *to)
{
    uint32_t first[COLUMNS + 1] = {0};
    for (uint32_t i = 0; i < n; i++)
        first[column_of(from[i], origin, shift) + 1]++;
    for (int k = 0; k < COLUMNS; k++)
        first[k + 1] += first[k];
    for (uint32_t i = 0; i < n; i++)
        to[first[column_of(from[i], origin, shift)]++] = from[i];
}

void native_sort_pixels(uint32_t *pixel, uint32_t n, const struct tile *tile, uint32_t *room)
{
    uint32_t origin = tile->x % TILE_WIDTH | tile->y % TILE_HEIGHT << 16;
    sort_by(pixel, n, origin, 5, room);
    sort_by(room, n, origin, 16 + 5, pixel);
    sort_by(pixel, n, origin, 7, room);
    sort_by(room, n, origin, 16 + 7, pixel);
}

/* Each thread takes pixels about TURNS times, at least LEAST_PX, so that none waits long for the last pixels of another.
 * Each time it passes over the vertices of all pieces in the tile: over TURNS_VERTICES in all, or once. */
enum { TURNS = 8, LEAST_PX = 32, TURNS_VERTICES = 1 << 23 };

uint32_t native_pixels_at_once(uint32_t n, unsigned threads, uint64_t n_vertices)
{
    uint64_t turns = n_vertices ? TURNS_VERTICES / n_vertices : TURNS;
    turns = turns < 1 ? 1 : turns < TURNS ? turns : TURNS;
    uint32_t at_once = n / ((uint32_t)turns * threads) + LEAST_PX;
    return at_once < RAYS_PX ? at_once : RAYS_PX;
}

struct rounded_job {
    struct native_device *device;
    const struct native_frame *frame;
    const struct native_rounded *rounded;
    uint32_t next, at_once; /* pixels */
    bool out_of_memory;
};

/* The first pixel after `first` that lies in another tile, or `end`. */
static uint32_t end_of_tile(const struct rounded_job *job, uint32_t first, uint32_t end)
{
    uint32_t pixel, tile = native_listed_tile(job->frame, job->rounded->pixel[first], &pixel), i;
    for (i = first + 1; i < end; i++)
        if (native_listed_tile(job->frame, job->rounded->pixel[i], &pixel) != tile)
            break;
    return i;
}

static void meet_rounded(void *owner, unsigned number)
{
    struct rounded_job *job = owner;
    struct native_thread *thread = native_device_thread(job->device, number);
    native_forget_patches(thread);
    native_forget_ray_patches(thread->rays);
    for (uint32_t first, end; (first = __atomic_fetch_add(&job->next, job->at_once,
                                                          __ATOMIC_RELAXED)) < job->rounded->n;) {
        uint32_t left = job->rounded->n - first;
        for (end = first + (left < job->at_once ? left : job->at_once); first < end;) {
            uint32_t next = end_of_tile(job, first, end);
            if (!native_meet_pixels(job->frame, thread, job->rounded, first, next - first))
                __atomic_store_n(&job->out_of_memory, true, __ATOMIC_RELAXED);
            first = next;
        }
    }
}

bool native_meet_rounded(struct native_device *device, const struct native_rounded *rounded,
                         struct error *error)
{
    struct rounded_job job = {
        .device = device, .frame = native_device_drawn(device), .rounded = rounded};
    if (!rounded->n || !rounded->side)
        return true;
    for (unsigned i = 0; i < native_device_threads(device); i++) {
        struct native_thread *thread = native_device_thread(device, i);
        if (!thread->rays)
            thread->rays = native_allocate(sizeof *thread->rays);
        if (!thread->rays)
            return error_set(error, ERROR_SERVER, "out of memory for the rays of pixels");
    }
    uint64_t n_tiles = (uint64_t)job.frame->tiles_x * job.frame->tiles_y;
    job.at_once = native_pixels_at_once(rounded->n, native_device_threads(device),
                                        job.frame->n_vertices / n_tiles);
    native_device_run(device, meet_rounded, &job);
    return !job.out_of_memory ||
           error_set(error, ERROR_SERVER, "out of memory for the rays of pixels");
}
