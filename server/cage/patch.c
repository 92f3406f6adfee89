#include "server/cage/patch.h"

#include <string.h>

/* Converts coordinate k of four points that are `stride` apart. */
static void to_bezier(double (*p)[3], int stride, int k)
{
    double a = p[0][k], b = p[stride][k], c = p[2 * stride][k], d = p[3 * stride][k];
    p[0][k] = (a + 4 * b + c) / 6;
    p[stride][k] = (2 * b + c) / 3;
    p[2 * stride][k] = (b + 2 * c) / 3;
    p[3 * stride][k] = (b + 4 * c + d) / 6;
}

/* The sums are taken of differences, which are small where the model is far from the origin. */
static void to_bspline(double (*p)[3], int stride, int k)
{
    double a = p[0][k], b = p[stride][k], c = p[2 * stride][k], d = p[3 * stride][k];
    double middle = c - b;
    p[0][k] = b + (6 * (a - b) + 2 * middle);
    p[stride][k] = b - middle;
    p[2 * stride][k] = c + middle;
    p[3 * stride][k] = c + (6 * (d - c) - 2 * middle);
}

static void convert(const struct cage_patch *patch, enum cage_basis wanted,
                    void (*change)(double (*p)[3], int stride, int k), double out[16][3])
{
    memcpy(out, patch->point, sizeof patch->point);
    if (patch->basis == wanted)
        return;
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 4; j++)
            change(out + 4 * j, 1, k);
        for (int i = 0; i < 4; i++)
            change(out + i, 4, k);
    }
}

void cage_patch_bezier(const struct cage_patch *patch, double out[16][3])
{
    convert(patch, CAGE_BEZIER, to_bezier, out);
}

void cage_patch_bspline(const struct cage_patch *patch, double out[16][3])
{
    convert(patch, CAGE_BSPLINE, to_bspline, out);
}
