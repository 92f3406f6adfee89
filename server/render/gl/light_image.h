/* Light images as textures, with all their smaller copies (mipmaps). GL thread. */
#ifndef SHEEN_RENDER_GL_LIGHT_IMAGE_H
#define SHEEN_RENDER_GL_LIGHT_IMAGE_H

#include <epoxy/gl.h>

#include "server/render/device.h"
#include "server/render/gl/context/context.h"

struct gl_renderer;

struct gl_image {
    struct renderer_image base;
    context_number context;
    GLuint texture;
};

static inline struct gl_image *gl_image_of(struct renderer_image *image) /* NULL gives NULL */
{
    return (struct gl_image *)(void *)image;
}

/* Makes an image that is not on the device yet. NULL when memory is short. */
struct gl_image *gl_image_create(const struct image *pixels, struct error *error);
/* The functions of struct renderer_device. */
void gl_image_destroy(struct renderer *renderer, struct renderer_image *image);
size_t gl_image_bytes(const struct image *image);

/* A texture of the pixels, with its smaller copies. Any context. */
GLuint light_texture_create(const struct image *pixels);
/* Puts the image on the device unless it is there. */
bool gl_image_upload(struct gl_renderer *r, struct gl_image *image, struct error *error);

#endif
