/* A target: the planes and lists that a tile is drawn into. Internal to the folder; one owner. */
#ifndef SHEEN_RENDER_NATIVE_TARGET_H
#define SHEEN_RENDER_NATIVE_TARGET_H

#include "server/base/error.h"
#include "server/render/native/planes.h"
#include "server/render/native/programs/program.h"
#include "server/scene/frame_request.h"

/* The lists of a target: groups of pixels near visible surface, those of them that are shaded, and pixels that are
 * looked at more closely (shaders/edges.glsl). */
enum native_list_of {
    NATIVE_GROUPS,
    NATIVE_SHADED_GROUPS,
    NATIVE_RIMS,
    NATIVE_FOUND_EDGES, /* before they are rechecked */
    NATIVE_EDGES,
    NATIVE_ROUNDED,
    NATIVE_PARTS, /* of stage 3: pixels that are shaded in parts (shaders/uneven.glsl) */
    NATIVE_LISTS
};

/* Words per pixel of what always exists, without groups; of frames of several lights; of measured planes. */
enum { WORDS_PER_PX = 1 + 4 + 2 + 1 + 2 + 1 + 3 + 4 + NATIVE_LISTS - 2 };
enum { LIGHT_WORDS_PER_PX = 2 * 6 + 4, MEASURE_WORDS_PER_PX = 2 + 2 + 4 };

/* Zero it before the first use. A row of a plane has `width` words. */
struct native_target {
    uint32_t width, height;
    struct native_planes planes; /* stage 2 */
    struct native_image hit_depth, normal, shape, ptex, border, seen, seen_depth;
    struct native_image ends, colour, coverage, light_st, curvature, light_change;
    struct native_image lights[2], missed[2], uneven[2]; /* of frames of several lights */
    struct native_image square_sum;                      /* of these, too */
    struct native_list list[NATIVE_LISTS];
    /* Memory of all of them but for lights, missed and what is measured: light_st, curvature, light_change. */
    struct native_words {
        uint32_t *words;
        size_t n;
        unsigned idle_uses; /* number of the latest uses that needed less than half */
    } own, of_lights, of_measures;
    uint32_t *hits; /* hits of the rays of rounded pixels */
    size_t n_hit_words;
};

/* Makes planes and empty lists for a tile of this size; their contents are lost. False with ERROR_SERVER when memory
 * is short. */
bool native_target_reserve(struct native_target *target, uint32_t width, uint32_t height,
                           struct error *error);
/* Makes the further planes that stage 3 of a request needs: for several lights, and for measuring. */
bool native_target_reserve_shading(struct native_target *target,
                                   const struct frame_request *request, struct error *error);
/* Makes room for n_rays of RoundedHit (shaders/rounded.glsl). */
bool native_target_reserve_hits(struct native_target *target, size_t n_rays, struct error *error);
void native_target_finish(struct native_target *target);

#endif
