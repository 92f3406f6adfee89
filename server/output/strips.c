#include "server/output/strips.h"

#include "protocol/limits.h"

#define RGBA_BYTES 4
#define HEAD_STEP_BYTES 4096

void strip_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t multiple)
{
    const uint32_t least = PROTOCOL_STRIP_BYTES / (RGBA_BYTES * multiple * width_px);
    const uint32_t rows = multiple * (least > 0 ? least : 1);
    *layout = (struct strip_layout){
        .width_px = width_px,
        .height_px = height_px,
        .rows = rows,
        .n = (height_px + rows - 1) / rows,
    };
}

uint32_t strip_rows(const struct strip_layout *layout, size_t index)
{
    const uint32_t left = layout->height_px - (uint32_t)index * layout->rows;
    return left < layout->rows ? left : layout->rows;
}

const uint8_t *strip_pixels(const struct strip_layout *layout, size_t index, const uint8_t *rgba)
{
    return rgba + index * layout->rows * RGBA_BYTES * layout->width_px;
}

size_t strip_head_bound(size_t bytes)
{
    return (bytes + HEAD_STEP_BYTES - 1) / HEAD_STEP_BYTES * HEAD_STEP_BYTES;
}
