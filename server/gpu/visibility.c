/* Stage 1: grids over the chosen pieces into the visibility buffer. */
#include "server/gpu/gpu.h"

#include <stdlib.h>

/* Pieces drawn by one instance of a bucket: about as many vertices in each. */
static int pieces_per_instance(int bucket)
{
    return bucket < 4 ? 256 >> (2 * bucket) : 1;
}

/* Two triangles for each cell of a grid of vertices that start at `first`. */
static uint32_t *fill_indices(uint32_t *index, uint32_t cells, uint32_t first)
{
    for (uint32_t y = 0; y < cells; y++) {
        for (uint32_t x = 0; x < cells; x++) {
            uint32_t a = first + y * (cells + 1) + x, b = a + cells + 1;
            const uint32_t corners[6] = {a, a + 1, b, b, a + 1, b + 1};
            for (int k = 0; k < 6; k++)
                *index++ = corners[k];
        }
    }
    return index;
}

static bool make_grid(struct renderer *r, int bucket, struct error *error)
{
    uint32_t cells = 1u << bucket, pieces = (uint32_t)pieces_per_instance(bucket);
    size_t bytes = (size_t)cells * cells * 6 * pieces * sizeof(uint32_t);
    uint32_t *index = malloc(bytes);
    if (!index)
        return error_set(error, ERROR_SERVER, "out of memory");
    uint32_t *at = index;
    for (uint32_t k = 0; k < pieces; k++)
        at = fill_indices(at, cells, k * (cells + 1) * (cells + 1));
    glNamedBufferStorage(r->grid_buffer[bucket], (GLsizeiptr)bytes, index, 0);
    free(index);
    return true;
}

bool stage_visibility_init(struct renderer *r, struct error *error)
{
    glCreateBuffers(PIECE_BUCKETS, r->grid_buffer);
    for (int b = 0; b < PIECE_BUCKETS; b++)
        if (!make_grid(r, b, error))
            return false;
    glCreateVertexArrays(1, &r->vertex_array);
    glCreateBuffers(1, &r->piece_buffer);
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &r->piece_texture);
    return gpu_check("the grids", error);
}

/* Pieces [first, first + n) of a bucket, at most as many as a buffer texture holds. */
static void draw_pieces(struct renderer *r, GLuint program, int bucket, size_t first, size_t n)
{
    int per_instance = pieces_per_instance(bucket);
    const struct piece *pieces = r->pieces.bucket[bucket].piece + first;
    glNamedBufferData(r->piece_buffer, (GLsizeiptr)(n * sizeof *pieces), pieces, GL_STREAM_DRAW);
    glTextureBuffer(r->piece_texture, GL_RGBA32UI, r->piece_buffer);
    glVertexArrayElementBuffer(r->vertex_array, r->grid_buffer[bucket]);
    glUniform1i(glGetUniformLocation(program, "grid"), 1 << bucket);
    glUniform1i(glGetUniformLocation(program, "n_pieces"), (GLint)n);
    glUniform1i(glGetUniformLocation(program, "pieces_per_instance"), per_instance);
    glDrawElementsInstanced(GL_TRIANGLES, (6 << (2 * bucket)) * per_instance, GL_UNSIGNED_INT, NULL,
                            (GLsizei)((n + (size_t)per_instance - 1) / (size_t)per_instance));
}

void raster_begin(GLuint framebuffer, const struct tile *tile)
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, (GLsizei)tile->width, (GLsizei)tile->height);
    glScissor(0, 0, (GLsizei)tile->width, (GLsizei)tile->height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
}

/* What stage 1 draws on; and what stage 2 leaves alone where nothing is seen, since a framebuffer
 * is cleared by all of a software device's threads. */
static void clear(const struct renderer *r, bool want_ptex)
{
    static const GLenum planes[3] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1,
                                     GL_COLOR_ATTACHMENT2};
    static const GLuint none[4] = {UINT32_MAX, 0, 0, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0}; /* a depth of 0 is farthest: reversed */
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

void stage_visibility(struct renderer *r, const struct renderer_model *model,
                      const struct table_programs *programs, const struct tile *tile)
{
    raster_begin(r->target.framebuffer, tile);
    clear(r, programs->ptex);
    GLuint program = programs->visibility;
    glUseProgram(program);
    banks_bind(&model->nodes, banks_bind(&model->points, 0));
    glBindTextureUnit((GLuint)(model->points.n + model->nodes.n + model->adjacency.n),
                      r->piece_texture);
    glBindVertexArray(r->vertex_array);
    for (int b = 0; b < PIECE_BUCKETS; b++) {
        size_t n = r->pieces.bucket[b].n, most = r->info.max_texels;
        for (size_t first = 0; first < n; first += most)
            draw_pieces(r, program, b, first, n - first < most ? n - first : most);
    }
}
