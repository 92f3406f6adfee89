/* Holds and checks the results of image.cpp, without an image library. */
#include <math.h>
#include <stdlib.h>

#include "server/image/blend.h"
#include "server/image/image.h"

void image_finish(struct image *image)
{
    free(image->pixels);
    *image = (struct image){0};
}

size_t image_bytes(const struct image *image)
{
    return (size_t)image->width_px * image->height_px * (image->is_float ? 16 : 4);
}

static bool are_finite(const float *values, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!isfinite(values[i]))
            return false;
    return true;
}

bool image_check(const struct image *image, const char *name, uint32_t max_px, struct error *error)
{
    const uint32_t width = image->width_px, height = image->height_px;
    if (!image->pixels || width == 0 || height == 0 || width > max_px || height > max_px ||
        width > IMAGE_MAX_PX || height > IMAGE_MAX_PX || image_bytes(image) > IMAGE_MAX_BYTES)
        return error_set(error, ERROR_IMAGE, "%s: %u x %u pixels cannot be taken", name, width,
                         height);
    return !image->is_float || are_finite(image->pixels, (size_t)width * height * 4) ||
           error_set(error, ERROR_IMAGE, "%s: a pixel is not finite", name);
}

void text_finish(struct text *text)
{
    free(text->coverage);
    *text = (struct text){0};
}

bool text_check(const struct text *text)
{
    const int most = (int)TEXT_MAX_PX;
    if (!text->coverage || text->width_px > TEXT_MAX_PX || text->height_px > TEXT_MAX_PX ||
        text->left_px < -most || text->left_px > most || text->top_px < -most ||
        text->top_px > most)
        return false;
    for (size_t i = 0; i < (size_t)text->width_px * text->height_px; i++)
        if (!(text->coverage[i] >= 0 && text->coverage[i] <= 1))
            return false;
    return true;
}

void text_draw(const struct text *text, uint8_t *rgba, uint32_t width_px, uint32_t height_px,
               int x_px, int y_px, enum text_align align, const float colour[4])
{
    const int64_t w = text->width_px;
    const int64_t left = (int64_t)x_px + text->left_px -
                         (align == TEXT_LEFT    ? 0
                          : align == TEXT_RIGHT ? w
                                                : w / 2);
    const int64_t top = (int64_t)y_px + text->top_px;
    for (int64_t row = 0; row < text->height_px; row++)
        for (int64_t column = 0; column < w; column++) {
            int64_t x = left + column, y = top + row;
            float coverage = text->coverage[row * w + column];
            if (coverage > 0 && x >= 0 && x < width_px && y >= 0 && y < height_px)
                blend_pixel(rgba + 4 * (size_t)(y * width_px + x), colour, coverage);
        }
}
