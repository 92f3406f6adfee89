/* Workarounds for behaviour of drivers that no specification describes. All are in this file, so
 * that they can be removed when no driver needs them. Measured on Mesa's llvmpipe. Any thread. */
#ifndef SHEEN_RENDER_GL_CONTEXT_QUIRKS_H
#define SHEEN_RENDER_GL_CONTEXT_QUIRKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/image/image.h"

/* The smallest number from `size` on that is not a power of two, for sides of images and bytes of
 * buffer textures. llvmpipe recompiles a program for a texture whose size is a power of two if
 * earlier ones were not, which takes up to seconds. With sizes that never are, it compiles once. */
static inline size_t no_power_of_two(size_t size)
{
    while (!(size & (size - 1)))
        size++;
    return size;
}

/* The properties of a light image for which llvmpipe recompiles a program: the kind of texels, and
 * sides that are powers of two. Equal for images that share code. */
static inline uint8_t image_quirks(const struct image *pixels)
{
    uint32_t width = pixels->width_px, height = pixels->height_px;
    return (uint8_t)(pixels->is_float | !(width & (width - 1)) << 1 |
                     !(height & (height - 1)) << 2 | (width == 1 && height == 1) << 3);
}

/* True if timer queries measure all of the device's work. Those of llvmpipe omit the vertex
 * stage. */
static inline bool tells_device_times(bool software)
{
    return !software;
}

/* llvmpipe generates a program's code for each context, but a context takes what another one has
 * stored in Mesa's cache of shaders, in 3 to 10 ms instead of 0.4 to 2.5 s. A thread of low priority
 * stores it: after this time, except on a machine with much load, or where there is no cache. */
enum { SOFTWARE_STORE_NS = 50000000 };

/* llvmpipe draws while it receives more commands, but starts only at a flush. So a flush follows
 * after this many cells of grids, or triangles of polygons. Measured with a car of 12.9 million
 * triangles at 1280x720: 0.8 s in steps of 65536 triangles with these flushes, 1.6 s with a flush
 * only at the end of each step, 1.1 s without steps. */
enum { FLUSH_CELLS = 16384, SOFTWARE_TRIANGLES_AT_ONCE = 8192 };

#endif
