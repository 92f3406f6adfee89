#include "server/render/gl/buffer_textures.h"

#include "server/render/gl/context/check.h"
#include "server/render/gl/context/quirks.h"

/* The buffer is never written again, and its padding is never read. */
static void store(GLuint buffer, const void *texels, size_t n, size_t texel_bytes)
{
    size_t room = no_power_of_two(n); /* texel_bytes is a power of two */
    if (room == n) {
        glNamedBufferStorage(buffer, (GLsizeiptr)(n * texel_bytes), texels, 0);
        return;
    }
    glNamedBufferStorage(buffer, (GLsizeiptr)(room * texel_bytes), NULL, GL_DYNAMIC_STORAGE_BIT);
    glNamedBufferSubData(buffer, 0, (GLsizeiptr)(n * texel_bytes), texels);
}

bool buffer_textures_init(struct buffer_textures *set, const struct texels *texels,
                          int max_textures, size_t max_texels, struct error *error)
{
    size_t n_textures = texels->n ? (texels->n + max_texels - 1) / max_texels : 1;
    if (n_textures > (size_t)max_textures)
        return error_set(error, ERROR_DEVICE,
                         "the model's %s need %zu texels, but this device holds %zu in %d buffer "
                         "textures",
                         texels->what, texels->n, max_texels * (size_t)max_textures, max_textures);
    set->n = (int)n_textures;
    glCreateBuffers(set->n, set->buffer);
    glCreateTextures(GL_TEXTURE_BUFFER, set->n, set->texture);
    for (size_t b = 0; b < n_textures; b++) {
        size_t first = b * max_texels;
        size_t n = texels->n - first < max_texels ? texels->n - first : max_texels;
        store(set->buffer[b], (const char *)texels->data + first * texels->bytes, n, texels->bytes);
        glTextureBuffer(set->texture[b], texels->format, set->buffer[b]);
    }
    return gpu_check(texels->what, error);
}

void buffer_textures_finish(struct buffer_textures *set)
{
    glDeleteTextures(set->n, set->texture);
    glDeleteBuffers(set->n, set->buffer);
    *set = (struct buffer_textures){0};
}

int buffer_textures_bind(const struct buffer_textures *set, int unit)
{
    for (int b = 0; b < set->n; b++)
        glBindTextureUnit((GLuint)unit++, set->texture[b]);
    return unit;
}
