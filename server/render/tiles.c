#include "server/render/tiles.h"

/* The longest side of a tile: a pixel takes about 80 bytes on a GPU. */
enum { TILE_MAX_PX = 4096 };
/* The shortest side of a tile: smaller tiles would consist mostly of margin. */
enum { TILE_MIN_PX = 128 };

_Static_assert(TILE_MIN_PX % COVER_BLOCK_PX == 0 && TILE_MARGIN_PX % COVER_BLOCK_PX == 0,
               "whole blocks");

static uint32_t at_most(uint32_t value, uint32_t limit)
{
    return value < limit ? value : limit;
}

static struct tile_size cut(uint32_t width_px, uint32_t height_px, uint64_t tile_px)
{
    uint32_t side = TILE_MAX_PX;
    struct tile_size size = {at_most(width_px, side), at_most(height_px, side)};
    if (!tile_px || (uint64_t)size.width * size.height <= tile_px)
        return size;
    while (side > TILE_MIN_PX && (uint64_t)side * side > tile_px)
        side -= TILE_MIN_PX;
    size.width = at_most(width_px, side);
    uint64_t rows = tile_px / size.width;
    size.height = at_most(height_px, rows < side ? side : (uint32_t)rows);
    size.height = at_most(size.height, TILE_MAX_PX);
    return size;
}

struct tile_size tiles_cut(uint32_t width_px, uint32_t height_px, uint64_t tile_px,
                           bool whole_blocks)
{
    struct tile_size size = cut(width_px, height_px, tile_px);
    if (whole_blocks && size.height < height_px)
        size.height -= size.height % COVER_BLOCK_PX;
    return size;
}

struct tile tile_at(uint32_t x, uint32_t y, const struct tile_size *size, uint32_t width_px,
                    uint32_t height_px)
{
    return (struct tile){x, y, at_most(width_px - x, size->width),
                         at_most(height_px - y, size->height)};
}

struct tile tile_with_margin(const struct tile *tile, bool before, uint32_t width_px,
                             uint32_t height_px)
{
    uint32_t left = before ? at_most(tile->x, TILE_MARGIN_PX) : 0;
    uint32_t above = before ? at_most(tile->y, TILE_MARGIN_PX) : 0;
    uint32_t right = at_most(width_px - tile->x - tile->width, TILE_MARGIN_PX);
    uint32_t below = at_most(height_px - tile->y - tile->height, TILE_MARGIN_PX);
    return (struct tile){tile->x - left, tile->y - above, left + tile->width + right,
                         above + tile->height + below};
}

struct tile_size tile_size_with_margin(const struct tile_size *size, uint32_t width_px,
                                       uint32_t height_px)
{
    return (struct tile_size){at_most(width_px, size->width + 2 * TILE_MARGIN_PX),
                              at_most(height_px, size->height + 2 * TILE_MARGIN_PX)};
}

struct tile tile_within(const struct tile *part, const struct tile *place)
{
    return (struct tile){part->x - place->x, part->y - place->y, part->width, part->height};
}

bool tile_is_same(const struct tile *a, const struct tile *b)
{
    return a->x == b->x && a->y == b->y && a->width == b->width && a->height == b->height;
}

uint32_t tile_max_rounded(const struct tile *tile)
{
    enum { PX_PER_ROUNDED = 32 };
    uint64_t pixels = (uint64_t)tile->width * tile->height, most = pixels / PX_PER_ROUNDED;
    most = most < ROUNDED_IN_ANY_CUT ? ROUNDED_IN_ANY_CUT : most;
    return (uint32_t)(most < pixels ? most : pixels);
}

uint32_t tiles_share_stride(uint32_t width_px, uint32_t height_px)
{
    enum { ALL_PX = 1 << 18, STRIDE = 8 };
    return (uint64_t)width_px * height_px < ALL_PX ? 1 : STRIDE;
}
