#include "server/render/gl/edges.h"

#include "server/render/gl/device_internal.h"
#include "server/render/gl/shade.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/programs/program.h"

bool stage_edges_init(struct edges_stage *stage, struct error *error)
{
    stage->find = program_create_single(PROGRAM_EDGES_FIND, error);
    stage->recheck = stage->find ? program_create_single(PROGRAM_EDGES_RECHECK, error) : 0;
    return stage->recheck;
}

void stage_edges(struct gl_renderer *r, const struct tile *shaded)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0};
    const struct target *target = &r->target;
    clear_shaded(r, target->coverage, GL_RED, nothing);
    glNamedBufferSubData(target->unsolved, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->edges, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->rounded, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->retry_pixels, 0, sizeof no_work, no_work);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, target->unsolved);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->rounded);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, target->retry_pixels);
    glBindImageTexture(0, target->hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    glBindImageTexture(1, target->normal, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(2, target->shape, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    glBindImageTexture(4, target->border, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
    glBindImageTexture(5, target->coverage, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glBindImageTexture(6, target->ends, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32UI);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glProgramUniform4i(r->edges.find, glGetUniformLocation(r->edges.find, "shaded"),
                       (GLint)shaded->x, (GLint)shaded->y, (GLint)shaded->width,
                       (GLint)shaded->height);
    dispatch_groups(r->edges.find, target->groups);
}

void stage_edges_recheck(struct gl_renderer *r)
{
    const struct target *target = &r->target;
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    glBindImageTexture(0, target->hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    glBindImageTexture(1, target->normal, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(2, target->shape, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    glBindImageTexture(4, target->border, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
    glBindTextureUnit(3, target->ends);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, target->unsolved);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, target->edges);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->rounded);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, target->unsolved);
    glUseProgram(r->edges.recheck);
    glDispatchComputeIndirect(0);
}
