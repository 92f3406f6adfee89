/* A model as the native device reads it: each sub-patch as monomials, made from the limit tables
 * when it is first seen, so that a view costs what it shows and not what the tables hold. Those that
 * have been made are kept as long as there is room for them; without room they are made again, and
 * are the same bytes.
 *
 * Threads: any number may ask for patches at once, within a frame. One frame of a model may be under
 * way at a time. */
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

/* Four cache lines: the first is all that a piece of one cell needs. */
struct native_patch {
    /* Its corners (0,0) (1,0) (0,1) (1,1) relative to the node's origin: x, y, z of each, world. */
    float corner[3][4];
    float scale, inverse_scale; /* a power of two that the coefficients are divided by */
    /* At least |Sss| + 2 |Sst| + |Stt| anywhere on it, divided by scale. */
    float bend;
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

/* Memory for patches of a model, unless all that it can have take less. */
#define NATIVE_PATCH_BYTES ((size_t)64 << 20)

/* The tables must stay until the model is destroyed. `patch_bytes`: for patches, about; 0 keeps a few
 * hundred. NULL, with ERROR_SERVER, when memory is short. */
struct native_model *native_model_create(const struct limit_tables *tables, size_t patch_bytes,
                                         struct error *error);
void native_model_destroy(struct native_model *model); /* NULL is safe */
/* What it takes in main memory now, without the tables. Not while a frame is under way. */
size_t native_model_bytes(const struct native_model *model);
/* What a model of such tables takes at most. */
size_t native_model_most_bytes(const struct limit_tables *tables, size_t patch_bytes);
/* Before a frame: what has not been used for longest makes room. */
void native_model_turn(struct native_model *model);

/* Which of its node's sub-patches: of a STRIP, `level` 1 to levels + 1 from the far side to the
 * crease; of a CORNER, square 1 to 3 of level 1 to levels; of a REGULAR node the only one. */
static inline uint32_t native_patch_index(const struct limit_node *node, int level, unsigned square)
{
    if (node->kind == LIMIT_CORNER)
        return 3 * (uint32_t)(level - 1) + square - 1;
    return node->kind == LIMIT_STRIP ? (uint32_t)level - 1 : 0;
}

/* Makes it from the tables. */
void native_patch_make(const struct limit_tables *tables, uint32_t node, uint32_t index,
                       struct native_patch *patch);

/* The patch of that index, made now if it is not kept. Where there is no room to keep it, it is in
 * *room, which is returned. What is kept stays for the frame. */
const struct native_patch *native_patch_get(struct native_model *model, uint32_t node,
                                            uint32_t index, struct native_patch *room);

/* NULL where it is not kept. */
static inline const struct native_patch *native_patch_find(const struct native_model *model,
                                                           uint32_t node, uint32_t index)
{
    return record_cache_find(model->patches, record_cache_key(node, index));
}

/* native_made_texels.make (programs/program.h), of a struct native_model. */
void native_patch_texels(const void *model, uint32_t node, uint32_t index, float (*texels)[4]);

#endif
