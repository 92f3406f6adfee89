/* Which pixels edges of the surface run through (shaders/edges.glsl). */
#include "server/gpu/gpu.h"

#include "server/gpu/program.h"

bool stage_edges_init(struct renderer *r, struct error *error)
{
    r->edges_find = program_create_single(PROGRAM_EDGES_FIND, error);
    return r->edges_find;
}

bool edges_wanted(const struct frame_request *request)
{
    return !request->unfiltered && request->surface.kind == SURFACE_EXACT;
}

void stage_edges(struct renderer *r)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    static const GLfloat nothing[4] = {0, 0, 0, 0};
    const struct target *target = &r->target;
    clear_shaded(r, target->coverage, GL_RED, nothing);
    glNamedBufferSubData(target->edges, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->turns, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->rounded, 0, sizeof no_work, no_work);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, target->edges);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, target->turns);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->rounded);
    glBindImageTexture(0, target->hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    glBindImageTexture(1, target->normal, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(2, target->shape, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    glBindImageTexture(4, target->border, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
    glBindImageTexture(5, target->coverage, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    dispatch_groups(r->edges_find, target->groups);
}
