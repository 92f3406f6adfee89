#include "server/render/gl/light_image.h"

#include <stdlib.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/device_internal.h"

size_t gl_image_bytes(const struct image *image)
{
    size_t texels = (size_t)image->width_px * image->height_px;
    return (texels + texels / 3) * (image->is_float ? 8 : 4); /* RGBA16F or SRGB8_ALPHA8 */
}

GLuint light_texture_create(const struct image *pixels)
{
    GLuint texture;
    GLsizei width = (GLsizei)pixels->width_px, height = (GLsizei)pixels->height_px;
    GLsizei levels = 32 - __builtin_clz((unsigned)(width > height ? width : height));
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, levels, pixels->is_float ? GL_RGBA16F : GL_SRGB8_ALPHA8, width,
                       height);
    glTextureSubImage2D(texture, 0, 0, 0, width, height, GL_RGBA,
                        pixels->is_float ? GL_FLOAT : GL_UNSIGNED_BYTE, pixels->pixels);
    glGenerateTextureMipmap(texture);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

bool gl_image_upload(struct gl_renderer *r, struct gl_image *image, struct error *error)
{
    if (context_is_current(&r->context, image->context))
        return true;
    image->texture = light_texture_create(image->base.pixels);
    if (!gpu_check("a light image", error)) {
        glDeleteTextures(1, &image->texture);
        return false;
    }
    image->context = r->context.number;
    return true;
}

struct gl_image *gl_image_create(const struct image *pixels, struct error *error)
{
    struct gl_image *image = calloc(1, sizeof *image);
    if (image)
        image->base.pixels = pixels;
    else
        error_set(error, ERROR_SERVER, "out of memory");
    return image;
}

void gl_image_destroy(struct renderer *renderer, struct renderer_image *base)
{
    struct gl_image *image = gl_image_of(base);
    if (context_is_current(&gl_renderer_of(renderer)->context, image->context))
        glDeleteTextures(1, &image->texture);
    free(image);
}
