/* Stage 2: the pixel's ray against the limit surface, in three passes. */
#include "server/gpu/gpu.h"

static void set_uniforms(GLuint program, bool want_ptex)
{
    glUseProgram(program);
    glUniform1i(glGetUniformLocation(program, "want_ptex"), want_ptex);
}

static void bind_planes(const struct renderer *r, const struct renderer_model *model)
{
    int unit = banks_bind(&model->points, 0);
    unit = banks_bind(&model->nodes, unit);
    unit = banks_bind(&model->adjacency, unit);
    glBindTextureUnit((GLuint)unit, r->target.seen);
    glBindTextureUnit((GLuint)unit + 1, r->target.seen_depth);
    glBindImageTexture(0, r->target.position, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glBindImageTexture(1, r->target.normal, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glBindImageTexture(2, r->target.shape, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    glBindImageTexture(3, r->target.ptex, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    glBindImageTexture(4, r->target.border, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
}

/* The pixels of a list, once it is complete. */
static void dispatch_listed(GLuint program, GLuint list, bool around, bool want_ptex)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    set_uniforms(program, want_ptex);
    glUniform1i(glGetUniformLocation(program, "around"), around);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, list);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list);
    glDispatchComputeIndirect(0);
}

void stage_evaluate(struct renderer *r, const struct renderer_model *model, bool want_ptex)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    const struct table_programs *programs = model->programs;
    glNamedBufferSubData(r->target.strays, 0, sizeof no_work, no_work);
    glNamedBufferSubData(r->target.unsolved, 0, sizeof no_work, no_work);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, r->target.strays);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, r->target.unsolved);
    bind_planes(r, model);
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    set_uniforms(programs->evaluate, want_ptex);
    dispatch_groups(r, programs->evaluate);
    dispatch_listed(programs->unsolved, r->target.strays, false, want_ptex);
    dispatch_listed(programs->unsolved, r->target.unsolved, true, want_ptex);
}
