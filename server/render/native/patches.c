#include "server/render/native/patches.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/native/programs/program.h"
#include "server/surface/evaluate.h"
#include "server/surface/vec.h"

static_assert(sizeof(struct native_patch) == 256, "four cache lines");

static uint32_t patches_of(const struct limit_node *node)
{
    switch (node->kind) {
    case LIMIT_REGULAR:
        return 1;
    case LIMIT_CORNER:
        return 3 * limit_levels(node);
    case LIMIT_STRIP:
        return node->levels + 1u;
    }
    return 0;
}

/* A patch in the form that programs read. */
struct native_patch_texels {
    float texels[NATIVE_PATCH_TEXELS][4];
};

/* Sets how many patches are kept, and how many of them as texels, which only outlines and roundings need. */
static void set_room(const struct limit_tables *tables, size_t patch_bytes, size_t *patches,
                     size_t *texels)
{
    size_t n = 3 * limit_view_levels(tables) + tables->count[LIMIT_REGULAR];
    size_t most = patch_bytes / sizeof(struct native_patch);
    *patches = n < most ? n : most;
    *texels = *patches / 4;
}

struct native_model *native_model_create(const struct limit_tables *tables, size_t patch_bytes,
                                         struct error *error)
{
    struct native_model *model = calloc(1, sizeof *model);
    if (!model) {
        error_set(error, ERROR_SERVER, "out of memory for a model");
        return NULL;
    }
    size_t patches, texels;
    model->tables = tables;
    if (!clusters_init(&model->clusters, tables, error)) {
        native_model_destroy(model);
        return NULL;
    }
    set_room(tables, patch_bytes, &patches, &texels);
    model->patches = record_cache_create(sizeof(struct native_patch), patches);
    model->texels = record_cache_create(sizeof(struct native_patch_texels), texels);
    if (!model->patches || !model->texels) {
        error_set(error, ERROR_SERVER, "out of memory for the patches of a model");
        native_model_destroy(model);
        return NULL;
    }
    return model;
}

void native_model_destroy(struct native_model *model)
{
    if (!model)
        return;
    record_cache_destroy(model->patches);
    record_cache_destroy(model->texels);
    clusters_finish(&model->clusters);
    free(model);
}

size_t native_model_bytes(const struct native_model *model)
{
    return sizeof *model + model->clusters.n * sizeof *model->clusters.cluster +
           record_cache_bytes(model->patches) + record_cache_bytes(model->texels);
}

size_t native_model_most_bytes(const struct limit_tables *tables, size_t patch_bytes)
{
    size_t patches, texels, clusters = tables->n_nodes / CLUSTER_NODES + 1;
    set_room(tables, patch_bytes, &patches, &texels);
    return sizeof(struct native_model) + clusters * sizeof(struct cluster) +
           record_cache_most_bytes(sizeof(struct native_patch), patches) +
           record_cache_most_bytes(sizeof(struct native_patch_texels), texels);
}

void native_model_turn(struct native_model *model)
{
    record_cache_turn(model->patches);
    record_cache_turn(model->texels);
    limit_tables_turn(model->tables);
}

/* --- */

/* Converts the four B-spline points of a segment to the coefficients of 1, t, t^2, t^3. */
static void monomials_of(const double p[4], double c[4])
{
    c[0] = (p[0] + 4 * p[1] + p[2]) / 6;
    c[1] = (p[2] - p[0]) / 2;
    c[2] = ((p[2] - p[1]) - (p[1] - p[0])) / 2;
    c[3] = ((p[3] - p[0]) + 3 * (p[1] - p[2])) / 6;
}

/* Converts one coordinate: points 4 j + i to coefficients [j][i]. */
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

/* Differences of the points bound the second derivatives, since a B-spline lies in the hull of its points. */
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

/* With s or t equal to 1 the value is a sum of coefficients. */
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

const struct native_patch *native_patch_get(struct native_model *model, uint32_t node,
                                            uint32_t index, struct native_patch *room)
{
    const struct native_patch *kept = native_patch_find(model, node, index);
    if (kept)
        return kept;
    native_patch_make(model->tables, node, index, room);
    kept = record_cache_add(model->patches, record_cache_key(node, index), room);
    return kept ? kept : room;
}

void native_patch_texels(const void *owner, uint32_t node, uint32_t index, float (*texels)[4])
{
    const struct native_model *model = owner;
    const struct limit_tables *tables = model->tables;
    struct native_patch_texels made = {0};
    /* Lanes without a valid result may ask for any number. */
    if (node >= tables->n_nodes || index >= patches_of(&tables->nodes[node])) {
        memset(texels, 0, sizeof made.texels);
        return;
    }
    uint64_t key = record_cache_key(node, index);
    const struct native_patch_texels *kept = record_cache_find(model->texels, key);
    if (!kept) {
        struct limit_patch from;
        patch_at(tables, &tables->nodes[node], index, &from);
        made.texels[0][0] = (float)from.points.scale;
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 3; k++)
                for (int i = 0; i < 4; i++) {
                    const float(*rows)[4] = from.points.rows, (*column)[4] = from.points.column;
                    made.texels[1 + 3 * j + k][i] = !column  ? rows[3 * j + k][i]
                                                    : i == 0 ? column[k][j]
                                                             : rows[3 * j + k][i - 1];
                }
        kept = record_cache_add(model->texels, key, &made);
    }
    memcpy(texels, kept ? kept : &made, sizeof made.texels);
}
