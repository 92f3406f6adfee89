/* The images and the lists of pixels that a tile is drawn into, kept for the next one. Names of GL
 * objects; a target of all zero has none. GL thread. */
#ifndef SHEEN_RENDER_GL_TARGET_H
#define SHEEN_RENDER_GL_TARGET_H

#include <epoxy/gl.h>

#include "server/base/error.h"
#include "server/render/device.h"
#include "server/render/tiles.h"

/* A list of pixels on the device, a head before its entries; and what is known of a rounded pixel's
 * 16 rays (shaders/list.glsl, rounded.glsl). */
enum { LIST_BYTES = 4, LIST_HEAD_BYTES = 16, ROUNDED_BYTES = 512 };

/* Workgroups of a row: a device takes a limited number in one dimension (65,535 at least), so
 * dispatches over more go in rows (ROW of shaders/list.glsl). */
enum { GROUP_ROW = 32768 };

/* The images of one tile, grown to the largest tile asked for. */
struct target {
    uint32_t width, height;
    uint64_t most_asked_px; /* pixels of the largest tile asked for */
    GLuint framebuffer;
    GLuint seen, seen_depth;       /* visibility: RG32UI, DEPTH32F */
    GLuint hit_depth;              /* evaluate: R32F */
    GLuint normal, shape;          /* RGBA32F, RG32F */
    GLuint ptex;                   /* RGBA32UI */
    GLuint border;                 /* R32UI: two halves, shaders/planes.glsl */
    GLuint ends;                   /* RG32UI: shaders/ends.glsl */
    GLuint colour;                 /* RGBA8 */
    GLuint light, curvature;       /* RG32F */
    GLuint light_change;           /* RGBA32F */
    GLuint coverage;               /* R32F: share of the pixel that shows surface */
    GLuint groups, discontinuous;  /* buffers: shaders/gather.comp.glsl */
    GLuint retry_pixels, unsolved; /* buffers: shaders/unsolved.comp.glsl */
    GLuint edges, high_curvature;  /* buffers: shaders/edges_find.comp.glsl */
    GLuint rounded; /* another; and what its pixels' rays meet: shaders/rounded.glsl */
    GLuint rounded_hits;
    GLuint lights[2];   /* colours of the lights behind the one being drawn: RGBA16F; 0: none */
    GLuint missed[2];   /* R16F */
    GLuint uneven[2];   /* R16F: shaders/uneven.glsl */
    GLuint square_sum;  /* RGBA32F: shaders/high_curvature_shade.comp.glsl */
    GLuint max_rounded; /* pixels of which rounded_hits has room for all rays; 0: there is none */
};

/* Makes the images at least so large. They grow to the largest tile asked for, and keep their size
 * where that wastes little; growing loses their contents. ERROR_DEVICE when the device has no
 * memory; the target is empty then. */
bool target_reserve(struct target *target, uint32_t width, uint32_t height, struct error *error);
/* Does the device have images as large as a target for the whole of a frame? */
bool target_can_hold(const struct renderer_info *info, const struct frame_request *request);
/* Memory of the device that a target of this size takes. Any thread. */
uint64_t target_bytes(uint32_t width, uint32_t height);
/* Adds the memory that stage_rounded() fills, which frames of polygons do not need. */
bool target_reserve_rounded(struct target *target, struct error *error);
/* Adds the planes of a frame of two lights and more. */
bool target_reserve_lights(struct target *target, struct error *error);
/* The lists of pixels change places. */
void target_swap_lists(struct target *a, struct target *b);
void target_finish(struct target *target);

#endif
