/* Control points as the GPU reads them: rounded to single precision, once, at the end of all double
 * arithmetic, four floats a texel.
 *
 * Four points that lie in a row of a grid are three texels: their x, their y, their z. So a row is
 * fetched in three texels and meets the four blends along it as dot products.
 *
 * - A patch is a texel whose x is the scale, then rows j = -1..2 of i = -1..2.
 * - A level is rows j = -1..3 of i = 0..3, then column i = -1 of j = 0..3: the 24 points that the
 *   three sub-patches of a ring need.
 * - A corner is the frame as a quaternion x y z w, which turns the frame's coordinates into world
 *   directions, then the scales of the levels, four to a texel, then the levels.
 *
 * Pure functions on the caller's memory, any thread. */
#ifndef SHEEN_SURFACE_TEXELS_H
#define SHEEN_SURFACE_TEXELS_H

#include "server/surface/vec.h"

/* Writes LIMIT_PATCH_TEXELS texels: a power of two, then points 4 (j + 1) + (i + 1) divided by it,
 * so that the largest coordinate comes to lie in [1/2, 1). Single precision then never under- or
 * overflows in the products of derivatives that the GPU forms. */
void texels_write_patch(const struct vec *grid, float (*texels)[4]);

/* Writes LIMIT_LEVEL_TEXELS texels of the points grid[j + 1][i + 1], whose [0][0] is not read, and
 * returns the power of two that they are divided by. */
float texels_write_level(struct vec grid[5][5], float (*texels)[4]);

/* Four points of a row, from its three texels. */
void texels_read_row(const float (*texels)[4], double scale, struct vec row[4]);

#endif
