/* Prepares what the shaders' programs read of stage 1 beside planes: shaders/seen.glsl, shaders/groups.glsl. */
#include "server/render/native/lanes/entries.h"
#include "server/render/native/planes.h"

#include <string.h>

/* Fills in depths as a graphics card's rasteriser would leave them, and no guess where nothing is met. */
static void fill_row(const struct native_seen *seen, size_t first)
{
    const float *depth = seen->planes->depth + first;
    uint32_t *node = seen->planes->node + first;
    float *ndc = seen->ndc + first;
    const float near = seen->depth[0], offset = seen->depth[1], scale = seen->depth[2];
    if (seen->is_perspective)
        for (uint32_t i = 0; i < seen->width; i++)
            ndc[i] = depth[i] > 0 ? near / depth[i] : 0;
    else
        for (uint32_t i = 0; i < seen->width; i++)
            ndc[i] = depth[i] > 0 ? offset + depth[i] * scale : 0;
    for (uint32_t i = 0; i < seen->width; i++)
        node[i] = depth[i] > 0 ? node[i] : UINT32_MAX;
}

/* For each pixel of a row of groups: more than 0 if a pixel of its column, or one above or below the group, shows
 * surface. */
static void find_columns(const struct native_seen *seen, uint32_t y, float *columns)
{
    uint32_t first = y ? y - 1 : 0, last = y + GROUP_HEIGHT;
    last = last < seen->height ? last : seen->height - 1;
    memset(columns, 0, seen->width * sizeof *columns);
    for (uint32_t row = first; row <= last; row++) {
        const float *depth = seen->planes->depth + (size_t)row * seen->planes->pitch;
        for (uint32_t i = 0; i < seen->width; i++)
            columns[i] = depth[i] > columns[i] ? depth[i] : columns[i];
    }
}

uint32_t LANE_NAME(native_groups)(const struct native_seen *seen, uint32_t first, uint32_t end,
                                  float *columns, uint32_t *groups)
{
    uint32_t n = 0, width = seen->width;
    for (uint32_t y = first; y < end && seen->ndc; y++)
        fill_row(seen, (size_t)y * seen->planes->pitch);
    for (uint32_t y = first; y < end; y += GROUP_HEIGHT) {
        find_columns(seen, y, columns);
        for (uint32_t x = 0; x < width; x += GROUP_WIDTH) {
            uint32_t left = x ? x - 1 : 0,
                     right = x + GROUP_WIDTH < width ? x + GROUP_WIDTH : width - 1;
            bool near = false;
            for (uint32_t i = left; i <= right; i++)
                near = near || columns[i] > 0;
            if (near)
                groups[n++] = x / GROUP_WIDTH | (y / GROUP_HEIGHT) << 16;
        }
    }
    return n;
}
