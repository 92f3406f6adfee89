/* Stage 1: grids over the chosen pieces into the visibility buffer. */
#include "server/gpu/gpu.h"

#include <stdlib.h>

/* Two triangles for each cell of a grid of vertices. */
static void fill_indices(uint32_t *index, uint32_t cells)
{
    for (uint32_t y = 0; y < cells; y++) {
        for (uint32_t x = 0; x < cells; x++) {
            uint32_t a = y * (cells + 1) + x, b = a + cells + 1;
            const uint32_t corners[6] = {a, a + 1, b, b, a + 1, b + 1};
            for (int k = 0; k < 6; k++)
                *index++ = corners[k];
        }
    }
}

bool stage_visibility_init(struct renderer *r, struct error *error)
{
    glCreateBuffers(1, &r->piece_buffer);
    glCreateBuffers(PIECE_BUCKETS, r->grid_buffer);
    for (int b = 0; b < PIECE_BUCKETS; b++) {
        uint32_t cells = 1u << b;
        size_t bytes = (size_t)cells * cells * 6 * sizeof(uint32_t);
        uint32_t *index = malloc(bytes);
        if (!index)
            return error_set(error, ERROR_SERVER, "out of memory");
        fill_indices(index, cells);
        glNamedBufferStorage(r->grid_buffer[b], (GLsizeiptr)bytes, index, 0);
        free(index);
    }
    glCreateVertexArrays(1, &r->vertex_array);
    glEnableVertexArrayAttrib(r->vertex_array, 0);
    glVertexArrayAttribIFormat(r->vertex_array, 0, 4, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(r->vertex_array, 0, 0);
    glVertexArrayBindingDivisor(r->vertex_array, 0, 1);
    return gpu_check("the grids", error);
}

static void draw_bucket(struct renderer *r, GLint grid, int bucket)
{
    const struct piece_list *list = &r->pieces.bucket[bucket];
    if (!list->n)
        return;
    GLsizeiptr bytes = (GLsizeiptr)(list->n * sizeof(struct piece));
    glNamedBufferData(r->piece_buffer, bytes, list->piece, GL_STREAM_DRAW);
    glVertexArrayVertexBuffer(r->vertex_array, 0, r->piece_buffer, 0, sizeof(struct piece));
    glVertexArrayElementBuffer(r->vertex_array, r->grid_buffer[bucket]);
    glUniform1i(grid, 1 << bucket);
    glDrawElementsInstanced(GL_TRIANGLES, 6 << (2 * bucket), GL_UNSIGNED_INT, NULL,
                            (GLsizei)list->n);
}

void stage_visibility(struct renderer *r, const struct renderer_model *model,
                      const struct tile *tile)
{
    static const GLuint none[4] = {UINT32_MAX, 0, 0, 0};
    static const GLfloat farthest = 0; /* reversed depth */
    glBindFramebuffer(GL_FRAMEBUFFER, r->target.framebuffer);
    glViewport(0, 0, (GLsizei)tile->width, (GLsizei)tile->height);
    glScissor(0, 0, (GLsizei)tile->width, (GLsizei)tile->height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glClearBufferuiv(GL_COLOR, 0, none);
    glClearBufferfv(GL_DEPTH, 0, &farthest);

    GLuint program = model->programs->visibility;
    glUseProgram(program);
    banks_bind(&model->nodes, banks_bind(&model->points, 0));
    glBindVertexArray(r->vertex_array);
    GLint grid = glGetUniformLocation(program, "grid");
    for (int b = 0; b < PIECE_BUCKETS; b++)
        draw_bucket(r, grid, b);
}
