#include "server/render/gl/shade.h"

#include <math.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"
#include "server/render/gl/gather.h"
#include "server/render/gl/light_image.h"
#include "server/render/gl/context/quirks.h"
#include "server/render/light_block.h"

static struct shade_key key_of(const struct frame_request *request, const struct light *light,
                               enum shaded which)
{
    enum line_family family = request->lines.family;
    const struct pattern *pattern = &light->pattern;
    const struct gl_image *image =
        pattern->kind == PATTERN_IMAGE ? gl_image_of(pattern->image) : NULL;
    const uint8_t kind = family_is_at_infinity(family) ? 0 : (uint8_t)light->kind;
    if (which == SHADED_SHARE || which == SHADED_PLANES) /* the same programs for every pattern */
        return (struct shade_key){
            .family = (uint8_t)family, .light = kind, .which = (uint8_t)which};
    return (struct shade_key){.family = (uint8_t)family,
                              .light = kind,
                              .pattern = (uint8_t)pattern->kind,
                              .soft = pattern->soft > 0 && pattern->kind != PATTERN_RAINBOW &&
                                      pattern->kind != PATTERN_IMAGE,
                              .picture = image ? image_quirks(image->base.pixels) : 0,
                              .has_several = request->n_lights > 1,
                              .which = (uint8_t)which};
}

static struct program_id id_of(const struct frame_request *request, const struct light *light,
                               enum shaded which)
{
    return (struct program_id){.set = SET_SHADING, .shading = key_of(request, light, which)};
}

/* The programs that each of the frame's lights needs, in the order of use. */
static int kinds_of(const struct frame_request *request, enum shaded kinds[SHADED_KINDS])
{
    static const enum shaded closer[] = {SHADED_EDGES, SHADED_HIGH_CURVATURE, SHADED_ROUNDED};
    int n = 0;
    kinds[n++] = request->unfiltered ? SHADED_UNFILTERED : SHADED_ALL;
    for (size_t i = 0; request_has_coverage(request) && i < sizeof closer / sizeof closer[0]; i++)
        kinds[n++] = closer[i];
    if (request_may_miss_light(request))
        kinds[n++] = SHADED_SHARE;
    return n;
}

static bool planes_wanted(const struct frame_request *request)
{
    return request->planes & (PLANE_LIGHT | PLANE_CURVATURE | PLANE_LIGHT_CHANGE);
}

int stage_shade_programs(const struct frame_request *request, struct program_id *ids)
{
    enum shaded kinds[SHADED_KINDS];
    int n_kinds = kinds_of(request, kinds), n = 0;
    for (uint32_t i = 0; i < request->n_lights; i++)
        for (int k = 0; k < n_kinds; k++)
            ids[n++] = id_of(request, &request->lights[i], kinds[k]);
    if (planes_wanted(request)) /* of the foremost light */
        ids[n++] = id_of(request, &request->lights[0], SHADED_PLANES);
    return n;
}

/* The light of the i-th of stage_shade_programs(). */
static uint32_t light_of(const struct frame_request *request, int i)
{
    enum shaded kinds[SHADED_KINDS];
    uint32_t light = (uint32_t)(i / kinds_of(request, kinds));
    return light < request->n_lights ? light : 0;
}

GLuint shade_no_groups(void)
{
    static const GLuint nothing[3] = {0, 1, 1};
    GLuint buffer;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, sizeof nothing, nothing, 0);
    return buffer;
}

GLuint shade_blank_texture(void)
{
    static const uint8_t white[4] = {255, 255, 255, 255};
    GLuint texture;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_RGBA8, 1, 1);
    glTextureSubImage2D(texture, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, white);
    return texture;
}

bool stage_shade_init(struct shade_stage *stage, struct error *error)
{
    glCreateBuffers(1, &stage->light_buffer);
    glNamedBufferData(stage->light_buffer, sizeof(struct light_block), NULL, GL_STREAM_DRAW);
    stage->no_groups = shade_no_groups();
    stage->blank_texture = shade_blank_texture();
    return gpu_check("the shading stage", error);
}

void clear_shaded(const struct gl_renderer *r, GLuint texture, GLenum format, const GLfloat *texel)
{
    const struct tile part = tile_within(&r->drawing.shaded, &r->drawing.place);
    glClearTexSubImage(texture, 0, (GLint)part.x, (GLint)part.y, 0, (GLsizei)part.width,
                       (GLsizei)part.height, 1, format, GL_FLOAT, texel);
}

/* Pixels outside the groups show no surface. */
static void clear_planes(const struct gl_renderer *r, const struct frame_request *request)
{
    static const GLfloat none[4] = {NAN, NAN, NAN, NAN};
    static const GLfloat clear[4] = {0};
    /* The same rule as in shaders/shown.glsl: a clear colour is 0. */
    bool is_clear = request->empty[3] < 0.5f / 255;
    clear_shaded(r, r->target.colour, GL_RGBA, is_clear ? clear : request->empty);
    if (request->planes & PLANE_LIGHT)
        clear_shaded(r, r->target.light, GL_RG, none);
    if (request->planes & PLANE_CURVATURE)
        clear_shaded(r, r->target.curvature, GL_RG, none);
    if (request->planes & PLANE_LIGHT_CHANGE)
        clear_shaded(r, r->target.light_change, GL_RGBA, none);
}

/* An image ends at the light's border, continues around the light, or repeats. */
static GLint wrapping(bool goes_on)
{
    return goes_on ? GL_REPEAT : GL_CLAMP_TO_EDGE;
}

void shade_bind_picture(GLuint texture, const struct frame_request *request,
                        const struct light *light)
{
    glBindTextureUnit(0, texture);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S,
                        wrapping(light_image_repeats_s(request, light)));
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T,
                        wrapping(light_image_repeats_t(request, light)));
}

static void bind_picture(const struct gl_renderer *r, const struct frame_request *request,
                         const struct light *light)
{
    const struct gl_image *image = gl_image_of(light->pattern.image);
    if (image)
        shade_bind_picture(image->texture, request, light);
    else
        glBindTextureUnit(0, r->shade.blank_texture);
}

/* Binds the lights behind light i of those that are drawn, and the planes that it writes. */
static void bind_lights(const struct target *target, uint32_t i)
{
    glBindTextureUnit(1, target->lights[~i & 1]);
    glBindTextureUnit(2, target->missed[~i & 1]);
    glBindTextureUnit(4, target->uneven[~i & 1]);
    glBindImageTexture(6, target->lights[i & 1], 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    glBindImageTexture(7, target->missed[i & 1], 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R16F);
}

/* Sets what differs from program to program. */
static void bind_own(const struct target *target, uint32_t i, enum shaded which)
{
    if (which == SHADED_ALL || which == SHADED_UNFILTERED)
        glBindImageTexture(5, target->uneven[i & 1], 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R16F);
    else if (which == SHADED_HIGH_CURVATURE)
        glBindImageTexture(5, target->square_sum, 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA32F);
    else
        glBindImageTexture(5, target->coverage, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
}

static void bind_planes(const struct target *target, enum shaded which)
{
    glBindImageTexture(0, target->hit_depth, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
    glBindImageTexture(1, target->normal, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(2, target->shape, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    glBindImageTexture(3, target->colour, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    if (which == SHADED_PLANES) {
        glBindImageTexture(4, target->light, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
        glBindImageTexture(5, target->curvature, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
        glBindImageTexture(6, target->light_change, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    } else {
        glBindTextureUnit(3, target->ends);
        glBindImageTexture(4, target->border, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32UI);
    }
}

void shade_run_over_nothing(const struct target *target, GLuint no_groups, enum shaded which,
                            GLuint program)
{
    bind_planes(target, which);
    if (which != SHADED_PLANES) {
        bind_lights(target, 0);
        bind_own(target, 0, which);
    }
    glUseProgram(program);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, no_groups);
    glDispatchComputeIndirect(0);
}

void stage_shade_first_run(struct gl_renderer *r, const struct frame_request *request,
                           bool *has_run_all)
{
    struct program_id ids[MAX_FRAME_PROGRAMS];
    int n = stage_shade_programs(request, ids);
    *has_run_all = true;
    for (int i = 0; *has_run_all && i < n; i++) {
        bool has_run;
        GLuint program = kept_programs_find(r->programs, &ids[i], &has_run);
        if (has_run)
            continue;
        bind_picture(r, request, &request->lights[light_of(request, i)]);
        shade_run_over_nothing(&r->target, r->shade.no_groups, (enum shaded)ids[i].shading.which,
                               program);
        kept_programs_note_run(r->programs, &ids[i]);
        *has_run_all = false;
    }
}

/* Called after all covered pixels have their colours: runs a program that writes the listed pixels'
 * colours again. */
static void dispatch_listed(GLuint program, GLuint list)
{
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, list);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list);
    glUseProgram(program);
    glDispatchComputeIndirect(0);
}

/* Returns a program that the frame holds. */
static GLuint program_of(struct gl_renderer *r, const struct frame_request *request,
                         const struct light *light, enum shaded which)
{
    const struct program_id id = id_of(request, light, which);
    return kept_programs_find(r->programs, &id, NULL);
}

/* Writes the planes of the foremost light, whose block is bound. */
static void shade_planes(struct gl_renderer *r, const struct frame_request *request)
{
    bind_planes(&r->target, SHADED_PLANES);
    dispatch_groups(program_of(r, request, &request->lights[0], SHADED_PLANES), r->target.groups);
}

/* Shades the listed pixels, each list in its own way. */
static void shade_listed(struct gl_renderer *r, const struct frame_request *request, uint32_t i)
{
    const struct light *light = &request->lights[i];
    GLuint rounded = program_of(r, request, light, SHADED_ROUNDED);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT |
                    GL_COMMAND_BARRIER_BIT);
    bind_own(&r->target, i, SHADED_EDGES);
    dispatch_listed(program_of(r, request, light, SHADED_EDGES), r->target.edges);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->target.rounded_hits);
    glProgramUniform1ui(rounded, glGetUniformLocation(rounded, "max_rounded"),
                        tile_max_rounded(&r->drawing.drawn));
    dispatch_listed(rounded, r->target.rounded);
}

/* Counts into the list `unsolved`, which stage 2 no longer needs. */
static void share_light(struct gl_renderer *r, const struct frame_request *request, uint32_t i)
{
    static const GLuint nothing[2] = {0, 0};
    const struct tile *inside = &r->inside;
    GLuint program = program_of(r, request, &request->lights[i], SHADED_SHARE);
    if (i + 1 == request->n_lights)
        glNamedBufferSubData(r->target.unsolved, 0, sizeof nothing, nothing);
    glProgramUniform1ui(program, glGetUniformLocation(program, "stride"),
                        tiles_share_stride(request->width_px, request->height_px));
    glProgramUniform4i(program, glGetUniformLocation(program, "inside"), (GLint)inside->x,
                       (GLint)inside->y, (GLint)inside->width, (GLint)inside->height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, r->target.unsolved);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    dispatch_groups(program, r->target.groups);
}

void shade_read_share(const struct gl_renderer *r, const struct frame_request *request,
                      bool any_seen, struct frame *frame)
{
    GLuint counts[2] = {any_seen, any_seen};
    if (!request->count_light)
        return;
    if (request_may_miss_light(request)) {
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(r->target.unsolved, 0, sizeof counts, counts);
    }
    frame->seen_px += counts[0];
    frame->met_px += counts[1];
}

/* Binds what the programs of light i read and write. */
static void bind_light(struct gl_renderer *r, const struct frame_request *request, uint32_t i)
{
    struct light_block block;
    light_block_fill(&block, request, i);
    glNamedBufferSubData(r->shade.light_buffer, 0, sizeof block, &block);
    bind_picture(r, request, &request->lights[i]);
    bind_lights(&r->target, i);
}

static void shade_light(struct gl_renderer *r, const struct frame_request *request, uint32_t i)
{
    enum shaded all = request->unfiltered ? SHADED_UNFILTERED : SHADED_ALL;
    bind_light(r, request, i);
    bind_planes(&r->target, all);
    bind_own(&r->target, i, all);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, r->target.parts);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
    dispatch_groups(program_of(r, request, &request->lights[i], all), r->target.groups);
    if (request_has_coverage(request))
        shade_listed(r, request, i);
    if (request_may_miss_light(request))
        share_light(r, request, i);
}

/* Number of squares of a pixel that are shaded separately (shaders/high_curvature_shade.comp.glsl). */
enum { SQUARES = 9 };

/* Shades some of the squares with light i, at the pixels that are shaded in parts. */
static void shade_squares(struct gl_renderer *r, const struct frame_request *request, uint32_t i,
                          GLuint first, GLuint end)
{
    GLuint program = program_of(r, request, &request->lights[i], SHADED_HIGH_CURVATURE);
    bind_light(r, request, i);
    bind_own(&r->target, i, SHADED_HIGH_CURVATURE);
    glProgramUniform1ui(program, glGetUniformLocation(program, "first_square"), first);
    glProgramUniform1ui(program, glGetUniformLocation(program, "end_square"), end);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT |
                    GL_SHADER_STORAGE_BARRIER_BIT | GL_COMMAND_BARRIER_BIT);
    dispatch_listed(program, r->target.parts);
}

/* Shades these pixels again: all lights of each square, one square after the other; a single light shades all squares
 * at once. */
static void shade_parts(struct gl_renderer *r, const struct frame_request *request)
{
    GLuint at_once = request->n_lights > 1 ? 1 : SQUARES;
    for (GLuint first = 0; first < SQUARES; first += at_once)
        for (uint32_t i = request->n_lights; i-- > 0;)
            shade_squares(r, request, i, first, first + at_once);
}

bool stage_shade(struct gl_renderer *r, const struct frame_request *request, struct error *error)
{
    static const GLuint no_work[4] = {0, 1, 1, 0};
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, r->shade.light_buffer);
    clear_planes(r, request);
    glNamedBufferSubData(r->target.parts, 0, sizeof no_work, no_work);
    for (uint32_t i = request->n_lights; i-- > 0;) {
        if (!frame_watch_check(&r->watch, error))
            return false;
        shade_light(r, request, i);
    }
    if (request_has_coverage(request))
        shade_parts(r, request);
    if (planes_wanted(request))
        shade_planes(r, request);
    return true;
}
