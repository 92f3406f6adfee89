#include "server/render/native/patches.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "server/surface/evaluate.h"
#include "server/surface/vec.h"

static_assert(sizeof(struct native_patch) == 256, "four cache lines");

/* A segment is a huge page, and a thread takes a run of patches at a time. */
enum { SEGMENT_PATCHES = 1 << 13, RUN_PATCHES = 64, HUGE_PAGE = 2 << 20 };
static_assert(SEGMENT_PATCHES * sizeof(struct native_patch) == HUGE_PAGE, "one huge page");
static_assert(SEGMENT_PATCHES % RUN_PATCHES == 0, "whole runs");

static uint32_t patches_of(const struct limit_node *node)
{
    switch (node->kind) {
    case LIMIT_REGULAR:
        return 1;
    case LIMIT_CORNER:
        return 3 * (node->levels & ~LIMIT_NO_NORMAL);
    case LIMIT_STRIP:
        return node->levels + 1u;
    }
    return 0;
}

/* Where each node's patches begin in made[]. False where there are too many to count. */
static bool number_patches(struct native_model *model)
{
    const struct limit_tables *tables = model->tables;
    uint64_t n = 0;
    for (size_t i = 0; i < tables->n_nodes; i++) {
        model->first[i] = (uint32_t)n;
        n += patches_of(&tables->nodes[i]);
    }
    model->n_patches = (size_t)n;
    return n < UINT32_MAX - NATIVE_MAX_THREADS * RUN_PATCHES;
}

struct native_model *native_model_create(const struct limit_tables *tables, struct error *error)
{
    struct native_model *model = calloc(1, sizeof *model);
    if (!model) {
        error_set(error, ERROR_SERVER, "out of memory for a model");
        return NULL;
    }
    model->tables = tables;
    if (!clusters_init(&model->clusters, tables, error)) {
        native_model_destroy(model);
        return NULL;
    }
    model->first = malloc((tables->n_nodes + 1) * sizeof *model->first);
    if (model->first && number_patches(model)) {
        /* Each thread may leave a run unfinished. */
        size_t most = model->n_patches + NATIVE_MAX_THREADS * RUN_PATCHES;
        model->n_segments = (most + SEGMENT_PATCHES - 1) / SEGMENT_PATCHES;
        model->segment = calloc(model->n_segments, sizeof(struct native_patch *));
        model->made = calloc(model->n_patches + 1, sizeof *model->made);
    }
    if (!model->segment || !model->made) {
        error_set(error, ERROR_SERVER, "out of memory for the %zu patches of a model",
                  model->n_patches);
        native_model_destroy(model);
        return NULL;
    }
    return model;
}

void native_model_destroy(struct native_model *model)
{
    if (!model)
        return;
    for (size_t i = 0; model->segment && i < model->n_segments; i++)
        free(model->segment[i]);
    free(model->segment);
    free(model->made);
    free(model->first);
    clusters_finish(&model->clusters);
    free(model);
}

size_t native_model_bytes(const struct native_model *model)
{
    size_t bytes = sizeof *model + model->clusters.n * sizeof *model->clusters.cluster +
                   (model->tables->n_nodes + 1) * sizeof *model->first +
                   (model->n_patches + 1) * sizeof *model->made +
                   model->n_segments * sizeof(struct native_patch *);
    for (size_t i = 0; i < model->n_segments; i++)
        bytes += model->segment[i] ? HUGE_PAGE : 0;
    return bytes;
}

/* --- */

/* The four B-spline points of a segment as the coefficients of 1, t, t^2, t^3. */
static void monomials_of(const double p[4], double c[4])
{
    c[0] = (p[0] + 4 * p[1] + p[2]) / 6;
    c[1] = (p[2] - p[0]) / 2;
    c[2] = ((p[2] - p[1]) - (p[1] - p[0])) / 2;
    c[3] = ((p[3] - p[0]) + 3 * (p[1] - p[2])) / 6;
}

/* One coordinate: points 4 j + i to coefficients [j][i]. */
static void expand(const double p[16], double c[4][4])
{
    double row[4][4];
    for (int j = 0; j < 4; j++)
        monomials_of(p + 4 * j, row[j]);
    for (int i = 0; i < 4; i++) {
        double column[4] = {row[0][i], row[1][i], row[2][i], row[3][i]}, along[4];
        monomials_of(column, along);
        for (int j = 0; j < 4; j++)
            c[j][i] = along[j];
    }
}

/* Differences of the points bound the second derivatives: a B-spline lies in the hull of its own.
 */
static double bend_of(const struct vec p[16])
{
    double uu = 0, uv = 0, vv = 0;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            const struct vec *at = p + 4 * j + i;
            if (i < 2)
                uu = fmax(uu, vec_length(vec_sub(vec_sub(at[2], at[1]), vec_sub(at[1], at[0]))));
            if (j < 2)
                vv = fmax(vv, vec_length(vec_sub(vec_sub(at[8], at[4]), vec_sub(at[4], at[0]))));
            if (i < 3 && j < 3)
                uv = fmax(uv, vec_length(vec_sub(vec_sub(at[5], at[4]), vec_sub(at[1], at[0]))));
        }
    }
    return uu + 2 * uv + vv;
}

/* A sum of the coefficients of some powers is the value at s or t of 1. */
static double corner_value(double c[4][4], int corner)
{
    double sum = 0;
    for (int j = 0; j < (corner & 2 ? 4 : 1); j++)
        for (int i = 0; i < (corner & 1 ? 4 : 1); i++)
            sum += c[j][i];
    return sum;
}

static void patch_at(const struct limit_tables *tables, const struct limit_node *node,
                     uint32_t index, struct limit_patch *patch)
{
    int level = 0;
    double x = 0.5, y = 0.5;
    if (node->kind == LIMIT_CORNER) {
        unsigned square = index % 3 + 1;
        level = (int)(index / 3) + 1;
        x = ldexp(square < 3 ? 1.5 : 0.5, -level);
        y = ldexp(square > 1 ? 1.5 : 0.5, -level);
    } else if (node->kind == LIMIT_STRIP) {
        level = (int)index + 1;
        y = level <= node->levels ? ldexp(1.5, -level) : ldexp(0.5, -node->levels);
    }
    limit_patch_of_level(patch, tables, node, level, x, y);
}

void native_patch_make(const struct limit_tables *tables, uint32_t node, uint32_t index,
                       struct native_patch *patch)
{
    struct limit_patch from;
    struct vec points[16], corner[4];
    patch_at(tables, &tables->nodes[node], index, &from);
    double scale = limit_patch_points(&from, points), inverse = 1 / scale, value[3][4];
    *patch = (struct native_patch){.scale = (float)scale, .inverse_scale = (float)inverse};
    for (int k = 0; k < 3; k++) {
        double p[16], c[4][4];
        for (int i = 0; i < 16; i++)
            p[i] = k == 0 ? points[i].x : k == 1 ? points[i].y : points[i].z;
        expand(p, c);
        for (int i = 0; i < 4; i++)
            value[k][i] = corner_value(c, i);
        for (int i = 0; i < 16; i++)
            patch->c[k][i / 4][i % 4] = (float)(c[i / 4][i % 4] * inverse);
    }
    patch->bend = (float)(bend_of(points) * inverse);
    for (int i = 0; i < 4; i++) {
        corner[i] = limit_frame_to_world(tables, &tables->nodes[node],
                                         (struct vec){value[0][i], value[1][i], value[2][i]});
        patch->corner[0][i] = (float)corner[i].x;
        patch->corner[1][i] = (float)corner[i].y;
        patch->corner[2][i] = (float)corner[i].z;
    }
}

/* Memory for the patches of a segment, unless it has some. */
static bool reserve(struct native_model *model, uint32_t segment)
{
    struct native_patch **at = &model->segment[segment], *none = NULL;
    if (__atomic_load_n(at, __ATOMIC_ACQUIRE))
        return true;
    struct native_patch *taken = aligned_alloc(HUGE_PAGE, HUGE_PAGE);
    if (!taken)
        return false;
    madvise(taken, HUGE_PAGE, MADV_HUGEPAGE); /* a wish: without huge pages all is as it was */
    if (!__atomic_compare_exchange_n(at, &none, taken, false, __ATOMIC_ACQ_REL, __ATOMIC_ACQUIRE))
        free(taken); /* another thread was first */
    return true;
}

const struct native_patch *native_patch_get(struct native_model *model, unsigned thread,
                                            uint32_t node, uint32_t index)
{
    const struct native_patch *found = native_patch_find(model, node, index);
    if (found)
        return found;
    struct native_cursor *cursor = &model->cursor[thread];
    if (cursor->next == cursor->end) {
        uint32_t next = __atomic_fetch_add(&model->n_taken, RUN_PATCHES, __ATOMIC_RELAXED);
        *cursor = (struct native_cursor){next, next + RUN_PATCHES};
    }
    if (!reserve(model, cursor->next / SEGMENT_PATCHES))
        return NULL;
    uint32_t at = cursor->next++;
    struct native_patch *patch = &model->segment[at / SEGMENT_PATCHES][at % SEGMENT_PATCHES];
    native_patch_make(model->tables, node, index, patch);
    model->made[model->first[node] + index] = at + 1;
    return patch;
}
