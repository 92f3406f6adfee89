/* The objects of the native device behind renderer.h. Internal to the folder; render thread only. */
#ifndef SHEEN_RENDER_NATIVE_DEVICE_INTERNAL_H
#define SHEEN_RENDER_NATIVE_DEVICE_INTERNAL_H

#include "server/render/device.h"
#include "server/render/kept_view.h"
#include "server/render/native/native.h"
#include "server/render/native/polygons/meshes.h"
#include "server/render/native/polygons/fill.h"
#include "server/render/native/programs/program.h"
#include "server/render/native/target.h"
#include "server/render/tiles.h"

/* A model as renderer.h passes it. */
struct native_shown {
    struct renderer_model base;
    struct native_model *model;
    uint64_t serial; /* unique in the renderer */
};

/* A target, and the view that its planes hold. */
struct native_view_planes {
    struct native_target target;
    struct kept_view kept;
};

/* Which planes a frame is drawn into. There are several, so that a frame of one kind does not overwrite planes that
 * are kept for another. */
enum native_planes_of {
    NATIVE_WHOLE, /* the last frame drawn in one tile; kept */
    NATIVE_SMALL, /* the last such frame with few pixels; kept */
    NATIVE_TILED, /* the last frame in several tiles in_place, collected tile by tile; kept */
    NATIVE_APART, /* one tile of several, never kept */
    NATIVE_PLANES
};

struct native_renderer {
    struct renderer base;
    char name[RENDERER_NAME_BYTES];
    struct native_device *device;
    struct native_view_planes planes[NATIVE_PLANES];
    /* native_frame_state.serial of the frame whose tiles so far are all in NATIVE_TILED; 0: none. */
    uint64_t collecting;
    struct native_polygon_stage polygons;
    struct native_meshes meshes;
    uint64_t next_serial, n_begun; /* serials: of the next model; number of frames begun */
};

/* A light image as renderer.h passes it. */
struct native_light_image {
    struct renderer_image base;
    struct native_picture picture;
    float *texels;
};

static inline struct native_renderer *native_renderer_of(struct renderer *renderer)
{
    return (struct native_renderer *)(void *)renderer;
}

/* begin() and step() of struct renderer_device. */
bool native_frame_begin(struct renderer *renderer, struct frame_work *work, struct error *error);
enum frame_step native_frame_step(struct renderer *renderer, struct renderer_model *model,
                                  struct frame_work *work, struct frame *frame,
                                  struct error *error);

struct renderer_image *native_image_create(struct renderer *renderer, const struct image *image,
                                           struct error *error);
void native_image_destroy(struct renderer *renderer, struct renderer_image *image);
size_t native_image_bytes(const struct image *image);

#endif
