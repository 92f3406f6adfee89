/* What stages 1 and 2 leave of a tile, the time that they took, and the rays of pixels that ask for more. */
#ifndef SHEEN_RENDER_NATIVE_PLANES_H
#define SHEEN_RENDER_NATIVE_PLANES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What stage 2 finds at the pixels of a tile, rows top first, `pitch` elements apart. The caller's
 * memory. Where depth is 0 no surface is met, and the other planes mean nothing. */
struct native_planes {
    size_t pitch;
    float *depth;     /* along the view axis, units; 0: nothing */
    float *normal[3]; /* unit, world, along the winding; 0, 0, 0 where there is none */
    float *shape[3];  /* entries (1,1), (1,2), (2,2) of the shape operator in tangent_basis(normal)
                         (shaders/basis.glsl), 1/unit */
    uint32_t *face;   /* Ptex face */
    float *u, *v;     /* on it */
    uint32_t *border; /* shaders/border.glsl */
    uint32_t *node;   /* where the surface is met: a node of the tables, */
    uint32_t *where;  /* and the place on it as shaders/visibility.frag.glsl packs it */
};

/* Groups of pixels (shaders/groups.glsl). */
enum { GROUP_WIDTH = 4, GROUP_HEIGHT = 2 };

/* What is made of the planes for the shaders' programs: `ndc` as shaders/seen.glsl has it, and `node` becomes
 * UINT32_MAX where nothing is met. */
struct native_seen {
    const struct native_planes *planes; /* whose pitch is the width */
    uint32_t width, height;
    float *ndc;
    bool is_perspective;
    float depth[3]; /* View.depth of shaders/view.glsl */
};

/* Words of a RoundedHit (shaders/rounded.glsl), and the most rays of a pixel. */
enum { HIT_WORDS = 8, NATIVE_MAX_RAYS = 16 };

/* Pixels as shaders/rounded.glsl lists them, and side x side rays of each. */
struct native_rounded {
    const uint32_t *pixel;
    uint32_t n;
    int side;                /* 0 to 4 */
    float (*hit)[HIT_WORDS]; /* [n * side * side]: what each ray meets */
};

/* Processor time of each step of one frame, summed over all threads. */
struct native_times {
    uint64_t choose_us, quads_us, raster_us, sort_us, evaluate_us, retry_us, copy_us, gaps_us;
};

#endif
