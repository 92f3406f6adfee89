#include "server/render/gl/polygon.h"

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/visibility.h"
#include "server/render/gl/polygon_meshes.h"

/* A program that the frame holds. */
static GLuint program_of(const struct gl_renderer *r, enum single_program which)
{
    const struct program_id id = {.set = SET_SINGLE, .which = which};
    return kept_programs_find(r->programs, &id, NULL);
}

/* The framebuffer with these colour planes of the target, and its depths. */
static void attach(struct gl_renderer *r, const GLuint *planes, GLsizei n)
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

/* Draws a range of indices of one chunk. */
static void draw_run(struct slice *slice, uint32_t number, size_t first, size_t n)
{
    if (n == 0)
        return;
    const struct polygon_chunk *chunk = &slice->mesh->chunk[number];
    glBindVertexArray(chunk->array);
    glDrawElementsBaseVertex(GL_TRIANGLES, (GLsizei)n, GL_UNSIGNED_INT,
                             (const void *)((first - chunk->of.first_index) * sizeof(uint32_t)),
                             -(GLint)chunk->of.first_vertex);
    slice->not_begun += n;
    if (slice->not_begun < slice->at_once)
        return;
    glFlush();
    slice->not_begun = 0;
}

/* Draws the parts that the tile may show; parts that follow each other in a chunk are drawn at
 * once. */
static void draw(struct slice *slice, GLuint program)
{
    const struct polygon_mesh *mesh = slice->mesh;
    struct view_sides sides;
    float centre[3];
    uint32_t chunk = 0;
    size_t first = 0, n = 0;
    view_sides_init(&sides, slice->view, slice->tile);
    for (int k = 0; k < 3; k++)
        centre[k] = (float)(mesh->centre[k] - slice->view->eye[k]);
    glUseProgram(program);
    glUniform3fv(glGetUniformLocation(program, "centre"), 1, centre);
    for (; slice->part < mesh->n_parts; slice->part++) {
        const struct mesh_part *next = &mesh->part[slice->part];
        if (mesh_part_is_outside(next, mesh->centre, slice->view, &sides))
            continue;
        if (slice->left == 0)
            break;
        slice->left -= next->n < slice->left ? next->n : slice->left;
        if (first + n != next->first || chunk != next->chunk || n >= slice->at_once) {
            draw_run(slice, chunk, first, n);
            chunk = next->chunk;
            first = next->first;
            n = 0;
        }
        n += next->n;
    }
    draw_run(slice, chunk, first, n);
}

static void attach_planes(struct gl_renderer *r)
{
    const GLuint planes[4] = {r->target.hit_depth, r->target.normal, r->target.shape,
                              r->target.ptex};
    attach(r, planes, 4);
}

bool stage_polygons_begin(struct gl_renderer *r, const struct tile *tile, struct error *error)
{
    static const GLuint no_face[4] = {UINT32_MAX, 0, 0, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0};
    struct polygon_stage *p = &r->polygons;
    if (!p->framebuffer)
        glCreateFramebuffers(1, &p->framebuffer);
    attach_planes(r);
    raster_begin(p->framebuffer, tile, tile);
    for (GLint k = 0; k < 3; k++)
        glClearBufferfv(GL_COLOR, k, nothing);
    glClearBufferuiv(GL_COLOR, 3, no_face);
    glClearBufferfv(GL_DEPTH, 0, nothing);
    return gpu_check("clearing for polygons", error);
}

bool stage_polygons(struct gl_renderer *r, struct slice *slice, struct error *error)
{
    attach_planes(r);
    raster_begin(r->polygons.framebuffer, slice->tile, slice->tile);
    draw(slice, program_of(r, PROGRAM_POLYGONS));
    return gpu_check("drawing polygons", error);
}

bool stage_wireframe(struct gl_renderer *r, struct slice *slice, struct error *error)
{
    struct polygon_stage *p = &r->polygons;
    attach(r, &r->target.colour, 1);
    raster_begin(p->framebuffer, slice->tile, slice->tile);
    glDepthFunc(GL_EQUAL);
    draw(slice, program_of(r, PROGRAM_WIREFRAME));
    return gpu_check("drawing edges", error);
}
