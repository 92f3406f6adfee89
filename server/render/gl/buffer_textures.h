/* A table in one or more buffer textures, as many as the device's limit of texels demands
 * (shaders/tables.glsl). GL thread. */
#ifndef SHEEN_RENDER_GL_BUFFER_TEXTURES_H
#define SHEEN_RENDER_GL_BUFFER_TEXTURES_H

#include <epoxy/gl.h>

#include <stddef.h>

#include "server/base/error.h"

/* The largest number of buffer textures for each table. */
enum { MAX_POINT_TEXTURES = 8, MAX_NODE_TEXTURES = 4, MAX_ADJACENCY_TEXTURES = 2 };

/* All zero: no textures. */
struct buffer_textures {
    GLuint buffer[MAX_POINT_TEXTURES];
    GLuint texture[MAX_POINT_TEXTURES];
    int n;
};

/* Texels to put on the device. */
struct texels {
    const void *data;
    size_t n, bytes;  /* number of texels, and bytes of one */
    GLenum format;    /* format of a texel */
    const char *what; /* for errors: "points" */
};

/* Puts texels into at most `max_textures` textures of `max_texels` each. False with ERROR_DEVICE if
 * they do not fit or the device has no memory; the set then has what was made before, and must be
 * finished. */
bool buffer_textures_init(struct buffer_textures *set, const struct texels *texels,
                          int max_textures, size_t max_texels, struct error *error);
void buffer_textures_finish(struct buffer_textures *set);
/* Binds all textures of a set to texture units from `unit` on. Returns the next free unit. */
int buffer_textures_bind(const struct buffer_textures *set, int unit);

#endif
