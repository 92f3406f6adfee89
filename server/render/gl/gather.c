#include "server/render/gl/gather.h"

#include "server/render/gl/device_internal.h"
#include "server/render/gl/programs/program.h"

bool stage_gather_init(struct gather_stage *stage, struct error *error)
{
    stage->program = program_create_single(PROGRAM_GATHER, error);
    glCreateBuffers(1, &stage->block_buffer);
    return stage->program;
}

void stage_gather(struct gl_renderer *r)
{
    enum { BLOCKS_PER_GROUP = 8 };
    static const GLuint no_work[4] = {0, 1, 1, 0};
    size_t n = r->grids.n_blocks, groups = (n + BLOCKS_PER_GROUP - 1) / BLOCKS_PER_GROUP;
    glNamedBufferSubData(r->target.groups, 0, sizeof no_work, no_work);
    glNamedBufferSubData(r->target.discontinuous, 0, sizeof no_work, no_work);
    if (!n)
        return;
    glNamedBufferData(r->gather.block_buffer, (GLsizeiptr)(n * sizeof *r->grids.block),
                      r->grids.block, GL_STREAM_DRAW);
    glUseProgram(r->gather.program);
    glUniform1ui(glGetUniformLocation(r->gather.program, "n_blocks"), (GLuint)n);
    glBindTextureUnit(1, r->target.seen_depth);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, r->target.groups);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->gather.block_buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, r->target.discontinuous);
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    glDispatchCompute((GLuint)(groups < GROUP_ROW ? groups : GROUP_ROW),
                      (GLuint)((groups + GROUP_ROW - 1) / GROUP_ROW), 1);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
}

bool gather_found_any(const struct gl_renderer *r)
{
    GLuint workgroups = 0;
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(r->target.groups, 0, sizeof workgroups, &workgroups);
    return workgroups > 0;
}

void dispatch_groups(GLuint program, GLuint groups)
{
    glUseProgram(program);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, groups);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, groups);
    glDispatchComputeIndirect(0);
}
