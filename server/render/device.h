/* The interface between renderer.c and a device: the functions behind renderer.h, and the base
 * structs of the objects that a device makes. Each device is a folder below this one. Nobody else
 * includes its files, except its device.h, which declares its struct renderer_device. Only devices
 * and renderer.c include this file.
 *
 * A device can rely on this: requests have been checked (request_check.h), a frame's planes exist
 * before begin(), and the frame's state is destroyed after its last step. What all devices need is
 * in this folder: the choice of grids (patch_grids.h), tiles, the camera (view.h), lights
 * (light_block.h) and polygons (mesh.h).
 *
 * Threads: as in renderer.h. */
#ifndef SHEEN_RENDER_DEVICE_H
#define SHEEN_RENDER_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/image/image.h"
#include "server/render/frame_work.h"
#include "server/render/renderer_options.h"
#include "server/scene/frame.h"
#include "server/surface/tables.h"

/* What a device keeps of a frame between two steps: the first member of the device's own struct. */
struct frame_state {
    /* Frees the state. Any thread, also after the renderer was destroyed. */
    void (*destroy)(struct frame_state *state);
};

/* These are the first members of a device's own structs. */
struct renderer {
    const struct renderer_device *device;
    struct renderer_info info;
    struct renderer_options options;
};
struct renderer_model {
    const struct limit_tables *tables;
};
struct renderer_image {
    const struct image *pixels;
};

struct renderer_device {
    bool on_demand; /* takes tables on demand; else needs stored tables */
    /* Also fills in struct renderer. NULL on failure. */
    struct renderer *(*create)(const struct renderer_options *options, struct error *error);
    void (*destroy)(struct renderer *renderer); /* arguments are not NULL, here and below */

    struct renderer_model *(*model_create)(struct renderer *renderer,
                                           const struct limit_tables *tables, struct error *error);
    void (*model_destroy)(struct renderer *renderer, struct renderer_model *model);

    /* The image is at most info.max_width_px by max_height_px. */
    struct renderer_image *(*image_create)(struct renderer *renderer, const struct image *image,
                                           struct error *error);
    void (*image_destroy)(struct renderer *renderer, struct renderer_image *image);

    /* Memory in bytes, as the functions renderer_..._bytes() of renderer.h tell it. */
    size_t (*model_bytes)(const struct limit_tables *tables);
    size_t (*image_bytes)(const struct image *image);
    uint64_t (*frame_bytes)(const struct renderer_frame_size *size);
    uint64_t (*paused_bytes)(uint32_t width_px, uint32_t height_px, uint64_t tile_px);

    struct renderer_held (*held)(const struct renderer *renderer);
    void (*drop_held)(struct renderer *renderer);

    /* Sets work->state, if the device needs one, and work->in_place. */
    bool (*begin)(struct renderer *renderer, struct frame_work *work, struct error *error);
    /* Sets work->has_drawn. Work that takes several steps, of whatever kind, returns FRAME_MORE. */
    enum frame_step (*step)(struct renderer *renderer, struct renderer_model *model,
                            struct frame_work *work, struct frame *frame, struct error *error);
};

#endif
