/* Light images: linear light, with copies of half the size down to one texel. */
#include <stdlib.h>

#include "protocol/srgb.h"
#include "server/render/native/device_internal.h"

static uint32_t half(uint32_t side)
{
    return side > 1 ? side / 2 : 1;
}

/* Number of texels of all levels; n_levels may be NULL. */
static size_t texels_of(uint32_t width, uint32_t height, uint32_t *first, int *n_levels)
{
    size_t n = 0;
    int level = 0;
    for (bool is_last = false; !is_last; level++) {
        if (first)
            first[level] = (uint32_t)n;
        n += (size_t)width * height;
        is_last = width == 1 && height == 1;
        width = half(width);
        height = half(height);
    }
    if (n_levels)
        *n_levels = level;
    return n;
}

size_t native_image_bytes(const struct image *image)
{
    return texels_of(image->width_px, image->height_px, NULL, NULL) * 4 * sizeof(float);
}

/* Bytes are sRGB-encoded except alpha; floats are linear. */
static void fill_first(float *texels, const struct image *image)
{
    size_t n = (size_t)image->width_px * image->height_px * 4;
    if (image->is_float) {
        const float *from = image->pixels;
        for (size_t i = 0; i < n; i++)
            texels[i] = from[i];
        return;
    }
    const uint8_t *from = image->pixels;
    for (size_t i = 0; i < n; i++)
        texels[i] = i % 4 == 3 ? (float)from[i] / 255 : (float)srgb_to_linear(from[i] / 255.0);
}

/* Makes a level: each texel is the mean of 2 x 2 texels of the level before (3 where a side is odd). */
static void fill_level(const float *from, uint32_t width, uint32_t height, float *to)
{
    uint32_t across = half(width), down = half(height);
    for (uint32_t y = 0; y < down; y++) {
        uint32_t y0 = y * height / down, y1 = (y + 1) * height / down;
        for (uint32_t x = 0; x < across; x++) {
            uint32_t x0 = x * width / across, x1 = (x + 1) * width / across;
            double sum[4] = {0, 0, 0, 0};
            for (uint32_t j = y0; j < y1; j++)
                for (uint32_t i = x0; i < x1; i++)
                    for (int k = 0; k < 4; k++)
                        sum[k] += (double)from[4 * ((size_t)j * width + i) + (size_t)k];
            for (int k = 0; k < 4; k++)
                *to++ = (float)(sum[k] / ((double)(x1 - x0) * (y1 - y0)));
        }
    }
}

struct renderer_image *native_image_create(struct renderer *renderer, const struct image *image,
                                           struct error *error)
{
    struct native_light_image *own = calloc(1, sizeof *own);
    float *texels = own ? malloc(native_image_bytes(image)) : NULL;
    (void)renderer;
    if (!texels) {
        free(own);
        error_set(error, ERROR_SERVER, "out of memory for a light image of %zu bytes",
                  native_image_bytes(image));
        return NULL;
    }
    struct native_picture *picture = &own->picture;
    own->base.pixels = image;
    own->texels = texels;
    picture->texels = texels;
    picture->width = (int32_t)image->width_px;
    picture->height = (int32_t)image->height_px;
    texels_of(image->width_px, image->height_px, picture->first, &picture->n_levels);
    fill_first(texels, image);
    uint32_t width = image->width_px, height = image->height_px;
    for (int level = 1; level < picture->n_levels; level++) {
        fill_level(texels + 4 * (size_t)picture->first[level - 1], width, height,
                   texels + 4 * (size_t)picture->first[level]);
        width = half(width);
        height = half(height);
    }
    return &own->base;
}

void native_image_destroy(struct renderer *renderer, struct renderer_image *image)
{
    struct native_light_image *own = (struct native_light_image *)(void *)image;
    (void)renderer;
    free(own->texels);
    free(own);
}
