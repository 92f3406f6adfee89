/* Cuts a picture into tiles, each of which is drawn separately: a device needs memory for one tile
 * only, and other frames wait for at most one tile. Tiles depend only on the arguments here, so
 * that equal requests give equal tiles on every device. Pure, any thread. */
#ifndef SHEEN_RENDER_TILES_H
#define SHEEN_RENDER_TILES_H

#include <stdbool.h>
#include <stdint.h>

/* A rectangle of the picture, px. */
struct tile {
    uint32_t x, y, width, height;
};

/* The side of the squares in which pixels are listed, px. */
enum { COVER_BLOCK_PX = 8 };
/* The margin that is drawn around a tile and not kept, because stages look at a pixel's neighbours
 * and at their neighbours. */
enum { TILE_MARGIN_PX = COVER_BLOCK_PX };

/* The size of all tiles of a picture, px; those at its right and lower edge may be smaller. */
struct tile_size {
    uint32_t width, height;
};

/* Chooses the tile size: the whole picture, if that has at most `tile_px` pixels (0: any number)
 * and no side above 4,096; else tiles that are about square, or wide ones in a low picture, with
 * about `tile_px` pixels at most, but no side below 128 unless the picture's is. whole_blocks: if
 * there are several rows of tiles, their heights are whole blocks, so that blocks of a tile are
 * blocks of the picture. */
struct tile_size tiles_cut(uint32_t width_px, uint32_t height_px, uint64_t tile_px,
                           bool whole_blocks);

/* The tile whose top left pixel is (x, y). */
struct tile tile_at(uint32_t x, uint32_t y, const struct tile_size *size, uint32_t width_px,
                    uint32_t height_px);

/* The tile with its margin, as far as the picture extends; without `before` there is no margin on
 * the left and above. */
struct tile tile_with_margin(const struct tile *tile, bool before, uint32_t width_px,
                             uint32_t height_px);

/* The largest result of tile_with_margin() for tiles of this size. */
struct tile_size tile_size_with_margin(const struct tile_size *size, uint32_t width_px,
                                       uint32_t height_px);

/* Converts a part of the picture to coordinates of `place`, which contains it. */
struct tile tile_within(const struct tile *part, const struct tile *place);
bool tile_is_same(const struct tile *a, const struct tile *b);

/* The number of pixels of a tile for which all rays that find the rounding of a crease are computed
 * (shaders/rounded.glsl). With at most ROUNDED_IN_ANY_CUT such pixels the result does not depend on
 * tiles. */
enum { ROUNDED_IN_ANY_CUT = 32768 };
uint32_t tile_max_rounded(const struct tile *tile);

/* The share of a light is counted at every pixel of a small picture and at one in so many of a large
 * one. */
uint32_t tiles_share_stride(uint32_t width_px, uint32_t height_px);

#endif
