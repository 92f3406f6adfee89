/* A table in one or more buffer textures: as many as the device's limit of texels asks for
 * (shaders/tables.glsl). GL thread. */
#ifndef SHEEN_RENDER_GL_BUFFER_TEXTURES_H
#define SHEEN_RENDER_GL_BUFFER_TEXTURES_H

#include <epoxy/gl.h>

#include <stddef.h>

#include "server/base/error.h"

/* How many buffer textures each table may be spread over. */
enum { MAX_POINT_TEXTURES = 8, MAX_NODE_TEXTURES = 4, MAX_ADJACENCY_TEXTURES = 2 };

/* All zero: none. */
struct buffer_textures {
    GLuint buffer[MAX_POINT_TEXTURES];
    GLuint texture[MAX_POINT_TEXTURES];
    int n;
};

/* What is put on the device. */
struct texels {
    const void *data;
    size_t n, bytes;  /* texels, and the bytes of one */
    GLenum format;    /* of a texel */
    const char *what; /* for errors: "points" */
};

/* Puts texels into at most `max_textures` of `max_texels` each. ERROR_DEVICE when they do not fit
 * or the device has no memory; the set then holds what was made before, for
 * buffer_textures_finish(). */
bool buffer_textures_init(struct buffer_textures *set, const struct texels *texels,
                          int max_textures, size_t max_texels, struct error *error);
void buffer_textures_finish(struct buffer_textures *set);
/* Binds all of a set to texture units from `unit`; returns the next free unit. */
int buffer_textures_bind(const struct buffer_textures *set, int unit);

#endif
