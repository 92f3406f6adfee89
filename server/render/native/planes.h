/* The results of stages 1 and 2 for a tile, their times, and the rays of pixels that need more. */
#ifndef SHEEN_RENDER_NATIVE_PLANES_H
#define SHEEN_RENDER_NATIVE_PLANES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What stage 2 finds at the pixels of a tile: rows from the top, `pitch` elements apart, in the caller's memory.
 * Where depth is 0 no surface is met, and the other planes are undefined. */
struct native_planes {
    size_t pitch;
    float *depth;     /* along the view axis, units; 0: nothing */
    float *normal[3]; /* unit length, world, by the winding; 0, 0, 0: no normal */
    /* Entries (1,1), (1,2), (2,2) of the shape operator in tangent_basis(normal) (shaders/basis.glsl), 1/unit. */
    float *shape[3];
    uint32_t *face;   /* Ptex face */
    float *u, *v;     /* on the Ptex face */
    uint32_t *border; /* shaders/border.glsl */
    uint32_t *node;   /* the place that is met: a node of the tables */
    uint32_t *where;  /* and the place on the node, packed as in shaders/visibility.frag.glsl */
};

/* Groups of pixels (shaders/groups.glsl). */
enum { GROUP_WIDTH = 4, GROUP_HEIGHT = 2 };

/* What the programs of edges need of the planes: `ndc` as in shaders/seen.glsl; `node` becomes UINT32_MAX where
 * nothing is met. ndc NULL: no such program will run. */
struct native_seen {
    const struct native_planes *planes; /* their pitch is the width */
    uint32_t width, height;
    float *ndc;
    bool is_perspective;
    float depth[3]; /* View.depth of shaders/view.glsl */
};

/* The words of a RoundedHit (shaders/rounded.glsl), and the most rays of a pixel. */
enum { HIT_WORDS = 8, NATIVE_MAX_RAYS = 16 };

/* A list of pixels as in shaders/rounded.glsl, and side x side rays for each. */
struct native_rounded {
    const uint32_t *pixel;
    uint32_t n;
    int side;                /* 0 to 4 */
    float (*hit)[HIT_WORDS]; /* [n * side * side]: the hit of each ray */
};

/* The processor time of each step of one frame, summed over all threads. */
struct native_times {
    uint64_t choose_us, quads_us, raster_us, sort_us, evaluate_us, retry_us, copy_us, gaps_us;
};

#endif
