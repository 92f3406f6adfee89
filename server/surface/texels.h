/* Control points in the form that devices read: rounded to single precision once, at the end of all
 * computations in double, four floats in a texel.
 *
 * Four points of a row of a grid are three texels: their x, their y, their z. So a device reads a
 * row by three fetches and multiplies it with the four blending weights by dot products.
 *
 * - A patch (REGULAR, and each of a STRIP) is a texel whose x is the scale, then rows j = -1..2 of points
 *   i = -1..2.
 * - A level is rows j = -1..3 of i = 0..3, then column i = -1 of j = 0..3: the 24 points that the three
 *   sub-patches of a ring need.
 * - A CORNER is its frame, a quaternion x y z w that turns frame coordinates into world directions, then
 *   the scales of its levels, four in a texel, then the levels.
 *
 * Points are divided by the scale of their patch or level, a power of two. Pure functions on the
 * caller's memory; any thread; cannot fail. */
#ifndef SHEEN_SURFACE_TEXELS_H
#define SHEEN_SURFACE_TEXELS_H

#include "server/surface/vec.h"

#define LIMIT_PATCH_TEXELS 13                              /* the scale; 4 rows of 4 points */
#define LIMIT_CORNER_HEAD(levels) (1 + ((levels) + 3) / 4) /* the frame; the levels' scales */
#define LIMIT_LEVEL_TEXELS 18                              /* 5 rows and a column of 4 points */
#define LIMIT_CORNER_TEXELS(levels) (LIMIT_CORNER_HEAD(levels) + (levels)*LIMIT_LEVEL_TEXELS)

/* Writes LIMIT_PATCH_TEXELS texels: a power of two, then points 4 (j + 1) + (i + 1) divided by it,
 * so that the largest coordinate is in [1/2, 1). Products of derivatives, which the GPU computes in
 * single precision, then neither overflow nor vanish. */
void texels_write_patch(const struct vec *grid, float (*texels)[4]);

/* Writes LIMIT_LEVEL_TEXELS texels with the points grid[5 (j + 1) + i + 1]; the first point is not
 * read. Returns the power of two by which they are divided. */
float texels_write_level(const struct vec grid[25], float (*texels)[4]);

/* Reads the four points of a row from its three texels, multiplied by `scale`. */
void texels_read_row(const float (*texels)[4], double scale, struct vec row[4]);

#endif
