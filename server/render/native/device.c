#include "server/render/native/device.h"

#include <stdio.h>
#include <stdlib.h>

#include "server/render/native/device_internal.h"
#include "server/render/native/frame/memory.h"
#include "server/render/native/patches.h"

/* Largest side of a picture: no table of the device is longer. */
enum { MAX_SIDE_PX = 32768 };

static void destroy(struct renderer *renderer)
{
    struct native_renderer *r = native_renderer_of(renderer);
    native_device_destroy(r->device);
    for (int i = 0; i < NATIVE_PLANES; i++)
        native_target_finish(&r->planes[i].target);
    native_polygon_stage_finish(&r->polygons);
    native_meshes_finish(&r->meshes);
    free(r);
}

static struct renderer *create(const struct renderer_options *options, struct error *error)
{
    struct native_renderer *r = calloc(1, sizeof *r);
    if (!r) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    const struct native_options chosen = {.n_threads = options->n_threads, .set = options->isa};
    r->device = native_device_create(&chosen, error);
    if (!r->device) {
        free(r);
        return NULL;
    }
    snprintf(r->name, sizeof r->name, "native %s", native_device_name(r->device));
    r->base = (struct renderer){.device = &native_renderer_device,
                                .options = *options,
                                .info = {.device = r->name,
                                         .driver = "sheen " SHEEN_VERSION,
                                         .software = true,
                                         .n_threads = native_device_threads(r->device),
                                         .max_width_px = MAX_SIDE_PX,
                                         .max_height_px = MAX_SIDE_PX}};
    return &r->base;
}

static struct renderer_model *model_create(struct renderer *renderer,
                                           const struct limit_tables *tables, struct error *error)
{
    struct native_renderer *r = native_renderer_of(renderer);
    struct native_shown *shown = calloc(1, sizeof *shown);
    if (!shown) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    shown->base.tables = tables;
    shown->serial = ++r->next_serial;
    shown->model = native_model_create(tables, NATIVE_PATCH_BYTES, error);
    if (shown->model)
        return &shown->base;
    free(shown);
    return NULL;
}

static void model_destroy(struct renderer *renderer, struct renderer_model *model)
{
    struct native_shown *shown = (struct native_shown *)(void *)model;
    native_meshes_forget(&native_renderer_of(renderer)->meshes, shown->serial);
    native_model_destroy(shown->model);
    free(shown);
}

static size_t model_bytes(const struct limit_tables *tables)
{
    return native_model_most_bytes(tables, NATIVE_PATCH_BYTES);
}

const struct renderer_device native_renderer_device = {
    .on_demand = true,
    .create = create,
    .destroy = destroy,
    .model_create = model_create,
    .model_destroy = model_destroy,
    .image_create = native_image_create,
    .image_destroy = native_image_destroy,
    .model_bytes = model_bytes,
    .image_bytes = native_image_bytes,
    .frame_bytes = native_frame_bytes,
    .paused_bytes = native_frame_paused_bytes,
    .held = native_frame_held,
    .drop_held = native_frame_drop_held,
    .begin = native_frame_begin,
    .step = native_frame_step,
};
