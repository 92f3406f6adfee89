/* How a picture is cut into tiles, each drawn by itself: a device needs memory for one tile only,
 * and other frames wait for one tile at most. Tiles depend on the numbers given here alone, so that
 * equal requests give equal tiles on every device. Pure, any thread. */
#ifndef SHEEN_RENDER_TILES_H
#define SHEEN_RENDER_TILES_H

#include <stdbool.h>
#include <stdint.h>

/* A rectangle of the picture, px. */
struct tile {
    uint32_t x, y, width, height;
};

/* Pixels are listed in squares of so many by so many. */
enum { COVER_BLOCK_PX = 8 };
/* Drawn around a tile and not kept: stages look at a pixel's neighbours, and at theirs. */
enum { TILE_MARGIN_PX = COVER_BLOCK_PX };

/* The size of all tiles of a picture, px; those at its right and lower end may be smaller. */
struct tile_size {
    uint32_t width, height;
};

/* The whole picture where that has at most `tile_px` pixels (0: any number) and no side above
 * 4,096; else about square tiles, or wide ones where the picture is low, of about `tile_px` at
 * most, but of no side below 128 where the picture has more. whole_blocks: heights of several tiles
 * are whole blocks, so that those of a tile fall on those of the picture. */
struct tile_size tiles_cut(uint32_t width_px, uint32_t height_px, uint64_t tile_px,
                           bool whole_blocks);

/* The tile that begins at (x, y) of the picture. */
struct tile tile_at(uint32_t x, uint32_t y, const struct tile_size *size, uint32_t width_px,
                    uint32_t height_px);

/* The tile and its margin, where the picture has one; without `before` none on the left and above.
 */
struct tile tile_with_margin(const struct tile *tile, bool before, uint32_t width_px,
                             uint32_t height_px);

/* The largest that tile_with_margin() makes of a tile of this size. */
struct tile_size tile_size_with_margin(const struct tile_size *size, uint32_t width_px,
                                       uint32_t height_px);

/* A part of the picture as one of `place`, in which it lies. */
struct tile tile_within(const struct tile *part, const struct tile *place);
bool tile_is_same(const struct tile *a, const struct tile *b);

/* Of how many pixels of a tile all rays are met that find what the rounding of a crease shows
 * (shaders/rounded.glsl). So many or fewer, and the tile may be cut in any way. */
enum { ROUNDED_IN_ANY_CUT = 32768 };
uint32_t tile_max_rounded(const struct tile *tile);

#endif
