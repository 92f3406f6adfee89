/* Stage 3: the light in the mirror. */
#include "server/gpu/gpu.h"

#include <math.h>
#include <stdio.h>

#include "server/gpu/program.h"
#include "server/limit/vec.h"

/* std140 block `Light` of shaders/shade.comp.glsl. */
struct light_block {
    float centre[4], normal_uv[4], dual_u[4], dual_v[4], size[4];
    float foreground[4], background[4], miss[4], empty[4];
    float pattern[4];
    int32_t want[4];
};

static GLuint shade_program(struct renderer *r, enum pattern_kind kind, struct error *error)
{
    static const char *const files[] = {"view.glsl",     "blocks.glsl",     "basis.glsl",
                                        "coverage.glsl", "shade.comp.glsl", NULL};
    if (!r->shade[kind]) {
        char defines[32];
        snprintf(defines, sizeof defines, "#define PATTERN %d\n", kind);
        r->shade[kind] = program_compute(defines, files, error);
    }
    return r->shade[kind];
}

bool stage_shade_init(struct renderer *r, struct error *error)
{
    static const uint8_t white[4] = {255, 255, 255, 255};
    if (!shade_program(r, PATTERN_STRIPES, error))
        return false;
    glCreateBuffers(1, &r->light_buffer);
    glNamedBufferData(r->light_buffer, sizeof(struct light_block), NULL, GL_STREAM_DRAW);
    glCreateTextures(GL_TEXTURE_2D, 1, &r->blank_texture);
    glTextureStorage2D(r->blank_texture, 1, GL_RGBA8, 1, 1);
    glTextureSubImage2D(r->blank_texture, 0, 0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, white);
    return gpu_check("the shading stage", error);
}

static void put(struct vec v, float out[4])
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

static void fill_light(struct light_block *block, const struct frame_request *request)
{
    *block = (struct light_block){0};
    struct vec u = get(request->light.u), v = get(request->light.v);
    struct vec m = vec_cross(u, v);
    double area2 = vec_dot(m, m);
    put(vec_sub(get(request->light.centre), get(request->camera.eye)), block->centre);
    put(vec_unit(m), block->normal_uv);
    /* The dual basis in the plane: dual_u . u = 1, dual_u . v = 0. */
    put(vec_scale(vec_cross(v, m), 1 / area2), block->dual_u);
    put(vec_scale(vec_cross(m, u), 1 / area2), block->dual_v);
    block->size[0] = (float)vec_length(u);
    block->size[1] = (float)vec_length(v);
    for (int k = 0; k < 4; k++) {
        block->foreground[k] = request->pattern.foreground[k];
        block->background[k] = request->pattern.background[k];
        block->miss[k] = request->miss[k];
        block->empty[k] = request->empty[k];
    }
    block->pattern[0] = (float)request->pattern.count;
    block->pattern[1] = (float)request->pattern.duty;
    block->want[0] = (request->planes & PLANE_LIGHT) != 0;
    block->want[1] = (request->planes & PLANE_CURVATURE) != 0;
}

/* What lies outside the covered area shows no surface. */
static void clear_planes(const struct renderer *r, const struct frame_request *request)
{
    static const GLfloat none[2] = {NAN, NAN};
    glClearTexImage(r->target.colour, 0, GL_RGBA, GL_FLOAT, request->empty);
    if (request->planes & PLANE_LIGHT)
        glClearTexImage(r->target.light, 0, GL_RG, GL_FLOAT, none);
    if (request->planes & PLANE_CURVATURE)
        glClearTexImage(r->target.curvature, 0, GL_RG, GL_FLOAT, none);
}

bool stage_shade(struct renderer *r, const struct frame_request *request, const struct tile *tile,
                 struct error *error)
{
    GLuint program = shade_program(r, request->pattern.kind, error);
    if (!program)
        return false;
    struct light_block block;
    fill_light(&block, request);
    glNamedBufferSubData(r->light_buffer, 0, sizeof block, &block);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glUseProgram(program);
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, r->light_buffer);
    const struct renderer_image *image = request->pattern.image;
    glBindTextureUnit(0, image ? image->texture : r->blank_texture);
    glBindImageTexture(0, r->target.position, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(1, r->target.normal, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F);
    glBindImageTexture(2, r->target.shape, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RG32F);
    glBindImageTexture(3, r->target.colour, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    glBindImageTexture(4, r->target.light, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    glBindImageTexture(5, r->target.curvature, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    if (blocks_leave_gaps(r, tile))
        clear_planes(r, request);
    dispatch_blocks(r, program);
    return true;
}
