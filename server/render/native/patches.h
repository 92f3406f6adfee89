/* A model in the form that the native device reads: each sub-patch as monomials, made from the limit tables when it
 * is first seen, so that a view costs what it shows and not what the tables hold. Patches are kept while there is
 * room; otherwise they are made again, with the same bytes.
 *
 * Thread: any number may ask for patches at the same time, within a frame. A model is drawn by one frame at a
 * time. */
#ifndef SHEEN_RENDER_NATIVE_PATCHES_H
#define SHEEN_RENDER_NATIVE_PATCHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/clusters.h"
#include "server/render/renderer_options.h"
#include "server/surface/record_cache.h"
#include "server/surface/tables.h"

enum { NATIVE_MAX_THREADS = RENDERER_MAX_THREADS };

/* Four cache lines; a piece of one cell needs only the first. */
struct native_patch {
    /* The corners (0,0) (1,0) (0,1) (1,1) relative to the node's origin: all x, then y, then z, world. */
    float corner[3][4];
    float scale, inverse_scale; /* power of two by which the coefficients are divided */
    float bend;                 /* at least |Sss| + 2 |Sst| + |Stt|, divided by scale */
    float unused;
    /* c[k][j][i] is the coefficient of s^i t^j of coordinate k in the node's frame. */
    float c[3][4][4];
};

struct native_model {
    const struct limit_tables *tables;
    struct clusters clusters;
    struct record_cache *patches; /* struct native_patch */
    struct record_cache *texels;  /* struct native_patch_texels */
};

/* Default memory for a model's patches, unless all of them take less. */
#define NATIVE_PATCH_BYTES ((size_t)64 << 20)

/* The tables must outlive the model. `patch_bytes` is about the memory for patches; 0 keeps a few hundred. NULL with
 * ERROR_SERVER when memory is short. */
struct native_model *native_model_create(const struct limit_tables *tables, size_t patch_bytes,
                                         struct error *error);
void native_model_destroy(struct native_model *model); /* NULL is safe */
/* Main memory of the model now, without the tables. Not during a frame. */
size_t native_model_bytes(const struct native_model *model);
/* The largest main memory of a model with these tables. */
size_t native_model_most_bytes(const struct limit_tables *tables, size_t patch_bytes);
/* Call it before a frame: forgets the least recently used patches if room is short. */
void native_model_turn(struct native_model *model);

/* The index of a sub-patch in its node. STRIP: `level` 1 to levels + 1, from the far side to the crease; CORNER:
 * square 1 to 3 of level 1 to levels; REGULAR: the only one. */
static inline uint32_t native_patch_index(const struct limit_node *node, int level, unsigned square)
{
    if (node->kind == LIMIT_CORNER)
        return 3 * (uint32_t)(level - 1) + square - 1;
    return node->kind == LIMIT_STRIP ? (uint32_t)level - 1 : 0;
}

void native_patch_make(const struct limit_tables *tables, uint32_t node, uint32_t index,
                       struct native_patch *patch);

/* Gets a patch, and makes it if it is not kept. If there is no room to keep it, it is made in *room, which is
 * returned. Kept patches stay during the frame. */
const struct native_patch *native_patch_get(struct native_model *model, uint32_t node,
                                            uint32_t index, struct native_patch *room);

/* Finds a kept patch; NULL if it is not kept. */
static inline const struct native_patch *native_patch_find(const struct native_model *model,
                                                           uint32_t node, uint32_t index)
{
    return record_cache_find(model->patches, record_cache_key(node, index));
}

/* The make() of native_made_texels (programs/program.h), for a struct native_model. */
void native_patch_texels(const void *model, uint32_t node, uint32_t index, float (*texels)[4]);

#endif
