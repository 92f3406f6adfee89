/* 4x4 matrices that place the parts of a file, in double precision. Pure, any thread. */
#ifndef SHEEN_CAGE_READ_NUMBERS_TRANSFORM_H
#define SHEEN_CAGE_READ_NUMBERS_TRANSFORM_H

#ifdef __cplusplus
extern "C" {
#endif

/* Column-major, so that a point is a column to the right of the matrix; the last row is 0 0 0 1.
 * glTF stores it so. The numbers of USD's matrices, which are row-major for points as rows, have the
 * same order. */
struct transform {
    double m[16];
};

struct transform transform_identity(void);

/* The transform that applies b first, then a. */
struct transform transform_multiply(const struct transform *a, const struct transform *b);

/* Scale first, then rotation by the quaternion x, y, z, w (of any length but 0), then
 * translation. */
struct transform transform_compose(const double translation[3], const double rotation[4],
                                   const double scale[3]);

void transform_point(const struct transform *transform, const double in[3], double out[3]);

/* The determinant of the upper 3x3: negative where the transform mirrors. */
double transform_determinant(const struct transform *transform);

#ifdef __cplusplus
}
#endif

#endif
