/* A model as the native device reads it: each sub-patch as monomials, made from the limit tables
 * when it is first seen, so that a view costs what it shows and not what the tables hold.
 *
 * A sub-patch is made while a frame's pieces are chosen (native_patch_get), by the one thread that
 * has the node's cluster. After that all threads read (native_patch_find). So one frame of a model
 * may be under way at a time. */
#ifndef SHEEN_RENDER_NATIVE_PATCHES_H
#define SHEEN_RENDER_NATIVE_PATCHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"
#include "server/render/clusters.h"
#include "server/render/renderer_options.h"
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

/* Patches that one thread has taken and not yet made. */
struct native_cursor {
    uint32_t next, end;
};

struct native_model {
    const struct limit_tables *tables;
    struct clusters clusters;
    uint32_t *first;  /* [n_nodes] of made[]: the node's sub-patches follow each other */
    uint32_t *made;   /* where each sub-patch is, plus one; 0: not made yet */
    size_t n_patches; /* that the tables have */
    struct native_patch **segment; /* where they are; NULL: no memory taken yet */
    size_t n_segments;
    uint32_t n_taken;
    struct native_cursor cursor[NATIVE_MAX_THREADS];
};

/* The tables must stay until the model is destroyed. NULL, with ERROR_SERVER, when memory is short.
 */
struct native_model *native_model_create(const struct limit_tables *tables, struct error *error);
void native_model_destroy(struct native_model *model); /* NULL is safe */
/* What it takes in main memory now, without the tables. Not while a frame is under way. */
size_t native_model_bytes(const struct native_model *model);

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

/* The patch of that index, made now if it is not. NULL when memory is short. Only for the thread
 * that has the node's cluster, whose number `thread` is. */
const struct native_patch *native_patch_get(struct native_model *model, unsigned thread,
                                            uint32_t node, uint32_t index);

/* NULL where it is not made. */
static inline const struct native_patch *native_patch_find(const struct native_model *model,
                                                           uint32_t node, uint32_t index)
{
    enum { SEGMENT_BITS = 13 };
    uint32_t at = model->made[model->first[node] + index];
    if (!at)
        return NULL;
    return &model->segment[(at - 1) >> SEGMENT_BITS][(at - 1) & ((1u << SEGMENT_BITS) - 1)];
}

#endif
