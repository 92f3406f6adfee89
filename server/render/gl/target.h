/* A target: the images and the lists of pixels that a tile is drawn into, kept for the next tile.
 * It has names of GL objects; all zero: none. GL thread. */
#ifndef SHEEN_RENDER_GL_TARGET_H
#define SHEEN_RENDER_GL_TARGET_H

#include <epoxy/gl.h>

#include "server/base/error.h"
#include "server/render/device.h"
#include "server/render/tiles.h"

/* Sizes: an entry of a list of pixels on the device, the list's head, and what is stored of a
 * rounded pixel's 16 rays (shaders/list.glsl, rounded.glsl). */
enum { LIST_BYTES = 4, LIST_HEAD_BYTES = 16, ROUNDED_BYTES = 512 };

/* Workgroups in a row: a device limits their number in one dimension (65,535 or more), so larger
 * dispatches are divided into rows (ROW of shaders/list.glsl). */
enum { GROUP_ROW = 32768 };

/* The images of one tile; they grow to the largest tile that was requested. */
struct target {
    uint32_t width, height;
    uint64_t most_asked_px; /* pixels of the largest tile requested */
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
    GLuint coverage;               /* R32F: share of the pixel that shows the surface */
    GLuint groups, discontinuous;  /* buffers: shaders/gather.comp.glsl */
    GLuint retry_pixels, unsolved; /* buffers: shaders/unsolved.comp.glsl */
    GLuint edges;                  /* buffer: shaders/edges_find.comp.glsl */
    GLuint parts;                  /* buffer: shaders/uneven.glsl */
    GLuint rounded; /* a buffer; rounded_hits: what its pixels' rays meet: shaders/rounded.glsl */
    GLuint rounded_hits;
    GLuint lights[2];   /* colours of the lights behind the current one: RGBA16F; 0: none */
    GLuint missed[2];   /* R16F */
    GLuint uneven[2];   /* R16F: shaders/uneven.glsl */
    GLuint square_sum;  /* RGBA32F: shaders/high_curvature_shade.comp.glsl */
    GLuint max_rounded; /* number of pixels for whose rays rounded_hits has room; 0: no buffer */
};

/* Makes the images at least this large. They grow to the largest tile requested, and keep their
 * size if that wastes little; growing loses their contents. False with ERROR_DEVICE if the device
 * has no memory; the target is then empty. */
bool target_reserve(struct target *target, uint32_t width, uint32_t height, struct error *error);
/* True if the device's images can be as large as a target for the whole frame. */
bool target_can_hold(const struct renderer_info *info, const struct frame_request *request);
/* The device memory of a target of this size, in bytes. Any thread. */
uint64_t target_bytes(uint32_t width, uint32_t height);
/* Adds the memory that stage_rounded() fills; frames of polygons do not need it. */
bool target_reserve_rounded(struct target *target, struct error *error);
/* Adds the planes for a frame with two or more lights. */
bool target_reserve_lights(struct target *target, struct error *error);
/* Exchanges the lists of pixels. */
void target_swap_lists(struct target *a, struct target *b);
void target_finish(struct target *target);

#endif
