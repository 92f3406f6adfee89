/* What a device is: the functions behind renderer.h, and the heads of the objects that it makes.
 * Each device is a folder below this one that nobody else includes, but for its device.h, which
 * names its struct renderer_device. For devices and renderer.c alone.
 *
 * What every device may take for granted: requests have been checked (request_check.h), the planes
 * of a frame are there before begin(), and its state is dropped after its last step. What all
 * devices need stands beside this file: the choice of grids (patch_grids.h), tiles, the camera
 * (view.h), lights (light_block.h) and polygons (mesh.h).
 *
 * Threads: as renderer.h says. */
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

/* What the device keeps of a frame between two steps. The first member of a device's own struct. */
struct frame_state {
    /* Frees the state. Any thread, also after the renderer was destroyed. */
    void (*destroy)(struct frame_state *state);
};

/* The first member of a device's own struct; the same holds for models and images below. */
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
    bool on_demand; /* it takes tables on demand; else it needs stored ones */
    /* Fills in struct renderer, too. NULL on failure. */
    struct renderer *(*create)(const struct renderer_options *options, struct error *error);
    void (*destroy)(struct renderer *renderer); /* not NULL, as in the functions below */

    struct renderer_model *(*model_create)(struct renderer *renderer,
                                           const struct limit_tables *tables, struct error *error);
    void (*model_destroy)(struct renderer *renderer, struct renderer_model *model);

    /* The image is no larger than info.max_width_px and max_height_px. */
    struct renderer_image *(*image_create)(struct renderer *renderer, const struct image *image,
                                           struct error *error);
    void (*image_destroy)(struct renderer *renderer, struct renderer_image *image);

    size_t (*model_bytes)(const struct limit_tables *tables);
    size_t (*image_bytes)(const struct image *image);
    uint64_t (*paused_bytes)(uint32_t width_px, uint32_t height_px, uint64_t tile_px);

    /* Sets work->state, if there is to be one, and work->in_place. */
    bool (*begin)(struct renderer *renderer, struct frame_work *work, struct error *error);
    /* Sets work->has_drawn. What takes several steps, of whatever kind, is FRAME_MORE. */
    enum frame_step (*step)(struct renderer *renderer, struct renderer_model *model,
                            struct frame_work *work, struct frame *frame, struct error *error);
};

#endif
