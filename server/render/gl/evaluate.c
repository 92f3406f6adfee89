#include "server/render/gl/evaluate.h"

#include "server/render/gl/device_internal.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/model.h"
#include "server/render/gl/programs/program.h"

bool stage_evaluate_init(struct evaluate_stage *stage, struct error *error)
{
    stage->recheck = program_create_single(PROGRAM_RECHECK, error);
    stage->gaps = stage->recheck ? program_create_single(PROGRAM_GAPS, error) : 0;
    glCreateBuffers(1, &stage->gap_ends);
    glCreateBuffers(1, &stage->gap_guesses);
    return stage->gaps;
}

static void bind_seen(const struct target *target, GLuint unit)
{
    glBindTextureUnit(unit, target->seen);
    glBindTextureUnit(unit + 1, target->seen_depth);
}

/* Binds the tables and the planes of stage 1. */
static void bind_tables(const struct gl_renderer *r, const struct gl_model *model)
{
    int unit = buffer_textures_bind(&model->points, 0);
    unit = buffer_textures_bind(&model->nodes, unit);
    unit = buffer_textures_bind(&model->adjacency, unit);
    bind_seen(&r->target, (GLuint)unit);
}

static void bind_planes(const struct gl_renderer *r, const struct gl_model *model)
{
    bind_tables(r, model);
    glBindImageTexture(0, r->target.hit_depth, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glBindImageTexture(1, r->target.normal, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glBindImageTexture(2, r->target.shape, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    glBindImageTexture(3, r->target.ptex, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32UI);
    glBindImageTexture(4, r->target.border, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
}

/* Runs the current program over the pixels of a list, once the list is complete. */
static void solve_listed(GLuint list)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, list);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list);
    glDispatchComputeIndirect(0);
}

/* Adds to the unsolved pixels those whose depth does not agree with the depths beside it. */
static void recheck(const struct gl_renderer *r)
{
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    bind_seen(&r->target, 0);
    glBindImageTexture(0, r->target.hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    dispatch_groups(r->evaluate.recheck, r->target.discontinuous);
}

void stage_evaluate(struct gl_renderer *r, const struct gl_model *model,
                    const struct table_programs *programs)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    const struct target *target = &r->target;
    GLint n_asked = glGetUniformLocation(programs->unsolved, "n_asked");
    glNamedBufferSubData(target->retry_pixels, 0, sizeof no_work, no_work);
    glNamedBufferSubData(target->unsolved, 0, sizeof no_work, no_work);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, target->retry_pixels);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->unsolved);
    bind_planes(r, model);
    glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    dispatch_groups(programs->evaluate, target->groups);
    glUseProgram(programs->unsolved);
    glUniform1i(n_asked, 1);
    solve_listed(target->retry_pixels);
    recheck(r);
    bind_planes(r, model);
    glUseProgram(programs->unsolved);
    glUniform1i(n_asked, 5);
    solve_listed(target->unsolved);
}

/* --- gaps */

/* Lists the pixels in gaps; the list retry_pixels, which is no longer needed, takes them.
 * Returns how many there are; waits for the device. */
static GLuint find_gaps(const struct gl_renderer *r)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    const struct target *target = &r->target;
    GLuint head[4] = {0};
    glNamedBufferSubData(target->retry_pixels, 0, sizeof no_work, no_work);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    bind_seen(target, 0);
    glBindImageTexture(0, target->hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    glBindImageTexture(1, target->seen, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RG32UI);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, target->retry_pixels);
    glUseProgram(r->evaluate.gaps);
    solve_listed(target->unsolved);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    glGetNamedBufferSubData(target->retry_pixels, 0, sizeof head, head);
    return head[3];
}

/* Finds the guesses for each of the listed pixels, x | y << 16. end[i]: end of pixel i's guesses in
 * the list of all. */
static bool guess_gaps(struct gl_renderer *r, const struct gl_model *model, const struct view *view,
                       const uint32_t *at, size_t n, uint32_t *end, struct error *error)
{
    const struct tile *place = &r->drawing.place;
    r->grids.n_guesses = 0;
    for (size_t i = 0; i < n; i++) {
        const struct tile pixel = {place->x + (at[i] & 0xffff), place->y + (at[i] >> 16), 1, 1};
        if (!frame_watch_check(&r->watch, error) ||
            !patch_grids_guess(&r->grids, model->base.tables, &model->clusters, view, &pixel,
                               error))
            return false;
        end[i] = (uint32_t)r->grids.n_guesses;
    }
    return true;
}

bool stage_gaps(struct gl_renderer *r, const struct gl_model *model,
                const struct table_programs *programs, const struct view *view, struct error *error)
{
    uint32_t at[MAX_GAPS] = {0}, end[MAX_GAPS];
    GLuint n = find_gaps(r);
    r->evaluate.too_many_gaps = n > MAX_GAPS;
    if (n == 0 || n > MAX_GAPS)
        return true;
    glGetNamedBufferSubData(r->target.retry_pixels, LIST_HEAD_BYTES, (GLsizeiptr)(n * sizeof *at),
                            at);
    if (!guess_gaps(r, model, view, at, n, end, error))
        return false;
    glNamedBufferData(r->evaluate.gap_ends, (GLsizeiptr)(n * sizeof *end), end, GL_STREAM_DRAW);
    glNamedBufferData(r->evaluate.gap_guesses,
                      (GLsizeiptr)(r->grids.n_guesses * sizeof(struct guess)), r->grids.guess,
                      GL_STREAM_DRAW);
    bind_planes(r, model);
    glUseProgram(programs->unsolved);
    glUniform1i(glGetUniformLocation(programs->unsolved, "n_asked"), 0);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, r->evaluate.gap_ends);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->evaluate.gap_guesses);
    solve_listed(r->target.retry_pixels);
    return true;
}

void stage_ends(struct gl_renderer *r, const struct gl_model *model,
                const struct table_programs *programs)
{
    bind_tables(r, model);
    glBindImageTexture(5, r->target.ends, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RG32UI);
    glUseProgram(programs->ends);
    solve_listed(r->target.retry_pixels);
}

void stage_rounded(struct gl_renderer *r, const struct gl_model *model,
                   const struct table_programs *programs)
{
    bind_tables(r, model);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->target.rounded_hits);
    glUseProgram(programs->rounded);
    glUniform1ui(glGetUniformLocation(programs->rounded, "max_rounded"),
                 tile_max_rounded(&r->drawing.drawn));
    solve_listed(r->target.rounded);
}
