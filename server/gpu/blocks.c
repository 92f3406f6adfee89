/* The covered blocks of a tile, one workgroup each (shaders/blocks.glsl). */
#include "server/gpu/gpu.h"

void blocks_upload(struct renderer *r)
{
    size_t n = r->pieces.n_blocks;
    glNamedBufferData(r->block_buffer, (GLsizeiptr)((n ? n : 1) * sizeof(uint32_t)),
                      n ? r->pieces.block : NULL, GL_STREAM_DRAW);
}

/* Groups in one dimension are limited (to 65,535 at least), so blocks go in rows. */
void dispatch_blocks(struct renderer *r, GLuint program)
{
    enum { ROW = 32768 };
    size_t n = r->pieces.n_blocks;
    glUniform1ui(glGetUniformLocation(program, "n_blocks"), (GLuint)n);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, r->block_buffer);
    if (n)
        glDispatchCompute((GLuint)(n < ROW ? n : ROW), (GLuint)((n + ROW - 1) / ROW), 1);
}

bool blocks_leave_gaps(const struct renderer *r, const struct tile *tile)
{
    size_t across = (tile->width + COVER_BLOCK_PX - 1) / COVER_BLOCK_PX;
    size_t down = (tile->height + COVER_BLOCK_PX - 1) / COVER_BLOCK_PX;
    return r->pieces.n_blocks < across * down;
}
