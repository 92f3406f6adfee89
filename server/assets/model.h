/* A model: the limit tables of a cage, in main memory and on the device, and the information that
 * `sheen info` shows.
 *
 * A model is built once: a worker process reads the cage, one task plans the tables, many tasks on
 * the pool fill them, and the render thread uploads them.
 * Thread: the loop's. */
#ifndef SHEEN_ASSETS_MODEL_H
#define SHEEN_ASSETS_MODEL_H

#include "server/cage/statistics.h"
#include "server/render/renderer.h"
#include "server/assets/build.h"
#include "server/scene/scene_convert.h"

struct model {
    struct limit_tables tables; /* must stay valid as long as `gpu` */
    struct renderer_model *gpu; /* use it on the render thread only */
    struct cage_statistics statistics;
    size_t n_vertices, n_faces; /* of the cage */
    enum cage_up up;            /* up direction from the file, if it has one */
    char *warnings;             /* lines of text, malloc'd; NULL: none */
    size_t n_findings;          /* of the cage */
    struct cage_finding finding[N_CAGE_FINDINGS];
    size_t device_bytes; /* bytes of the tables on the device */
    uint64_t build_us;   /* time of the build: reading, tables, upload */
    struct task destroy_task;
};

static inline struct scene_subject model_subject(const struct model *model)
{
    return (struct scene_subject){&model->tables, model->up};
}

/* Starts a build; its finished() gets a `struct model *`. False with *error when memory is short;
 * then finished() is not called. */
bool model_build_start(const struct build_order *order, struct error *error);

/* Frees the model on the render thread, after all work submitted before. */
void model_destroy(struct model *model, struct render_thread *render_thread);

#endif
