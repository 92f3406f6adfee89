#include "server/gpu/renderer.h"

#include <stdlib.h>

#include "server/gpu/gpu.h"

static void query_info(struct renderer *r, size_t max_texels)
{
    GLint texels = 0, texture = 0, viewport[2] = {0, 0};
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    GLint width = texture < viewport[0] ? texture : viewport[0];
    GLint height = texture < viewport[1] ? texture : viewport[1];
    r->info = (struct renderer_info){
        .device = (const char *)glGetString(GL_RENDERER),
        .driver = (const char *)glGetString(GL_VERSION),
        .software = r->egl.software,
        .max_width_px = (uint32_t)width,
        .max_height_px = (uint32_t)height,
        .max_texels = (size_t)texels,
    };
    if (max_texels && max_texels < r->info.max_texels)
        r->info.max_texels = max_texels;
}

struct renderer *renderer_create(const struct renderer_options *options, struct error *error)
{
    struct renderer *r = calloc(1, sizeof *r);
    if (!r) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    if (!egl_init(&r->egl, options->device ? options->device : "auto", error)) {
        free(r);
        return NULL;
    }
    query_info(r, options->max_texels);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glCreateBuffers(1, &r->view_buffer);
    glNamedBufferData(r->view_buffer, sizeof(struct view_block), NULL, GL_STREAM_DRAW);
    if (!stage_visibility_init(r, error) || !stage_gather_init(r, error) ||
        !stage_edges_init(r, error) || !stage_shade_init(r, error)) {
        renderer_destroy(r);
        return NULL;
    }
    return r;
}

void renderer_destroy(struct renderer *r)
{
    if (!r)
        return;
    /* GL objects go with their context. */
    egl_finish(&r->egl);
    pieces_finish(&r->pieces);
    free(r);
}

const struct renderer_info *renderer_info(const struct renderer *r)
{
    return &r->info;
}

struct renderer_image *renderer_image_create(struct renderer *r, const struct image *image,
                                             struct error *error)
{
    struct renderer_image *out = calloc(1, sizeof *out);
    if (!out) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    if (image->width_px > r->info.max_width_px || image->height_px > r->info.max_height_px) {
        error_set(error, ERROR_IMAGE, "the image is %ux%u, more than the device's %ux%u",
                  image->width_px, image->height_px, r->info.max_width_px, r->info.max_height_px);
        free(out);
        return NULL;
    }
    out->is_linear = image->is_linear;
    uint32_t larger = image->width_px > image->height_px ? image->width_px : image->height_px;
    GLsizei levels = 32 - __builtin_clz(larger);
    glCreateTextures(GL_TEXTURE_2D, 1, &out->texture);
    glTextureStorage2D(out->texture, levels, image->is_float ? GL_RGBA16F : GL_RGBA8,
                       (GLsizei)image->width_px, (GLsizei)image->height_px);
    glTextureSubImage2D(out->texture, 0, 0, 0, (GLsizei)image->width_px, (GLsizei)image->height_px,
                        GL_RGBA, image->is_float ? GL_FLOAT : GL_UNSIGNED_BYTE, image->pixels);
    glGenerateTextureMipmap(out->texture);
    glTextureParameteri(out->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(out->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(out->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(out->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (!gpu_check("a light image", error)) {
        renderer_image_destroy(r, out);
        return NULL;
    }
    return out;
}

void renderer_image_destroy(struct renderer *r, struct renderer_image *image)
{
    (void)r;
    if (!image)
        return;
    glDeleteTextures(1, &image->texture);
    free(image);
}
