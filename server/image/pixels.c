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
