/* The shaders as functions of the processor: every program of shaders/ that the native device runs, compiled once for
 * each instruction set. shaders/lanes writes them as C++, in terms of glsl.hpp.
 *
 * A program finds its input and output by the names that the shaders use. Thread: any; calls that write to the same
 * memory must not run at the same time. */
#ifndef SHEEN_RENDER_NATIVE_PROGRAMS_PROGRAM_H
#define SHEEN_RENDER_NATIVE_PROGRAMS_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Planes of pixels, one for each channel, `channel_words` apart: rows of `width` words of 32 bits. */
struct native_image {
    uint32_t *words;
    int32_t width, height, channels;
    size_t channel_words;
};

/* A light image with its smaller copies, each with half the sides, rounded down and at least 1: linear light,
 * premultiplied, four floats a texel, top row first. */
enum { NATIVE_MOST_LEVELS = 32 };
struct native_picture {
    const float *texels;
    uint32_t first[NATIVE_MOST_LEVELS]; /* first texel of each level */
    int32_t width, height, n_levels;    /* size of level 0; n_levels 0: no image */
    bool repeats_s, repeats_t;          /* false: the outermost texels continue beyond the side */
};

/* A buffer texture: texels of four words. */
struct native_texels {
    const uint32_t *words;
    uint32_t n;
};

/* The points of sub-patches, made when a program needs them (shaders/tables.glsl): make() writes those of part `part`
 * (patches.h) of a node as one texel whose x is the scale, and four rows of three texels (server/surface/texels.h).
 * Any thread. */
enum { NATIVE_PATCH_TEXELS = 13 };
struct native_made_texels {
    const void *owner;
    void (*make)(const void *owner, uint32_t node, uint32_t part, float (*texels)[4]);
};

/* The open array of a buffer, of n elements. */
struct native_array {
    uint32_t *words;
    uint32_t n;
};

/* A list as in shaders/list.glsl. A program writes no more than the array holds. */
struct native_list {
    uint32_t x, y, z, n;
    struct native_array at;
};

/* The block of shaders/share.comp.glsl. */
struct native_share {
    uint32_t seen_px, met_px;
    struct native_array met;
};

/* The inputs and outputs of programs; members that a program does not use need not be set. */
struct native_bindings {
    const void *View, *Light; /* struct view_block, struct light_block */
    struct native_made_texels texels;
    struct native_texels heads, nodes, adjacency, vertices;
    struct native_image seen, seen_depth, hit_depth, normal, shape, ptex, border;
    struct native_image ends, colour, coverage;
    struct native_image light_st, curvature, light_change;
    struct native_image next_light, next_missed, behind_light, behind_missed;
    struct native_image next_uneven, behind_uneven, square_sum;
    struct native_picture picture;
    struct native_list *groups, *listed, *edges, *parts, *rounded, *rims;
    struct native_array *RoundedHits, *Corners;
    struct native_share *Share;
    float centre[3];
    int32_t shaded[4], inside[4];
    int32_t line_family, light_kind, pattern_kind;
    bool is_soft, is_filtered;
    uint32_t max_rounded, stride, first_square, end_square;
};

/* Runs workgroups first to end - 1, numbered as in shaders/list.glsl. */
typedef void native_program(const struct native_bindings *bindings, uint32_t first, uint32_t end);

/* The programs of an instruction set. */
struct native_programs {
    native_program *edges_find, *edges_recheck, *ends_find;
    native_program *shade, *edges_shade, *high_curvature_shade, *rounded_shade;
    native_program *shade_planes, *share, *polygon_planes, *polygon_edges;
};

#endif
