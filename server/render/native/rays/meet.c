#include "server/render/native/native.h"
#include "server/render/native/rays/rays.h"

/* Sorts by columns or rows of squares, of which there are 1,024. */
static void sort_by(const uint32_t *from, uint32_t n, int shift, uint32_t *to)
{
    enum { COLUMNS = 1024 };
    uint32_t first[COLUMNS + 1] = {0};
    for (uint32_t i = 0; i < n; i++)
        first[(from[i] >> shift & (COLUMNS - 1)) + 1]++;
    for (int k = 0; k < COLUMNS; k++)
        first[k + 1] += first[k];
    for (uint32_t i = 0; i < n; i++)
        to[first[from[i] >> shift & (COLUMNS - 1)]++] = from[i];
}

void native_sort_pixels(uint32_t *pixel, uint32_t n, uint32_t *room)
{
    enum { SIDE_BITS = 6 };
    sort_by(pixel, n, SIDE_BITS, room);
    sort_by(room, n, 16 + SIDE_BITS, pixel); /* pixels at edges come last */
}

/* Each thread takes pixels about TURNS times, at least LEAST_PX. */
enum { TURNS = 8, LEAST_PX = 32 };

struct rounded_job {
    struct native_device *device;
    struct native_frame frame;
    const struct native_rounded *rounded;
    uint32_t next, at_once; /* pixels */
};

static void meet_rounded(void *owner, unsigned number)
{
    struct rounded_job *job = owner;
    struct native_thread *thread = native_device_thread(job->device, number);
    native_forget_patches(thread);
    native_forget_ray_patches(thread->rays);
    for (uint32_t first, left; (first = __atomic_fetch_add(&job->next, job->at_once,
                                                           __ATOMIC_RELAXED)) < job->rounded->n;) {
        left = job->rounded->n - first;
        native_meet_pixels(&job->frame, thread, job->rounded, first,
                           left < job->at_once ? left : job->at_once);
    }
}

bool native_meet_rounded(struct native_device *device, struct native_model *model,
                         const struct view *view, const struct tile *tile,
                         const struct native_planes *planes, const struct native_rounded *rounded,
                         struct error *error)
{
    struct rounded_job job = {.device = device,
                              .frame = {.model = model,
                                        .set = native_device_set(device),
                                        .view = view,
                                        .tile = *tile,
                                        .planes = planes},
                              .rounded = rounded};
    if (!rounded->n || !rounded->side)
        return true;
    for (unsigned i = 0; i < native_device_threads(device); i++) {
        struct native_thread *thread = native_device_thread(device, i);
        if (!thread->rays)
            thread->rays = native_allocate(sizeof *thread->rays);
        if (!thread->rays)
            return error_set(error, ERROR_SERVER, "out of memory for the rays of pixels");
    }
    /* Few enough that no thread waits long for the last pixels of another. */
    job.at_once = rounded->n / (TURNS * native_device_threads(device)) + LEAST_PX;
    job.at_once = job.at_once < RAYS_PX ? job.at_once : RAYS_PX;
    native_rays_init(&job.frame.rays, view);
    native_device_run(device, meet_rounded, &job);
    return true;
}
