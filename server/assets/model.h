/* A model: a cage's limit tables in memory and on the device, and what `sheen info` says about it.
 *
 * It is built once: a worker process reads the cage, which one task then measures, many tasks on the
 * pool fill the tables, and the render thread uploads them. Thread: the loop's. */
#ifndef SHEEN_ASSETS_MODEL_H
#define SHEEN_ASSETS_MODEL_H

#include "server/cage/statistics.h"
#include "server/render/renderer.h"
#include "server/assets/build.h"
#include "server/scene/scene_convert.h"

struct model {
    struct limit_tables tables; /* stay as long as `gpu` */
    struct renderer_model *gpu; /* for the render thread only */
    struct cage_statistics statistics;
    size_t n_vertices, n_faces; /* of the cage */
    enum cage_up up;            /* as its file says */
    char *warnings;             /* lines, or NULL */
    size_t n_findings;          /* of the cage */
    struct cage_finding finding[N_CAGE_FINDINGS];
    size_t device_bytes; /* of its tables on the device */
    uint64_t build_us;   /* reading, building and uploading */
    struct task destroy_task;
};

static inline struct scene_subject model_subject(const struct model *model)
{
    return (struct scene_subject){&model->tables, model->up};
}

/* Starts a build; finished() gets a `struct model *`. False, without finished(), when memory is
 * short. */
bool model_build_start(const struct build_order *order, struct error *error);

/* Frees the model once the render thread has let go of it, after all work submitted before. */
void model_destroy(struct model *model, struct render_thread *render_thread);

#endif
