#include "server/render/gl/visibility.h"

#include <stdlib.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/model.h"
#include "server/render/gl/context/quirks.h"

/* Number of a grid's cells along u and v. */
static uint32_t cells_along(int shape, int side)
{
    return grid_cells[side ? shape % GRID_SIDES : shape / GRID_SIDES];
}

/* Number of grids that one instance draws: about the same number of cells for each shape. */
static uint32_t grids_per_instance(int shape)
{
    uint32_t cells = cells_along(shape, 0) * cells_along(shape, 1);
    return cells < 256 ? 256 / cells : 1;
}

static uint32_t indices_per_instance(int shape)
{
    return 6 * cells_along(shape, 0) * cells_along(shape, 1) * grids_per_instance(shape);
}

/* Writes the indices of two triangles for each cell of a grid whose vertices start at `first`. */
static uint32_t *fill_indices(uint32_t *index, int shape, uint32_t first)
{
    uint32_t across = cells_along(shape, 0), down = cells_along(shape, 1);
    for (uint32_t y = 0; y < down; y++) {
        for (uint32_t x = 0; x < across; x++) {
            uint32_t a = first + y * (across + 1) + x, b = a + across + 1;
            const uint32_t corners[6] = {a, a + 1, b, b, a + 1, b + 1};
            for (int k = 0; k < 6; k++)
                *index++ = corners[k];
        }
    }
    return index;
}

bool stage_visibility_init(struct visibility_stage *stage, struct error *error)
{
    size_t n = 0;
    for (int g = 0; g < GRID_SHAPES; g++) {
        stage->index_first[g] = n;
        n += indices_per_instance(g);
    }
    uint32_t *index = malloc(n * sizeof *index), *at = index;
    if (!index)
        return error_set(error, ERROR_SERVER, "out of memory");
    for (int g = 0; g < GRID_SHAPES; g++)
        for (uint32_t k = 0; k < grids_per_instance(g); k++)
            at = fill_indices(at, g, k * (cells_along(g, 0) + 1) * (cells_along(g, 1) + 1));
    glCreateBuffers(1, &stage->index_buffer);
    glNamedBufferStorage(stage->index_buffer, (GLsizeiptr)(n * sizeof *index), index, 0);
    free(index);
    glCreateVertexArrays(1, &stage->vertex_array);
    glVertexArrayElementBuffer(stage->vertex_array, stage->index_buffer);
    glCreateBuffers(1, &stage->grid_buffer);
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &stage->grid_texture);
    return gpu_check("the grids", error);
}

/* Draws the grids [first, first + n) of those on the device, all of one shape. */
static void draw_grids(const struct gl_renderer *r, GLuint program, int shape, size_t first,
                       size_t n)
{
    uint32_t per_instance = grids_per_instance(shape);
    glUniform2i(glGetUniformLocation(program, "grid"), (GLint)cells_along(shape, 0),
                (GLint)cells_along(shape, 1));
    glUniform1i(glGetUniformLocation(program, "first_grid"), (GLint)first);
    glUniform1i(glGetUniformLocation(program, "n_grids"), (GLint)n);
    glUniform1i(glGetUniformLocation(program, "grids_per_instance"), (GLint)per_instance);
    glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)indices_per_instance(shape), GL_UNSIGNED_INT,
                            (const void *)(r->visibility.index_first[shape] * sizeof(uint32_t)),
                            (GLsizei)((n + per_instance - 1) / per_instance));
}

static size_t cut(size_t i, size_t low, size_t high)
{
    return i < low ? low : i < high ? i : high;
}

/* Draws the grids [begin, end), at most as many as a buffer texture holds. */
static void draw_range(struct gl_renderer *r, GLuint program, size_t begin, size_t end)
{
    const struct patch_grids *grids = &r->grids;
    size_t cells = 0, grid_bytes = sizeof *grids->grid; /* a power of two */
    glNamedBufferData(r->visibility.grid_buffer,
                      (GLsizeiptr)(no_power_of_two(end - begin) * grid_bytes), NULL,
                      GL_STREAM_DRAW);
    glNamedBufferSubData(r->visibility.grid_buffer, 0, (GLsizeiptr)((end - begin) * grid_bytes),
                         grids->grid + begin);
    glTextureBuffer(r->visibility.grid_texture, GL_RGBA32UI, r->visibility.grid_buffer);
    for (int g = 0; g < GRID_SHAPES; g++) {
        size_t first = cut(grids->first[g], begin, end);
        size_t n = cut(grids->first[g + 1], begin, end) - first;
        if (!n)
            continue;
        draw_grids(r, program, g, first - begin, n);
        cells += n * cells_along(g, 0) * cells_along(g, 1);
        if (cells > FLUSH_CELLS) {
            glFlush();
            cells = 0;
        }
    }
}

void raster_begin(GLuint framebuffer, const struct tile *place, const struct tile *drawn)
{
    const struct tile part = tile_within(drawn, place);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, (GLsizei)place->width, (GLsizei)place->height);
    glScissor((GLint)part.x, (GLint)part.y, (GLsizei)part.width, (GLsizei)part.height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

/* Clears the planes that stage 1 draws into, and those that stage 2 does not write where nothing is
 * seen. Both use a framebuffer clear, which a software device does on all its threads. */
static void clear(const struct gl_renderer *r, bool want_ptex)
{
    static const GLenum planes[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                     GL_COLOR_ATTACHMENT2};
    static const GLuint none[4] = {UINT32_MAX, 0, 0, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0}; /* depths are reversed: 0 is farthest */
    GLuint framebuffer = r->target.framebuffer;
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
    glNamedFramebufferDrawBuffers(framebuffer, want_ptex ? 3 : 2, planes);
    glClearBufferuiv(GL_COLOR, 0, none);
    glClearBufferfv(GL_COLOR, 1, nothing);
    if (want_ptex)
        glClearBufferuiv(GL_COLOR, 2, none);
    glClearBufferfv(GL_DEPTH, 0, nothing);
    glNamedFramebufferDrawBuffers(framebuffer, 1, planes);
}

void stage_visibility(struct gl_renderer *r, const struct gl_model *model,
                      const struct table_programs *programs)
{
    raster_begin(r->target.framebuffer, &r->drawing.place, &r->drawing.drawn);
    clear(r, programs->ptex);
    GLuint program = programs->visibility;
    glUseProgram(program);
    buffer_textures_bind(&model->nodes, buffer_textures_bind(&model->points, 0));
    glBindTextureUnit((GLuint)(model->points.n + model->nodes.n + model->adjacency.n),
                      r->visibility.grid_texture);
    glBindVertexArray(r->visibility.vertex_array);
    size_t n = r->grids.first[GRID_SHAPES], most = r->max_texels;
    for (size_t begin = 0; begin < n; begin += most)
        draw_range(r, program, begin, n - begin < most ? n : begin + most);
}
