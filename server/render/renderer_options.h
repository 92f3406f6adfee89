/* How a device is opened, and what it says of itself. */
#ifndef SHEEN_RENDER_RENDERER_OPTIONS_H
#define SHEEN_RENDER_RENDERER_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/block_cache.h"

struct renderer_options {
    const char *device; /* which of the machine's, in words that the kind of device knows */
    /* Of the native device. */
    unsigned n_threads; /* 1 to RENDERER_MAX_THREADS; 0: one for each processor that is available */
    const char *isa;    /* "v2", "v3" or "v4" of x86-64; NULL: the widest that the processor has */
    /* Called on the render thread whenever the device is lost, and for every try to open it again
     * that fails. NULL: nobody is told. */
    void (*lost)(void *owner);
    void *owner;
    struct block_cache *block_cache; /* memory of frames, which outlives them; NULL: malloc's */
    /* For tests. */
    size_t max_texels; /* pretend that the device's tables hold no more; 0: ask the device */
    size_t slice;      /* triangles of polygons drawn a step, about; 0: by the device */
    bool device_times; /* frame_times by the device's own clock on a software device, too */
};
#define RENDERER_NAME_BYTES 256
#define RENDERER_MAX_THREADS 64

/* What the device is, in its own words. Strings live as long as the renderer. */
struct renderer_info {
    const char *device, *driver;
    bool software;        /* it computes on the machine's processors */
    unsigned n_threads;   /* of the native device; 0: a GPU, or a driver that does not say */
    bool timed_by_device; /* frame_times are its own, not the clock's */
    uint32_t max_width_px, max_height_px;
};

#endif
