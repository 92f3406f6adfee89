/* The meshes of polygons that the device keeps: put there piece by piece, the oldest making room.
 */
#include "server/gpu/gpu.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "server/gpu/mesh.h"

/* What all meshes together may keep on the device beside those in use. */
static const size_t MAX_CACHED_BYTES = (size_t)512 << 20;

static void drop(struct polygons *p, struct polygon_mesh *mesh)
{
    p->bytes -= mesh->vertex_bytes + mesh->index_bytes;
    glDeleteVertexArrays(1, &mesh->array);
    glDeleteBuffers(2, mesh->buffer);
    free(mesh->part);
    *mesh = (struct polygon_mesh){0};
}

void polygons_forget(struct polygons *p, uint64_t model_serial)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        if (p->mesh[i].model_serial == model_serial)
            drop(p, &p->mesh[i]);
}

void polygons_lose(struct polygons *p)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        free(p->mesh[i].part);
    *p = (struct polygons){0};
}

/* A free place for a mesh of so many bytes: the meshes not used for longest make room, but for
 * those that frames are being drawn of, which their models' owners are charged with. */
static struct polygon_mesh *make_room(struct renderer *r, size_t bytes)
{
    /* No frame is being drawn of one of them at least. */
    _Static_assert((int)MAX_CANVASES < (int)MAX_POLYGON_MESHES, "there is one to drop");
    struct polygons *p = &r->polygons;
    for (;;) {
        struct polygon_mesh *free_one = NULL, *oldest = NULL;
        for (int i = 0; i < MAX_POLYGON_MESHES; i++) {
            struct polygon_mesh *mesh = &p->mesh[i];
            if (!mesh->model_serial)
                free_one = mesh;
            else if (!canvas_needs(r, mesh) && (!oldest || mesh->used < oldest->used))
                oldest = mesh;
        }
        if (free_one && (!oldest || p->bytes + bytes <= MAX_CACHED_BYTES))
            return free_one;
        drop(p, oldest);
    }
}

static void describe_vertices(const struct polygon_mesh *mesh)
{
    enum { POSITION, NORMAL, FACE, CELL };
    GLuint array = mesh->array;
    glVertexArrayVertexBuffer(array, 0, mesh->buffer[0], 0, sizeof(struct mesh_vertex));
    glVertexArrayElementBuffer(array, mesh->buffer[1]);
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

static void make_buffers(struct polygon_mesh *mesh)
{
    glCreateBuffers(2, mesh->buffer);
    /* One byte at least: a cage of holes has no polygons. */
    glNamedBufferStorage(mesh->buffer[0], (GLsizeiptr)mesh->vertex_bytes + 1, NULL,
                         GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferStorage(mesh->buffer[1], (GLsizeiptr)mesh->index_bytes + 1, NULL,
                         GL_DYNAMIC_STORAGE_BIT);
    glCreateVertexArrays(1, &mesh->array);
    describe_vertices(mesh);
}

/* A place for it, with nothing in it yet. */
static struct polygon_mesh *begin(struct renderer *r, const struct mesh *made,
                                  const struct renderer_model *model, uint32_t level,
                                  struct error *error)
{
    size_t vertex_bytes = made->n_vertices * sizeof *made->vertex;
    size_t index_bytes = made->n_indices * sizeof *made->index;
    struct mesh_part *part = malloc((made->n_parts + 1) * sizeof *part);
    if (!part) {
        error_set(error, ERROR_SERVER, "out of memory for polygons");
        return NULL;
    }
    memcpy(part, made->part, made->n_parts * sizeof *part);
    struct polygon_mesh *mesh = make_room(r, vertex_bytes + index_bytes);
    *mesh = (struct polygon_mesh){
        .model_serial = model->serial,
        .level = level,
        .part = part,
        .n_parts = made->n_parts,
        .vertex_bytes = vertex_bytes,
        .index_bytes = index_bytes,
        .centre = {made->centre[0], made->centre[1], made->centre[2]},
    };
    r->polygons.bytes += vertex_bytes + index_bytes;
    make_buffers(mesh);
    return mesh;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The next piece: vertices, then indices. */
static void put(struct polygon_mesh *mesh, const struct mesh *made, size_t most)
{
    size_t at = least(mesh->put_bytes, mesh->vertex_bytes);
    size_t vertices = least(most, mesh->vertex_bytes - at), from = mesh->put_bytes - at;
    size_t indices = least(most - vertices, mesh->index_bytes - from);
    glNamedBufferSubData(mesh->buffer[0], (GLintptr)at, (GLsizeiptr)vertices,
                         (const char *)made->vertex + at);
    glNamedBufferSubData(mesh->buffer[1], (GLintptr)from, (GLsizeiptr)indices,
                         (const char *)made->index + from);
    mesh->put_bytes += vertices + indices;
}

static struct polygon_mesh *find(struct polygons *p, uint64_t model_serial, uint32_t level)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        if (p->mesh[i].model_serial == model_serial && p->mesh[i].level == level)
            return &p->mesh[i];
    return NULL;
}

bool polygons_are_whole(const struct polygon_mesh *mesh)
{
    return mesh->put_bytes == mesh->vertex_bytes + mesh->index_bytes;
}

bool polygons_have(struct polygons *p, uint64_t model_serial, uint32_t level)
{
    const struct polygon_mesh *mesh = find(p, model_serial, level);
    return mesh && polygons_are_whole(mesh);
}

struct polygon_mesh *polygons_put(struct renderer *r, const struct renderer_model *model,
                                  uint32_t level, size_t most, struct error *error)
{
    struct polygons *p = &r->polygons;
    struct polygon_mesh *mesh = find(p, model->serial, level);
    if (!mesh && !(mesh = begin(r, &r->made->mesh, model, level, error)))
        return NULL;
    mesh->used = ++p->clock;
    if (!polygons_are_whole(mesh))
        put(mesh, &r->made->mesh, most);
    if (gpu_check("polygons", error))
        return mesh;
    drop(p, mesh);
    return NULL;
}
