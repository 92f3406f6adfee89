#include "server/limit/texels.h"

/* Powers of two that are normal numbers in single precision, with room for a square root's worth
 * of products. */
enum { EXPONENT_MIN = -120, EXPONENT_MAX = 120 };

void texels_write(const struct vec *points, size_t n, float (*texels)[3])
{
    double largest = 0;
    for (size_t k = 0; k < n; k++) {
        struct vec p = points[k];
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    int exponent = 0;
    frexp(largest, &exponent);
    exponent = exponent < EXPONENT_MIN ? EXPONENT_MIN : exponent;
    exponent = exponent > EXPONENT_MAX ? EXPONENT_MAX : exponent;
    double inverse = ldexp(1, -exponent);
    (*texels)[0] = (float)ldexp(1, exponent);
    (*texels)[1] = (*texels)[2] = 0;
    texels++;
    for (size_t k = 0; k < n; k++) {
        texels[k][0] = (float)(points[k].x * inverse);
        texels[k][1] = (float)(points[k].y * inverse);
        texels[k][2] = (float)(points[k].z * inverse);
    }
}
