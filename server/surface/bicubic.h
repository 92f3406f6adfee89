/* A uniform bicubic B-spline patch over the unit square. It has 16 control points grid[4 (j + 1) +
 * (i + 1)]: i along s and j along t, both from -1 to 2. Pure, any thread, cannot fail. Private to
 * server/surface. */
#ifndef SHEEN_SURFACE_BICUBIC_H
#define SHEEN_SURFACE_BICUBIC_H

#include "server/surface/vec.h"

/* The control points of a patch in texels (texels.h). */
struct bicubic_texels {
    double scale;           /* power of two by which the stored points are divided */
    const float (*rows)[4]; /* four rows */
    /* If not NULL: the first point of each row, and the last point of each row in `rows` is not
     * used. */
    const float (*column)[4];
};

/* A point of the patch and its derivatives by s and t. */
struct bicubic_point {
    struct vec p, ps, pt, pss, pst, ptt;
};

void bicubic_read(const struct bicubic_texels *texels, struct vec grid[16]);

void bicubic_evaluate(const struct bicubic_texels *texels, double s, double t,
                      struct bicubic_point *out);

/* Cuts the patch: the control points of the same surface over the square [s, s + size] x [t, t +
 * size]. */
void bicubic_cut(const struct vec grid[16], double s, double t, double size, struct vec out[16]);

#endif
