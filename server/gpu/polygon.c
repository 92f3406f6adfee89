/* The conventional picture: polygons into the planes that stages 1 and 2 fill for the exact
 * surface, and their edges over the shaded picture. */
#include "server/gpu/gpu.h"

#include <stddef.h>

#include "server/gpu/mesh.h"
#include "server/gpu/program.h"

/* What all meshes together may keep on the device beside the one in use. */
static const size_t MAX_CACHED_BYTES = (size_t)512 << 20;

static bool compile(struct polygons *p, struct error *error)
{
    static const char *const vertex[] = {"view.glsl", "polygon.vert.glsl", NULL};
    static const char *const planes[] = {"view.glsl", "basis.glsl", "polygon.frag.glsl", NULL};
    static const char *const edges[] = {"wireframe.frag.glsl", NULL};
    if (!p->fill)
        p->fill = program_raster("", vertex, planes, error);
    if (p->fill && !p->edges)
        p->edges = program_raster("", vertex, edges, error);
    return p->fill && p->edges;
}

static void drop(struct polygons *p, struct polygon_mesh *mesh)
{
    p->bytes -= mesh->bytes;
    glDeleteVertexArrays(1, &mesh->array);
    glDeleteBuffers(2, mesh->buffer);
    *mesh = (struct polygon_mesh){0};
}

void polygons_forget(struct polygons *p, uint64_t model_serial)
{
    for (int i = 0; i < MAX_POLYGON_MESHES; i++)
        if (p->mesh[i].model_serial == model_serial)
            drop(p, &p->mesh[i]);
}

/* A free place for a mesh of so many bytes: the meshes not used for longest make room. */
static struct polygon_mesh *make_room(struct polygons *p, size_t bytes)
{
    for (;;) {
        struct polygon_mesh *free_one = NULL, *oldest = NULL;
        for (int i = 0; i < MAX_POLYGON_MESHES; i++) {
            struct polygon_mesh *mesh = &p->mesh[i];
            if (!mesh->model_serial)
                free_one = mesh;
            else if (!oldest || mesh->used < oldest->used)
                oldest = mesh;
        }
        if (!oldest || (free_one && p->bytes + bytes <= MAX_CACHED_BYTES))
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

static struct polygon_mesh *upload(struct polygons *p, const struct mesh *made,
                                   const struct renderer_model *model, uint32_t level,
                                   struct error *error)
{
    size_t vertex_bytes = made->n_vertices * sizeof *made->vertex;
    size_t index_bytes = made->n_indices * sizeof *made->index;
    struct polygon_mesh *mesh = make_room(p, vertex_bytes + index_bytes);
    *mesh = (struct polygon_mesh){
        .model_serial = model->serial,
        .level = level,
        .n_indices = (GLsizei)made->n_indices,
        .bytes = vertex_bytes + index_bytes,
        .centre = {made->centre[0], made->centre[1], made->centre[2]},
    };
    p->bytes += mesh->bytes;
    glCreateBuffers(2, mesh->buffer);
    /* One byte at least: a cage of holes has no polygons. */
    glNamedBufferStorage(mesh->buffer[0], (GLsizeiptr)vertex_bytes + 1, NULL,
                         GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferStorage(mesh->buffer[1], (GLsizeiptr)index_bytes + 1, NULL,
                         GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferSubData(mesh->buffer[0], 0, (GLsizeiptr)vertex_bytes, made->vertex);
    glNamedBufferSubData(mesh->buffer[1], 0, (GLsizeiptr)index_bytes, made->index);
    glCreateVertexArrays(1, &mesh->array);
    describe_vertices(mesh);
    if (gpu_check("polygons", error))
        return mesh;
    drop(p, mesh);
    return NULL;
}

/* The index of the place that they have, or MAX_POLYGON_MESHES. */
static int find(const struct polygons *p, uint64_t model_serial, uint32_t level)
{
    int i = 0;
    while (i < MAX_POLYGON_MESHES &&
           (p->mesh[i].model_serial != model_serial || p->mesh[i].level != level))
        i++;
    return i;
}

bool polygons_have(const struct polygons *p, uint64_t model_serial, uint32_t level)
{
    return find(p, model_serial, level) < MAX_POLYGON_MESHES;
}

static struct polygon_mesh *find_or_upload(struct renderer *r, const struct renderer_model *model,
                                           uint32_t level, struct error *error)
{
    struct polygons *p = &r->polygons;
    int i = find(p, model->serial, level);
    struct polygon_mesh *found =
        i < MAX_POLYGON_MESHES ? &p->mesh[i] : upload(p, &r->made->mesh, model, level, error);
    if (found)
        found->used = ++p->clock;
    return found;
}

/* The framebuffer with these colour planes of the target, and its depths. */
static void attach(struct renderer *r, const GLuint *planes, GLsizei n)
{
    static const GLenum all[4] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                                  GL_COLOR_ATTACHMENT3};
    GLuint framebuffer = r->polygons.framebuffer;
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT); /* the other stages store into these planes */
    for (GLsizei k = 0; k < 4; k++)
        glNamedFramebufferTexture(framebuffer, all[k], k < n ? planes[k] : 0, 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, r->target.seen_depth, 0);
    glNamedFramebufferDrawBuffers(framebuffer, n, all);
}

static void draw(const struct frame_request *request, const struct polygon_mesh *mesh,
                 GLuint program)
{
    float centre[3];
    for (int k = 0; k < 3; k++)
        centre[k] = (float)(mesh->centre[k] - request->camera.eye[k]);
    glUseProgram(program);
    glUniform3fv(glGetUniformLocation(program, "centre"), 1, centre);
    glBindVertexArray(mesh->array);
    glDrawElements(GL_TRIANGLES, mesh->n_indices, GL_UNSIGNED_INT, NULL);
}

bool stage_polygons(struct renderer *r, const struct renderer_model *model,
                    const struct frame_request *request, const struct tile *tile,
                    struct error *error)
{
    static const GLuint no_face[4] = {UINT32_MAX, 0, 0, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0};
    const GLuint planes[4] = {r->target.hit_depth, r->target.normal, r->target.shape,
                              r->target.ptex};
    struct polygons *p = &r->polygons;
    struct polygon_mesh *mesh =
        compile(p, error) ? find_or_upload(r, model, request->surface.level, error) : NULL;
    if (!mesh || !pieces_cover_all(&r->pieces, tile, error))
        return false;
    if (!p->framebuffer)
        glCreateFramebuffers(1, &p->framebuffer);
    attach(r, planes, 4);
    raster_begin(p->framebuffer, tile);
    for (GLint k = 0; k < 3; k++)
        glClearBufferfv(GL_COLOR, k, nothing);
    glClearBufferuiv(GL_COLOR, 3, no_face);
    glClearBufferfv(GL_DEPTH, 0, nothing);
    draw(request, mesh, p->fill);
    return gpu_check("drawing polygons", error);
}

bool stage_wireframe(struct renderer *r, const struct renderer_model *model,
                     const struct frame_request *request, const struct tile *tile,
                     struct error *error)
{
    struct polygons *p = &r->polygons;
    struct polygon_mesh *mesh = find_or_upload(r, model, request->surface.level, error);
    if (!mesh)
        return false;
    attach(r, &r->target.colour, 1);
    raster_begin(p->framebuffer, tile);
    glDepthFunc(GL_EQUAL);
    draw(request, mesh, p->edges);
    return gpu_check("drawing edges", error);
}
