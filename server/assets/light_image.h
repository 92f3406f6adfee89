/* A light image: pixels decoded from an uploaded file, and their copy on the device.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_LIGHT_IMAGE_H
#define SHEEN_ASSETS_LIGHT_IMAGE_H

#include "server/assets/build.h"

struct light_image {
    struct image pixels;        /* must stay valid as long as `gpu` */
    struct renderer_image *gpu; /* use it on the render thread only */
    /* Bytes reserved by order->reserve(): the texels in main memory and on the device. */
    size_t reserved_bytes;
    struct task destroy_task;
};

/* Starts a build; its finished() gets a `struct light_image *`. False with *error when memory is
 * short; then finished() is not called. */
bool light_image_build_start(const struct build_order *order, struct error *error);

/* Frees the image on the render thread, after all work submitted before. */
void light_image_destroy(struct light_image *image, struct render_thread *render_thread);

#endif
