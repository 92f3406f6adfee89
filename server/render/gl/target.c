#include "server/render/gl/target.h"

#include <stddef.h>

#include "server/render/gl/context/check.h"
#include "server/render/gl/context/quirks.h"

/* Every image of a target: the member that holds its name, its format, and its bytes per pixel. */
static const struct {
    size_t member;
    GLenum format;
    unsigned bytes;
} images[] = {
    {offsetof(struct target, seen), GL_RG32UI, 8},
    {offsetof(struct target, seen_depth), GL_DEPTH_COMPONENT32F, 4},
    {offsetof(struct target, hit_depth), GL_R32F, 4},
    {offsetof(struct target, normal), GL_RGBA32F, 16},
    {offsetof(struct target, shape), GL_RG32F, 8},
    {offsetof(struct target, ptex), GL_RGBA32UI, 16},
    {offsetof(struct target, border), GL_R32UI, 4},
    {offsetof(struct target, ends), GL_RG32UI, 8},
    {offsetof(struct target, colour), GL_RGBA8, 4},
    {offsetof(struct target, coverage), GL_R32F, 4},
    {offsetof(struct target, light), GL_RG32F, 8},
    {offsetof(struct target, curvature), GL_RG32F, 8},
    {offsetof(struct target, light_change), GL_RGBA32F, 16},
};

/* Bytes per pixel of the planes that only frames of several lights need. */
enum { LIGHTS_BYTES = 2 * (8 + 2 + 2) + 16 };

/* The lists of pixels of a target. */
enum { N_LISTS = 7 };

uint64_t target_bytes(uint32_t width, uint32_t height)
{
    uint64_t pixel = N_LISTS * LIST_BYTES;
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++)
        pixel += images[i].bytes;
    return (uint64_t)width * height * (pixel + LIGHTS_BYTES) + N_LISTS * LIST_HEAD_BYTES;
}

static GLuint *image_name(struct target *target, size_t i)
{
    return (GLuint *)(void *)((char *)target + images[i].member);
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

/* Enlarges the size to what is asked for and, where that wastes little, to all that was asked for
 * before: a high picture after a wide one must not make a square of both. The waste is measured
 * against the sizes asked for, not against the size held; otherwise thin pictures, each a little
 * longer than the one before, would double the target without end. */
static void choose_size(const struct target *target, uint32_t *width, uint32_t *height)
{
    uint32_t both[2] = {larger(*width, target->width), larger(*height, target->height)};
    if ((uint64_t)both[0] * both[1] > 2 * target->most_asked_px)
        return;
    *width = both[0];
    *height = both[1];
}

bool target_can_hold(const struct renderer_info *info, const struct frame_request *request)
{
    return no_power_of_two(request->width_px) <= info->max_width_px &&
           no_power_of_two(request->height_px) <= info->max_height_px;
}

bool target_reserve(struct target *target, uint32_t width, uint32_t height, struct error *error)
{
    if (width <= target->width && height <= target->height)
        return true;
    uint64_t asked_px = (uint64_t)width * height;
    target->most_asked_px = asked_px > target->most_asked_px ? asked_px : target->most_asked_px;
    const uint64_t most_asked_px = target->most_asked_px;
    choose_size(target, &width, &height);
    width = (uint32_t)no_power_of_two(width);
    height = (uint32_t)no_power_of_two(height);
    target_finish(target);
    target->most_asked_px = most_asked_px;
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        GLuint *name = image_name(target, i);
        glCreateTextures(GL_TEXTURE_2D, 1, name);
        glTextureStorage2D(*name, 1, images[i].format, (GLsizei)width, (GLsizei)height);
        /* An integer texture is incomplete with any other filter. */
        glTextureParameteri(*name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(*name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    GLuint *const lists[N_LISTS] = {
        &target->groups, &target->discontinuous, &target->retry_pixels, &target->unsolved,
        &target->edges,  &target->parts,         &target->rounded};
    for (size_t i = 0; i < N_LISTS; i++) {
        glCreateBuffers(1, lists[i]);
        glNamedBufferData(*lists[i],
                          (GLsizeiptr)(LIST_HEAD_BYTES + (size_t)width * height * LIST_BYTES), NULL,
                          GL_DYNAMIC_COPY);
    }
    glCreateFramebuffers(1, &target->framebuffer);
    glNamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT0, target->seen, 0);
    glNamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT1, target->hit_depth, 0);
    glNamedFramebufferTexture(target->framebuffer, GL_COLOR_ATTACHMENT2, target->ptex, 0);
    glNamedFramebufferTexture(target->framebuffer, GL_DEPTH_ATTACHMENT, target->seen_depth, 0);
    target->width = width;
    target->height = height;
    if (!gpu_check("the planes of a frame", error)) {
        target_finish(target);
        return false;
    }
    if (glCheckNamedFramebufferStatus(target->framebuffer, GL_FRAMEBUFFER) !=
        GL_FRAMEBUFFER_COMPLETE) {
        target_finish(target);
        return error_set(error, ERROR_DEVICE, "the device refuses a %ux%u visibility buffer", width,
                         height);
    }
    return true;
}

bool target_reserve_rounded(struct target *target, struct error *error)
{
    if (target->max_rounded)
        return true;
    target->max_rounded =
        tile_max_rounded(&(struct tile){.width = target->width, .height = target->height});
    glCreateBuffers(1, &target->rounded_hits);
    glNamedBufferData(target->rounded_hits, (GLsizeiptr)target->max_rounded * ROUNDED_BYTES, NULL,
                      GL_DYNAMIC_COPY);
    return gpu_check("the rays of a frame", error);
}

bool target_reserve_lights(struct target *target, struct error *error)
{
    if (target->lights[0])
        return true;
    GLsizei width = (GLsizei)target->width, height = (GLsizei)target->height;
    glCreateTextures(GL_TEXTURE_2D, 2, target->lights);
    glCreateTextures(GL_TEXTURE_2D, 2, target->missed);
    glCreateTextures(GL_TEXTURE_2D, 2, target->uneven);
    glCreateTextures(GL_TEXTURE_2D, 1, &target->square_sum);
    glTextureStorage2D(target->square_sum, 1, GL_RGBA32F, width, height);
    for (int i = 0; i < 2; i++) {
        glTextureStorage2D(target->lights[i], 1, GL_RGBA16F, width, height);
        glTextureStorage2D(target->missed[i], 1, GL_R16F, width, height);
        glTextureStorage2D(target->uneven[i], 1, GL_R16F, width, height);
    }
    return gpu_check("the planes of a frame's lights", error);
}

static void swap_names(GLuint *a, GLuint *b)
{
    GLuint name = *a;
    *a = *b;
    *b = name;
}

void target_swap_lists(struct target *a, struct target *b)
{
    swap_names(&a->groups, &b->groups);
    swap_names(&a->discontinuous, &b->discontinuous);
    swap_names(&a->retry_pixels, &b->retry_pixels);
    swap_names(&a->unsolved, &b->unsolved);
    swap_names(&a->edges, &b->edges);
    swap_names(&a->rounded, &b->rounded);
    swap_names(&a->rounded_hits, &b->rounded_hits);
    swap_names(&a->max_rounded, &b->max_rounded);
}

void target_finish(struct target *target)
{
    glDeleteBuffers(1, &target->groups);
    glDeleteBuffers(1, &target->discontinuous);
    glDeleteBuffers(1, &target->retry_pixels);
    glDeleteBuffers(1, &target->unsolved);
    glDeleteBuffers(1, &target->edges);
    glDeleteBuffers(1, &target->parts);
    glDeleteBuffers(1, &target->rounded);
    glDeleteBuffers(1, &target->rounded_hits);
    glDeleteFramebuffers(1, &target->framebuffer);
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++)
        glDeleteTextures(1, image_name(target, i));
    glDeleteTextures(2, target->lights);
    glDeleteTextures(2, target->missed);
    glDeleteTextures(2, target->uneven);
    glDeleteTextures(1, &target->square_sum);
    *target = (struct target){0};
}
