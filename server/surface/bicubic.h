/* A uniform bicubic B-spline patch over the unit square. It has 16 control points grid[4 (j + 1) +
 * (i + 1)]: i along s and j along t, both from -1 to 2. Pure, any thread, cannot fail. Private to
 * server/surface. */
#ifndef SHEEN_SURFACE_BICUBIC_H
#define SHEEN_SURFACE_BICUBIC_H

#include "server/surface/vec.h"

/* The control points of a patch, in texels (texels.h) and perhaps also in double precision. */
struct bicubic_points {
    double scale;           /* power of two by which the points in texels are divided */
    const float (*rows)[4]; /* four rows */
    /* If not NULL: the first point of each row is taken from `column`, followed by the first three
     * points of the row in `rows`. */
    const float (*column)[4];
    /* If not NULL: point (-1,-1) before it was rounded; the next row begins `stride` points
     * further. */
    const struct vec *exact;
    int stride;
};

/* A point of the patch and its derivatives by s and t. */
struct bicubic_point {
    struct vec p, ps, pt, pss, pst, ptt;
};

/* Copies the points, in double precision where they are given so. */
void bicubic_read(const struct bicubic_points *points, struct vec grid[16]);

void bicubic_evaluate(const struct bicubic_points *points, double s, double t,
                      struct bicubic_point *out);

/* Cuts the patch: the control points of the same surface over the square [s, s + size] x [t, t +
 * size]. */
void bicubic_cut(const struct vec grid[16], double s, double t, double size, struct vec out[16]);

#endif
