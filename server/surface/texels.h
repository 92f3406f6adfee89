/* Control points as devices read them: rounded to single precision, once, at the end of all double
 * arithmetic, four floats a texel.
 *
 * Four points that lie in a row of a grid are three texels: their x, their y, their z. A device
 * thus fetches a row in three texels, and the four blends along it meet them as dot products.
 *
 * - A patch (REGULAR, and each of a STRIP's) is a texel whose x is the scale, then rows j = -1..2
 * of points i = -1..2.
 * - A level is rows j = -1..3 of i = 0..3, then column i = -1 of j = 0..3: the 24 points that the
 *   three sub-patches of a ring need.
 * - A CORNER is its frame as a quaternion x y z w, which turns the frame's coordinates into world
 *   directions, then the scales of its levels, four to a texel, then the levels.
 *
 * Points are divided by their patch's or level's scale, a power of two. Pure functions on the
 * caller's memory; any thread; no failure. */
#ifndef SHEEN_SURFACE_TEXELS_H
#define SHEEN_SURFACE_TEXELS_H

#include "server/surface/vec.h"

#define LIMIT_PATCH_TEXELS 13                              /* the scale; 4 rows of 4 points */
#define LIMIT_CORNER_HEAD(levels) (1 + ((levels) + 3) / 4) /* the frame; the levels' scales */
#define LIMIT_LEVEL_TEXELS 18                              /* 5 rows and a column of 4 points */
#define LIMIT_CORNER_TEXELS(levels) (LIMIT_CORNER_HEAD(levels) + (levels)*LIMIT_LEVEL_TEXELS)

/* Writes LIMIT_PATCH_TEXELS texels: a power of two, then points 4 (j + 1) + (i + 1) divided by it,
 * so that the largest coordinate comes to lie in [1/2, 1). Products of derivatives, which the GPU
 * forms in single precision, then neither overflow nor vanish. */
void texels_write_patch(const struct vec *grid, float (*texels)[4]);

/* Writes LIMIT_LEVEL_TEXELS texels of the points grid[5 (j + 1) + i + 1], the first of which is not
 * read, and returns the power of two that they are divided by. */
float texels_write_level(const struct vec grid[25], float (*texels)[4]);

/* Four points of a row, from its three texels, times `scale`. */
void texels_read_row(const float (*texels)[4], double scale, struct vec row[4]);

#endif
