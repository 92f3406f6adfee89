#include "server/cage/read/numbers/transform.h"

#include <math.h>

struct transform transform_identity(void)
{
    return (struct transform){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

struct transform transform_multiply(const struct transform *a, const struct transform *b)
{
    struct transform product;
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a->m[4 * k + row] * b->m[4 * column + k];
            product.m[4 * column + row] = sum;
        }
    }
    return product;
}

struct transform transform_compose(const double translation[3], const double rotation[4],
                                   const double scale[3])
{
    double q[4], norm = 0;
    for (int i = 0; i < 4; i++)
        norm += rotation[i] * rotation[i];
    /* Files have single precision, in which a quaternion's length is 1 only to 1e-7. */
    for (int i = 0; i < 4; i++)
        q[i] = norm > 0 ? rotation[i] / sqrt(norm) : 0;
    double x = q[0], y = q[1], z = q[2], w = q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w),     2 * (x * z - y * w),
                         2 * (x * y - z * w),     1 - 2 * (x * x + z * z), 2 * (y * z + x * w),
                         2 * (x * z + y * w),     2 * (y * z - x * w),     1 - 2 * (x * x + y * y)};
    struct transform result = transform_identity();
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++)
            result.m[4 * column + row] = r[3 * column + row] * scale[column];
    for (int row = 0; row < 3; row++)
        result.m[12 + row] = translation[row];
    return result;
}

void transform_point(const struct transform *transform, const double in[3], double out[3])
{
    const double *m = transform->m;
    for (int i = 0; i < 3; i++)
        out[i] = m[i] * in[0] + m[4 + i] * in[1] + m[8 + i] * in[2] + m[12 + i];
}

double transform_determinant(const struct transform *transform)
{
    const double *m = transform->m;
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9]) +
           m[8] * (m[1] * m[6] - m[2] * m[5]);
}
