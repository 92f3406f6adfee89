/* Stage 2: the pixel's ray against the limit surface, in four passes. */
#include "server/gpu/gpu.h"

#include "server/gpu/program.h"

bool stage_evaluate_init(struct renderer *r, struct error *error)
{
    r->doubt = program_create_single(PROGRAM_DOUBT, error);
    return r->doubt;
}

static void bind_seen(const struct target *target, GLuint unit)
{
    glBindTextureUnit(unit, target->seen);
    glBindTextureUnit(unit + 1, target->seen_depth);
}

/* The tables, and what stage 1 left. */
static void bind_tables(const struct renderer *r, const struct renderer_model *model)
{
    int unit = banks_bind(&model->points, 0);
    unit = banks_bind(&model->nodes, unit);
    unit = banks_bind(&model->adjacency, unit);
    bind_seen(&r->target, (GLuint)unit);
}

static void bind_planes(const struct renderer *r, const struct renderer_model *model)
{
    bind_tables(r, model);
    glBindImageTexture(0, r->target.hit_depth, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glBindImageTexture(1, r->target.normal, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glBindImageTexture(2, r->target.shape, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    glBindImageTexture(3, r->target.ptex, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    glBindImageTexture(4, r->target.border, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
}

/* The pixels of a list, once it is complete, with the program in use. */
static void solve_listed(GLuint list)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, list);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list);
    glDispatchComputeIndirect(0);
}

/* Adds to the unsolved ones what only the depths beside it give away. */
static void doubt(const struct renderer *r)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    bind_seen(&r->target, 0);
    glBindImageTexture(0, r->target.hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    dispatch_groups(r->doubt, r->target.restless);
}

void stage_evaluate(struct renderer *r, const struct renderer_model *model,
                    const struct table_programs *programs)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    const struct target *target = &r->target;
    GLint around = glGetUniformLocation(programs->unsolved, "around");
    glNamedBufferSubData(target->strays, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->unsolved, 0, sizeof no_work, no_work);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, target->strays);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->unsolved);
    bind_planes(r, model);
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    dispatch_groups(programs->evaluate, target->groups);
    glUseProgram(programs->unsolved);
    glUniform1i(around, false);
    solve_listed(target->strays);
    doubt(r);
    bind_planes(r, model);
    glUseProgram(programs->unsolved);
    glUniform1i(around, true);
    solve_listed(target->unsolved);
}

void stage_rounded(struct renderer *r, const struct renderer_model *model,
                   const struct table_programs *programs)
{
    bind_tables(r, model);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->target.rounded_hits);
    glUseProgram(programs->rounded);
    glUniform1ui(glGetUniformLocation(programs->rounded, "max_rounded"),
                 target_max_rounded(&r->drawing.drawn));
    solve_listed(r->target.rounded);
}
