/* A uniform bicubic B-spline patch: 16 control points grid[4 (j + 1) + (i + 1)], i along s and j
 * along t in -1..2, over the unit square. Pure; any thread; no failure. Private to server/surface.
 */
#ifndef SHEEN_SURFACE_BICUBIC_H
#define SHEEN_SURFACE_BICUBIC_H

#include "server/surface/vec.h"

/* Where a patch's points lie in texels (texels.h). */
struct bicubic_texels {
    double scale;           /* the points are divided by it */
    const float (*rows)[4]; /* four rows */
    /* Not NULL: four points that come first in the rows, whose last ones drop out. */
    const float (*column)[4];
};

/* The patch and its derivatives by s and t. */
struct bicubic_point {
    struct vec p, ps, pt, pss, pst, ptt;
};

void bicubic_read(const struct bicubic_texels *texels, struct vec grid[16]);

void bicubic_evaluate(const struct bicubic_texels *texels, double s, double t,
                      struct bicubic_point *out);

/* The control points of the same surface over the square [s, s + size] x [t, t + size]. */
void bicubic_cut(const struct vec grid[16], double s, double t, double size, struct vec out[16]);

#endif
