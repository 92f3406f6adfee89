/* A light image on the GPU, decoded from an uploaded file. Thread: the loop's. */
#ifndef SHEEN_ASSETS_LIGHT_IMAGE_H
#define SHEEN_ASSETS_LIGHT_IMAGE_H

#include "server/assets/build.h"

struct light_image {
    struct image pixels;        /* stay as long as `gpu` */
    struct renderer_image *gpu; /* for the render thread only */
    size_t reserved_bytes;      /* what order->reserve() was asked for: its texels, in
                                   memory and on the GPU */
    struct task destroy_task;
};

/* Starts a build; finished() gets a `struct light_image *`. False, without finished(), when memory
 * is short. */
bool light_image_build_start(const struct build_order *order, struct error *error);

/* Frees the image once the render thread has let go of it, after all work submitted before. */
void light_image_destroy(struct light_image *image, struct render_thread *render_thread);

#endif
