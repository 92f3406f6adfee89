#include "server/render/gl/model.h"

#include <stdlib.h>

#include "server/render/gl/device_internal.h"

/* Deletes the tables that were uploaded. */
static void take_down(struct gl_model *model)
{
    buffer_textures_finish(&model->points);
    buffer_textures_finish(&model->nodes);
    buffer_textures_finish(&model->adjacency);
}

const struct table_programs *programs_of(struct gl_renderer *r, const struct gl_model *model,
                                         bool ptex, struct error *error)
{
    const struct table_layout layout = {model->points.n, model->nodes.n, model->adjacency.n,
                                        r->max_texels, ptex};
    return programs_for(&r->programs, &layout, error);
}

bool gl_model_upload(struct gl_renderer *r, struct gl_model *model, struct error *error)
{
    if (context_is_current(&r->context, model->context))
        return true;
    const struct limit_tables *tables = model->base.tables;
    const struct texels points = {tables->texels, tables->n_texels, sizeof *tables->texels,
                                  GL_RGBA32F, "points"};
    const struct texels nodes = {tables->nodes, 3 * tables->n_nodes, 16, GL_RGBA32UI, "nodes"};
    const struct texels adjacency = {tables->adjacency, tables->n_faces, 16, GL_RGBA32UI,
                                     "adjacency"};
    size_t max = r->max_texels;
    /* A node's three texels must lie in one buffer texture. */
    size_t node_max = max / 3 * 3;
    model->points = model->nodes = model->adjacency = (struct buffer_textures){0};
    if (!buffer_textures_init(&model->points, &points, MAX_POINT_TEXTURES, max, error) ||
        !buffer_textures_init(&model->nodes, &nodes, MAX_NODE_TEXTURES, node_max, error) ||
        !buffer_textures_init(&model->adjacency, &adjacency, MAX_ADJACENCY_TEXTURES, max, error) ||
        !programs_of(r, model, false, error)) {
        take_down(model);
        return false;
    }
    model->context = r->context.number;
    return true;
}

struct gl_model *gl_model_create(const struct limit_tables *tables, uint64_t serial,
                                 struct error *error)
{
    struct gl_model *model = calloc(1, sizeof *model);
    if (!model) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    model->base.tables = tables;
    model->serial = serial;
    if (clusters_init(&model->clusters, tables, error))
        return model;
    free(model);
    return NULL;
}

void gl_model_destroy(struct renderer *renderer, struct renderer_model *base)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_model *model = gl_model_of(base);
    if (context_is_current(&r->context, model->context))
        take_down(model);
    clusters_finish(&model->clusters);
    free(model);
}
