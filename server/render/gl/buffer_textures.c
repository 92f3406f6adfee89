/* Tables into buffer textures: as many as the device's texel limit asks for. */
#include "server/render/gl/gpu.h"

#include <stdlib.h>

/* Read only, and what pads it is never read. */
static void store(GLuint buffer, const void *texels, size_t n, size_t texel_bytes)
{
    size_t room = no_power_of_two(n); /* a texel's bytes are one */
    if (room == n) {
        glNamedBufferStorage(buffer, (GLsizeiptr)(n * texel_bytes), texels, 0);
        return;
    }
    glNamedBufferStorage(buffer, (GLsizeiptr)(room * texel_bytes), NULL, GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferSubData(buffer, 0, (GLsizeiptr)(n * texel_bytes), texels);
}

static bool upload(struct bank_set *set, int max_banks, GLenum format, const void *data,
                   size_t n_texels, size_t texel_bytes, size_t max_texels, const char *what,
                   struct error *error)
{
    size_t n_banks = n_texels ? (n_texels + max_texels - 1) / max_texels : 1;
    if (n_banks > (size_t)max_banks)
        return error_set(error, ERROR_DEVICE,
                         "the model's %s need %zu texels, but this device holds %zu in %d buffer "
                         "textures",
                         what, n_texels, max_texels * (size_t)max_banks, max_banks);
    set->n = (int)n_banks;
    glCreateBuffers(set->n, set->buffer);
    glCreateTextures(GL_TEXTURE_BUFFER, set->n, set->texture);
    for (size_t b = 0; b < n_banks; b++) {
        size_t first = b * max_texels;
        size_t n = n_texels - first < max_texels ? n_texels - first : max_texels;
        store(set->buffer[b], (const char *)data + first * texel_bytes, n, texel_bytes);
        glTextureBuffer(set->texture[b], format, set->buffer[b]);
    }
    return gpu_check(what, error);
}

static void banks_finish(struct bank_set *set)
{
    glDeleteTextures(set->n, set->texture);
    glDeleteBuffers(set->n, set->buffer);
    *set = (struct bank_set){0};
}

int banks_bind(const struct bank_set *set, int unit)
{
    for (int b = 0; b < set->n; b++)
        glBindTextureUnit((GLuint)unit++, set->texture[b]);
    return unit;
}

/* What there is of it. */
static void take_down(struct gl_model *model)
{
    banks_finish(&model->points);
    banks_finish(&model->nodes);
    banks_finish(&model->adjacency);
}

bool model_upload(struct gl_renderer *r, struct gl_model *model, struct error *error)
{
    if (is_current(r, model->context))
        return true;
    const struct limit_tables *tables = model->base.tables;
    size_t max = r->base.info.max_texels;
    /* A node's three texels stay in one bank. */
    size_t node_max = max / 3 * 3;
    model->points = model->nodes = model->adjacency = (struct bank_set){0};
    if (!upload(&model->points, MAX_POINT_BANKS, GL_RGBA32F, tables->texels, tables->n_texels,
                sizeof *tables->texels, max, "points", error) ||
        !upload(&model->nodes, MAX_NODE_BANKS, GL_RGBA32UI, tables->nodes, 3 * tables->n_nodes, 16,
                node_max, "nodes", error) ||
        !upload(&model->adjacency, MAX_ADJACENCY_BANKS, GL_RGBA32UI, tables->adjacency,
                tables->n_faces, 16, max, "adjacency", error) ||
        !programs_for(r, model, false, error)) {
        take_down(model);
        return false;
    }
    model->context = r->context;
    return true;
}

struct renderer_model *gl_model_create(struct renderer *renderer, const struct limit_tables *tables,
                                       struct error *error)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_model *model = calloc(1, sizeof *model);
    if (!model) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    model->base.tables = tables;
    model->serial = ++r->next_serial;
    /* On a device that is lost meanwhile it comes with its first frame. */
    if (clusters_init(&model->clusters, tables, error) &&
        (!gl_ready(r, error) || model_upload(r, model, error) || gl_check_lost(r)))
        return &model->base;
    clusters_finish(&model->clusters);
    free(model);
    return NULL;
}

void gl_model_destroy(struct renderer *renderer, struct renderer_model *base)
{
    struct gl_renderer *r = gl_renderer_of(renderer);
    struct gl_model *model = gl_model_of(base);
    if (is_current(r, model->context)) {
        polygons_forget(&r->polygons, model->serial);
        take_down(model);
    }
    clusters_finish(&model->clusters);
    free(model);
}
