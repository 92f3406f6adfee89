/* The options with which a device is opened, and its description of itself. */
#ifndef SHEEN_RENDER_RENDERER_OPTIONS_H
#define SHEEN_RENDER_RENDERER_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/block_cache.h"

struct renderer_options {
    /* Which one of the machine's devices, in words that this kind of device knows. */
    const char *device;
    /* For the native device: */
    unsigned n_threads; /* 1 to RENDERER_MAX_THREADS; 0: one for each available processor */
    const char *isa;    /* x86-64 level "v2", "v3" or "v4"; NULL: the best of the processor */
    /* Called on the render thread whenever the device is lost, and whenever opening it again fails.
     * May be NULL. */
    void (*lost)(void *owner);
    /* Called on any thread, until the renderer is destroyed, when frames that wait after
     * FRAME_PROGRAMS may continue. It must not call the renderer. NULL: a step waits itself, and
     * never returns FRAME_PROGRAMS. */
    void (*woken)(void *owner);
    /* Called on a thread of the device when it begins to make a program, and when it has ended, until the
     * renderer is destroyed. May be NULL. */
    void (*compiling)(void *owner, bool begins);
    void *owner;
    bool warm_up; /* prepare for usual frames while no frame waits for programs */
    struct block_cache *block_cache; /* memory of frames, outlives them; NULL: malloc() */
    /* For tests: */
    /* Pretend that the device's tables have at most so many texels; 0: ask the device. */
    size_t max_texels;
    size_t slice;      /* about the number of triangles of polygons in a step; 0: by the device */
    bool device_times; /* measure frame_times by the device's own clock on a software device, too */
};
#define RENDERER_NAME_BYTES 256
#define RENDERER_MAX_THREADS 64

/* A device's description of itself. The strings live as long as the renderer. */
struct renderer_info {
    const char *device, *driver;
    bool software;        /* computes on the machine's processors */
    unsigned n_threads;   /* threads of the native device; 0: another device */
    bool timed_by_device; /* frame_times are measured by the device, not by the clock */
    uint32_t max_width_px, max_height_px;
    /* What the driver takes in bytes for the programs of usual frames, after the device is open. */
    uint64_t usual_programs_bytes;
};

/* The memory in bytes that a device holds now, and may hold on to. */
struct renderer_held {
    uint64_t frames;   /* to draw on, and kept views */
    uint64_t programs; /* of the driver, for programs beyond those of usual frames */
};

/* What the memory for a frame depends on. */
struct renderer_frame_size {
    uint32_t width_px, height_px;
    bool is_part;     /* of a picture, which is drawn with a margin (struct camera_window) */
    uint64_t tile_px; /* of struct frame_work, as the next */
    bool in_place;
    bool several_lights;
    bool measures; /* planes of lights or curvature */
};

#endif
