/* Stages 1 and 2 on processors: draws a model's limit tables through a view into the planes that shaders/planes.glsl
 * describes, by vector code, without GL.
 *
 * A device has a team of threads that work on one frame at a time. A frame has the same bytes for any number of
 * threads and for any part of the picture that is drawn, except for pixels in gaps at the part's border (below).
 * Frames of two instruction sets differ like those of two devices.
 *
 * Thread: a device is called by one thread at a time; a model is drawn by one device at a time. */
#ifndef SHEEN_RENDER_NATIVE_NATIVE_H
#define SHEEN_RENDER_NATIVE_NATIVE_H

#include <stdbool.h>

#include "server/base/error.h"
#include "server/render/native/planes.h"
#include "server/render/view.h"

struct native_device;
struct native_programs; /* program.h */
struct native_frame;    /* frame.h */
struct native_set;      /* sets.h */
struct native_thread;   /* frame.h */
struct native_model;    /* patches.h */

struct native_options {
    unsigned n_threads; /* 1 to NATIVE_MAX_THREADS; 0: one for each available processor */
    const char *set;    /* "v2", "v3", "v4", "base"; NULL: the best of the processor */
};

/* NULL with ERROR_SERVER when memory or threads are short, with ERROR_DEVICE for a set that the processor does not
 * have. */
struct native_device *native_device_create(const struct native_options *options,
                                           struct error *error);
void native_device_destroy(struct native_device *device); /* NULL is safe */
/* The name of the instruction set: "AVX-512" and so on. */
const char *native_device_name(const struct native_device *device);
/* True if the last tile had more pixels in gaps than are solved, so that another cut into tiles may show more. */
bool native_device_left_gaps(const struct native_device *device);
/* The last frame; its threads still have its pieces. Valid as long as what native_draw() was given. */
const struct native_frame *native_device_drawn(const struct native_device *device);
unsigned native_device_threads(const struct native_device *device);
struct native_thread *native_device_thread(struct native_device *device, unsigned number);
const struct native_set *native_device_set(const struct native_device *device);
/* The programs made from shaders/, compiled for the device's instruction set. */
const struct native_programs *native_device_programs(const struct native_device *device);
/* Calls work(owner, number of the thread) on every thread of the device; returns when all have finished. */
void native_device_run(struct native_device *device, void (*work)(void *owner, unsigned number),
                       void *owner);
/* Calls work() for bands of a plane's rows, first to end - 1, on all threads; first is a multiple of NATIVE_BAND. */
enum { NATIVE_BAND = 32 };
void native_device_rows(struct native_device *device, uint32_t n_rows,
                        void (*work)(void *owner, uint32_t first, uint32_t end), void *owner);

/* Draws a tile, not empty and inside of the picture, whose sides are at most 65,535 px. A pixel that looks through a
 * gap narrower than itself (shaders/gaps.comp.glsl) is found only if its neighbours on both sides lie in the tile, so
 * tiles of a larger picture need a margin of one pixel. False with ERROR_REQUEST if the view needs too many vertices
 * (patch_grids.h), or with ERROR_SERVER when memory is short. `times` may be NULL. */
bool native_draw(struct native_device *device, struct native_model *model, const struct view *view,
                 const struct tile *tile, const struct native_planes *planes,
                 struct native_times *times, struct error *error);

#endif
