#include "server/render/gl/polygon_meshes.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/paused_tiles.h"
#include "server/render/gl/model.h"

/* Upper limit on the device memory of all meshes that are not in use. */
static const size_t MAX_CACHED_BYTES = (size_t)512 << 20;

static void drop(struct polygon_meshes *p, struct polygon_mesh *mesh)
{
    p->bytes -= mesh->bytes;
    for (size_t i = 0; i < mesh->n_put; i++) {
        glDeleteVertexArrays(1, &mesh->chunk[i].array);
        glDeleteBuffers(2, mesh->chunk[i].buffer);
    }
    free(mesh->part);
    free(mesh->chunk);
    *mesh = (struct polygon_mesh){0};
}

void polygons_forget(struct polygon_meshes *p, uint64_t model_serial)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        if (p->mesh[i].model_serial == model_serial)
            drop(p, &p->mesh[i]);
}

void polygons_lose(struct polygon_meshes *p)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++) {
        free(p->mesh[i].part);
        free(p->mesh[i].chunk);
    }
    *p = (struct polygon_meshes){0};
}

/* Returns a free place for a mesh of so many bytes. The least recently used meshes are freed for
 * it, except those that frames under way are drawn from (their memory is charged to the models'
 * owners). */
static struct polygon_mesh *make_room(struct gl_renderer *r, size_t bytes)
{
    /* At least one mesh belongs to no frame under way. */
    _Static_assert((int)MAX_PAUSED_TILES < (int)MAX_POLYGON_MESHES, "there is one to drop");
    struct polygon_meshes *p = &r->meshes;
    for (;;) {
        struct polygon_mesh *free_one = NULL, *oldest = NULL;
        for (int i = 0; i < MAX_POLYGON_MESHES; i++) {
            struct polygon_mesh *mesh = &p->mesh[i];
            if (!mesh->model_serial)
                free_one = mesh;
            else if (!mesh_is_needed(r, mesh) && (!oldest || mesh->used < oldest->used))
                oldest = mesh;
        }
        if (free_one && (!oldest || p->bytes + bytes <= MAX_CACHED_BYTES))
            return free_one;
        drop(p, oldest);
    }
}

static void describe_vertices(const struct polygon_chunk *chunk)
{
    enum { POSITION, NORMAL, FACE, CELL };
    GLuint array = chunk->array;
    glVertexArrayVertexBuffer(array, 0, chunk->buffer[0], 0, sizeof(struct mesh_vertex));
    glVertexArrayElementBuffer(array, chunk->buffer[1]);
    glVertexArrayAttribFormat(array, POSITION, 3, GL_FLOAT, GL_FALSE,
                              offsetof(struct mesh_vertex, position));
    glVertexArrayAttribFormat(array, NORMAL, 3, GL_FLOAT, GL_FALSE,
                              offsetof(struct mesh_vertex, normal));
    glVertexArrayAttribIFormat(array, FACE, 1, GL_UNSIGNED_INT, offsetof(struct mesh_vertex, face));
    glVertexArrayAttribIFormat(array, CELL, 4, GL_UNSIGNED_BYTE, offsetof(struct mesh_vertex, x));
    for (GLuint k = POSITION; k <= CELL; k++) {
        glVertexArrayAttribBinding(array, k, 0);
        glEnableVertexArrayAttrib(array, k);
    }
}

/* Returns an empty place for the mesh. */
static struct polygon_mesh *begin(struct gl_renderer *r, const struct mesh *made,
                                  const struct gl_model *model, uint32_t level, struct error *error)
{
    struct mesh_part *part = malloc((made->n_parts + 1) * sizeof *part);
    struct polygon_chunk *chunk = calloc(made->n_chunks + 1, sizeof *chunk);
    if (!part || !chunk) {
        free(part);
        free(chunk);
        error_set(error, ERROR_SERVER, "out of memory for polygons");
        return NULL;
    }
    size_t bytes = made->n_vertices * sizeof *made->vertex + made->n_indices * sizeof *made->index;
    struct polygon_mesh *mesh = make_room(r, bytes);
    memcpy(part, made->part, made->n_parts * sizeof *part);
    for (size_t i = 0; i < made->n_chunks; i++)
        chunk[i].of = made->chunk[i];
    *mesh = (struct polygon_mesh){
        .model_serial = model->serial,
        .level = level,
        .part = part,
        .chunk = chunk,
        .n_parts = made->n_parts,
        .n_chunks = made->n_chunks,
        .bytes = bytes,
        .centre = {made->centre[0], made->centre[1], made->centre[2]},
    };
    r->meshes.bytes += bytes;
    return mesh;
}

/* Uploads the next chunk; returns its size in bytes. */
static size_t put(struct polygon_mesh *mesh, const struct mesh *made)
{
    struct polygon_chunk *chunk = &mesh->chunk[mesh->n_put++];
    size_t vertex_bytes = chunk->of.n_vertices * sizeof *made->vertex;
    size_t index_bytes = chunk->of.n_indices * sizeof *made->index;
    glCreateBuffers(2, chunk->buffer);
    glNamedBufferStorage(chunk->buffer[0], (GLsizeiptr)vertex_bytes,
                         made->vertex + chunk->of.first_vertex, 0);
    glNamedBufferStorage(chunk->buffer[1], (GLsizeiptr)index_bytes,
                         made->index + chunk->of.first_index, 0);
    glCreateVertexArrays(1, &chunk->array);
    describe_vertices(chunk);
    return vertex_bytes + index_bytes;
}

static struct polygon_mesh *find(struct polygon_meshes *p, uint64_t model_serial, uint32_t level)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        if (p->mesh[i].model_serial == model_serial && p->mesh[i].level == level)
            return &p->mesh[i];
    return NULL;
}

bool polygons_are_whole(const struct polygon_mesh *mesh)
{
    return mesh->n_put == mesh->n_chunks;
}

bool polygons_have(struct polygon_meshes *p, uint64_t model_serial, uint32_t level)
{
    const struct polygon_mesh *mesh = find(p, model_serial, level);
    return mesh && polygons_are_whole(mesh);
}

struct polygon_mesh *polygons_put(struct gl_renderer *r, const struct gl_model *model,
                                  uint32_t level, size_t most, struct error *error)
{
    struct polygon_meshes *p = &r->meshes;
    struct polygon_mesh *mesh = find(p, model->serial, level);
    if (!mesh && !(mesh = begin(r, &r->made->mesh, model, level, error)))
        return NULL;
    mesh->used = ++p->clock;
    for (size_t bytes = 0; bytes < most && !polygons_are_whole(mesh);)
        bytes += put(mesh, &r->made->mesh);
    if (gpu_check("polygons", error))
        return mesh;
    drop(p, mesh);
    return NULL;
}
