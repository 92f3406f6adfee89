/* What drivers do that no specification says, and what is done about it: all of it here, so
 * that it can go where no driver needs it. Measured on Mesa's llvmpipe. Any thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_QUIRKS_H
#define SHEEN_RENDER_GL_CONTEXT_QUIRKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/image/image.h"

/* The least number from `size` on that is no power of two, for the sides of images and the bytes of
 * buffer textures. llvmpipe compiles a program anew for a texture whose size is a power of two
 * where those before were not, which takes up to seconds; sizes that never are cost that once. */
static inline size_t no_power_of_two(size_t size)
{
    while (!(size & (size - 1)))
        size++;
    return size;
}

/* What llvmpipe compiles a program anew for when a light image is bound: one whose texels are of
 * another kind, or which has a side that is a power of two. Equal for images that share code. */
static inline uint8_t image_quirks(const struct image *pixels)
{
    uint32_t width = pixels->width_px, height = pixels->height_px;
    return (uint8_t)(pixels->is_float | !(width & (width - 1)) << 1 |
                     !(height & (height - 1)) << 2 | (width == 1 && height == 1) << 3);
}

/* Do timer queries hold all of the device's work? Those of llvmpipe leave the vertex stage out. */
static inline bool tells_device_times(bool software)
{
    return !software;
}

/* llvmpipe draws what it has been given while it is given more, but begins with it at a flush only.
 * So a flush comes after so many cells of grids, and after so many triangles of polygons: in steps
 * of 65536 triangles a car of 12.9 million at 1280x720 took 0.8 s so, and 1.6 s with nothing handed
 * on before a step's end, 1.1 s in one stroke. */
enum { FLUSH_CELLS = 16384, SOFTWARE_TRIANGLES_AT_ONCE = 8192 };

#endif
