/* A model's tables on the device. GL thread. */
#ifndef SHEEN_RENDER_GL_MODEL_H
#define SHEEN_RENDER_GL_MODEL_H

#include "server/render/clusters.h"
#include "server/render/device.h"
#include "server/render/gl/buffer_textures.h"
#include "server/render/gl/context/context.h"

struct gl_renderer;
struct program_id;

struct gl_model {
    struct renderer_model base;
    struct clusters clusters; /* of the model's tables */
    context_number context;
    struct buffer_textures points, nodes, adjacency;
    uint64_t serial; /* never reused; identifies the model whose planes are kept */
};

static inline struct gl_model *gl_model_of(struct renderer_model *model)
{
    return (struct gl_model *)(void *)model;
}

/* Makes a model that is not on the device yet. NULL on failure. */
struct gl_model *gl_model_create(const struct limit_tables *tables, uint64_t serial,
                                 struct error *error);
/* The function of struct renderer_device. The polygons of the model stay. */
void gl_model_destroy(struct renderer *renderer, struct renderer_model *model);

/* Puts the tables on the device unless they are there. */
bool gl_model_upload(struct gl_renderer *r, struct gl_model *model, struct error *error);
/* The programs that read the tables of a model on the device, and write PLANE_PTEX if `ptex`. Models
 * whose tables are divided into buffer textures in the same way have the same programs; most
 * models' tables fit into one texture each. */
struct table_programs {
    bool ptex;
    GLuint visibility, evaluate, unsolved, rounded, ends;
};
/* Writes the ids of these programs, TABLE_PROGRAMS of them. */
void gl_model_programs(const struct gl_renderer *r, const struct gl_model *model, bool ptex,
                       struct program_id *ids);
/* The programs, which the frame holds. */
struct table_programs gl_model_find_programs(const struct gl_renderer *r,
                                             const struct gl_model *model, bool ptex);

#endif
