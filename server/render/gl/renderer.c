#include "server/render/renderer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/fault.h"
#include "server/render/gl/gpu.h"

/* How long the device may take for the stages of a tile; those are made for a hundredth of that. */
#define LOST_AFTER_NS 2000000000u

static void query_info(struct renderer *r)
{
    GLint texels = 0, texture = 0, viewport[2] = {0, 0};
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    GLint width = texture < viewport[0] ? texture : viewport[0];
    GLint height = texture < viewport[1] ? texture : viewport[1];
    snprintf(r->device, sizeof r->device, "%s", (const char *)glGetString(GL_RENDERER));
    snprintf(r->driver, sizeof r->driver, "%s", (const char *)glGetString(GL_VERSION));
    r->info = (struct renderer_info){
        .device = r->device,
        .driver = r->driver,
        .software = r->egl.software,
        .max_width_px = (uint32_t)width,
        .max_height_px = (uint32_t)height,
        .max_texels = (size_t)texels,
    };
    r->info.timed_by_device = stage_clock_by_device(r);
    size_t max_texels = r->options.max_texels;
    if (max_texels && max_texels < r->info.max_texels)
        r->info.max_texels = max_texels;
}

/* What every context begins with. */
static bool begin_context(struct renderer *r, struct error *error)
{
    r->context++;
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    stage_clock_init(r);
    glCreateBuffers(1, &r->view_buffer);
    glNamedBufferData(r->view_buffer, sizeof(struct view_block), NULL, GL_STREAM_DRAW);
    return stage_visibility_init(r, error) && stage_gather_init(r, error) &&
           stage_evaluate_init(r, error) && stage_edges_init(r, error) &&
           stage_shade_init(r, error);
}

struct renderer *renderer_create(const struct renderer_options *options, struct error *error)
{
    struct renderer *r = calloc(1, sizeof *r);
    if (!r) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    r->options = *options;
    r->canvases = canvases_create();
    if (!r->canvases) {
        error_set(error, ERROR_SERVER, "out of memory");
        free(r);
        return NULL;
    }
    if (!egl_init(&r->egl, options->device ? options->device : "auto", error)) {
        canvases_release(r->canvases);
        free(r);
        return NULL;
    }
    query_info(r);
    if (!begin_context(r, error)) {
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
    polygons_lose(&r->polygons);
    canvases_release(r->canvases);
    free(r);
}

static void lose(struct renderer *r)
{
    r->is_lost = true;
    if (r->options.lost)
        r->options.lost(r->options.owner);
}

bool renderer_check_lost(struct renderer *r)
{
    if (!r->is_lost && (fault_at("gpu.lost") || glGetGraphicsResetStatus() != GL_NO_ERROR))
        lose(r);
    return r->is_lost;
}

bool renderer_wait(struct renderer *r)
{
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    GLenum came;
    bool late;
    do {
        came = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, LOST_AFTER_NS);
        late = came == GL_TIMEOUT_EXPIRED || fault_at("gpu.fence");
    } while (came == GL_TIMEOUT_EXPIRED && r->egl.software);
    glDeleteSync(fence);
    if (late && !r->is_lost)
        lose(r);
    return !renderer_check_lost(r);
}

bool renderer_ready(struct renderer *r, struct error *error)
{
    if (!r->is_lost)
        return true;
    /* Only what is in main memory stays; every GL name went with the context. */
    polygons_lose(&r->polygons);
    const struct renderer old = *r;
    *r = (struct renderer){.egl = old.egl,
                           .options = old.options,
                           .info = old.info,
                           .context = old.context,
                           .pieces = old.pieces,
                           .canvases = old.canvases,
                           .next_serial = old.next_serial};
    memcpy(r->device, old.device, sizeof r->device);
    memcpy(r->driver, old.driver, sizeof r->driver);
    struct error why;
    if (egl_reopen(&r->egl) && begin_context(r, &why) && !renderer_check_lost(r))
        return true;
    if (!r->is_lost)
        lose(r);
    return error_set(error, ERROR_GPU_LOST,
                     "the GPU was lost and does not come back yet: try again later");
}

const struct renderer_info *renderer_info(const struct renderer *r)
{
    return &r->info;
}

size_t renderer_image_bytes(const struct image *image)
{
    size_t texels = (size_t)image->width_px * image->height_px;
    return (texels + texels / 3) * (image->is_float ? 8 : 4); /* RGBA16F or SRGB8_ALPHA8 */
}

bool image_upload(struct renderer *r, struct renderer_image *image, struct error *error)
{
    if (is_current(r, image->context))
        return true;
    const struct image *pixels = image->pixels;
    GLsizei width = (GLsizei)pixels->width_px, height = (GLsizei)pixels->height_px;
    GLsizei levels = 32 - __builtin_clz((unsigned)(width > height ? width : height));
    glCreateTextures(GL_TEXTURE_2D, 1, &image->texture);
    glTextureStorage2D(image->texture, levels, pixels->is_float ? GL_RGBA16F : GL_SRGB8_ALPHA8,
                       width, height);
    glTextureSubImage2D(image->texture, 0, 0, 0, width, height, GL_RGBA,
                        pixels->is_float ? GL_FLOAT : GL_UNSIGNED_BYTE, pixels->pixels);
    glGenerateTextureMipmap(image->texture);
    glTextureParameteri(image->texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(image->texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(image->texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(image->texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (!gpu_check("a light image", error)) {
        glDeleteTextures(1, &image->texture);
        return false;
    }
    image->context = r->context;
    return true;
}

struct renderer_image *renderer_image_create(struct renderer *r, const struct image *image,
                                             struct error *error)
{
    if (image->width_px > r->info.max_width_px || image->height_px > r->info.max_height_px) {
        error_set(error, ERROR_IMAGE, "the image is %ux%u, more than the device's %ux%u",
                  image->width_px, image->height_px, r->info.max_width_px, r->info.max_height_px);
        return NULL;
    }
    struct renderer_image *out = calloc(1, sizeof *out);
    if (!out) {
        error_set(error, ERROR_SERVER, "out of memory");
        return NULL;
    }
    out->pixels = image;
    /* On a device that is lost meanwhile it comes with its first frame. */
    if (!renderer_ready(r, error) || image_upload(r, out, error) || renderer_check_lost(r))
        return out;
    free(out);
    return NULL;
}

void renderer_image_destroy(struct renderer *r, struct renderer_image *image)
{
    if (!image)
        return;
    if (is_current(r, image->context))
        glDeleteTextures(1, &image->texture);
    free(image);
}
