#include "server/surface/texels.h"

#include <stddef.h>

/* The range of a scale's exponent; the scale must be a normal number in single precision. */
enum { EXPONENT_MIN = -120, EXPONENT_MAX = 120 };

static int exponent_of(const struct vec *points, size_t n)
{
    double largest = 0;
    for (size_t k = 0; k < n; k++) {
        struct vec p = points[k];
        largest = fmax(largest, fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))));
    }
    int exponent = 0;
    frexp(largest, &exponent);
    exponent = exponent < EXPONENT_MIN ? EXPONENT_MIN : exponent;
    return exponent > EXPONENT_MAX ? EXPONENT_MAX : exponent;
}

/* Writes a row: four points, `stride` apart. */
static void write_row(const struct vec *points, size_t stride, double inverse, float (*texels)[4])
{
    for (size_t i = 0; i < 4; i++) {
        struct vec p = points[i * stride];
        texels[0][i] = (float)(p.x * inverse);
        texels[1][i] = (float)(p.y * inverse);
        texels[2][i] = (float)(p.z * inverse);
    }
}

void texels_write_patch(const struct vec *grid, float (*texels)[4])
{
    int exponent = exponent_of(grid, 16);
    texels[0][0] = (float)ldexp(1, exponent);
    texels[0][1] = texels[0][2] = texels[0][3] = 0;
    for (size_t j = 0; j < 4; j++)
        write_row(grid + 4 * j, 1, ldexp(1, -exponent), texels + 1 + 3 * j);
}

float texels_write_level(const struct vec grid[25], float (*texels)[4])
{
    int exponent = exponent_of(grid + 1, 24);
    for (size_t j = 0; j < 5; j++)
        write_row(grid + 5 * j + 1, 1, ldexp(1, -exponent), texels + 3 * j);
    write_row(grid + 5, 5, ldexp(1, -exponent), texels + 15);
    return (float)ldexp(1, exponent);
}

void texels_read_row(const float (*texels)[4], double scale, struct vec row[4])
{
    for (size_t i = 0; i < 4; i++)
        row[i] = vec_scale(
            (struct vec){(double)texels[0][i], (double)texels[1][i], (double)texels[2][i]}, scale);
}
