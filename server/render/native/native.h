/* Stages 1 and 2 on processors: from the limit tables of a model and a view to the planes that
 * shaders/planes.glsl describes, by vector code, without GL.
 *
 * A device has a team of threads that work on one frame at a time. Frames are the same bytes for
 * any number of threads, and for any part of the picture that is asked for, but for pixels in gaps
 * beside its border (below). Frames of two instruction sets agree as those of two devices do.
 *
 * Thread: one at a time calls a device; a model is drawn by one device at a time. */
#ifndef SHEEN_RENDER_NATIVE_NATIVE_H
#define SHEEN_RENDER_NATIVE_NATIVE_H

#include <stdbool.h>

#include "server/base/error.h"
#include "server/render/native/planes.h"
#include "server/render/view.h"

struct native_device;
struct native_programs; /* program.h */
struct native_set;      /* sets.h */
struct native_thread;   /* frame.h */
struct native_model;    /* patches.h */

struct native_options {
    unsigned n_threads; /* 1 to NATIVE_MAX_THREADS; 0: one for each processor that is available */
    const char *set;    /* "v2", "v3", "v4", "base"; NULL: the widest that the processor has */
};

/* NULL with ERROR_SERVER when memory or threads are short, ERROR_DEVICE for a set that the
 * processor lacks. */
struct native_device *native_device_create(const struct native_options *options,
                                           struct error *error);
void native_device_destroy(struct native_device *device); /* NULL is safe */
/* The instruction set: "AVX-512" and so on. */
const char *native_device_name(const struct native_device *device);
/* More pixels of what was drawn last looked through gaps than are solved, so that another cut into tiles may show
 * more there. */
bool native_device_left_gaps(const struct native_device *device);
unsigned native_device_threads(const struct native_device *device);
struct native_thread *native_device_thread(struct native_device *device, unsigned number);
const struct native_set *native_device_set(const struct native_device *device);
/* The programs made of shaders/, compiled for the device's instruction set. */
const struct native_programs *native_device_programs(const struct native_device *device);
/* Every thread of the device calls work(owner, its number); returns when all have come back. */
void native_device_run(struct native_device *device, void (*work)(void *owner, unsigned number),
                       void *owner);
/* The same for bands of a plane's rows: each is [first, end) and begins at a multiple of NATIVE_BAND. */
enum { NATIVE_BAND = 32 };
void native_device_rows(struct native_device *device, uint32_t n_rows,
                        void (*work)(void *owner, uint32_t first, uint32_t end), void *owner);

/* Draws a tile of the picture: not empty, inside the picture, which is at most 65,535 px wide and
 * high. A pixel that looks through a gap narrower than itself (shaders/gaps.comp.glsl) is found
 * where the pixels on both sides of it lie in the tile, so tiles of a larger picture need a margin
 * of a pixel. ERROR_REQUEST when the view takes too many vertices (patch_grids.h), ERROR_SERVER when
 * memory is short. `times` may be NULL. */
bool native_draw(struct native_device *device, struct native_model *model, const struct view *view,
                 const struct tile *tile, const struct native_planes *planes,
                 struct native_times *times, struct error *error);

#endif
