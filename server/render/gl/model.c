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

void gl_model_programs(const struct gl_renderer *r, const struct gl_model *model, bool ptex,
                       struct program_id *ids)
{
    for (int which = 0; which < TABLE_PROGRAMS; which++)
        ids[which] = (struct program_id){
            .set = SET_TABLES,
            .which = which,
            .layout = {model->points.n, model->nodes.n, model->adjacency.n, r->max_texels, ptex}};
}

struct table_programs gl_model_find_programs(const struct gl_renderer *r,
                                             const struct gl_model *model, bool ptex)
{
    struct program_id ids[TABLE_PROGRAMS];
    GLuint name[TABLE_PROGRAMS];
    gl_model_programs(r, model, ptex, ids);
    for (int which = 0; which < TABLE_PROGRAMS; which++)
        name[which] = kept_programs_find(r->programs, &ids[which], NULL);
    return (struct table_programs){ptex,
                                   name[PROGRAM_VISIBILITY],
                                   name[PROGRAM_EVALUATE],
                                   name[PROGRAM_UNSOLVED],
                                   name[PROGRAM_ROUNDED],
                                   name[PROGRAM_ENDS]};
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
        !buffer_textures_init(&model->adjacency, &adjacency, MAX_ADJACENCY_TEXTURES, max, error)) {
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
