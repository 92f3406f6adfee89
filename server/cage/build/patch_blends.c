#include "server/cage/build/patch_blends.h"

#include <stdbool.h>
#include <string.h>

#include "server/cage/build/patch_forms.h"

/* out = p + x a / y. */
static void add(const double p[3], double x, const double a[3], double y, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = p[k] + x * a[k] / y;
}

void patch_from_hermite(const struct patch_corner corner[4], double out[16][3])
{
    for (int c = 0; c < 4; c++) {
        const struct patch_corner *at = &corner[c];
        const int i = c & 1 ? 3 : 0, j = c & 2 ? 3 : 0, x = c & 1 ? -1 : 1, y = c & 2 ? -1 : 1;
        double *inner = out[4 * (j + y) + i + x];
        memcpy(out[4 * j + i], at->p, sizeof at->p);
        add(at->p, x, at->pu, 3, out[4 * j + i + x]);
        add(at->p, y, at->pv, 3, out[4 * (j + y) + i]);
        add(out[4 * j + i + x], y, at->pv, 3, inner);
        add(inner, x * y, at->puv, 9, inner);
    }
}

/* The end of a side at corner c, which is the mean of the ends of two sides. */
static void corner_of(double side[N_PATCH_SIDES][4][3], int c, double out[3])
{
    const double *a = side[c & 2 ? SIDE_V1 : SIDE_V0][c & 1 ? 3 : 0];
    const double *b = side[c & 1 ? SIDE_U1 : SIDE_U0][c & 2 ? 3 : 0];
    patch_blend(0.5, a, b, out);
}

void patch_from_coons(double side[N_PATCH_SIDES][4][3], double out[16][3])
{
    double corner[4][3];
    for (int c = 0; c < 4; c++)
        corner_of(side, c, corner[c]);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            double along_u[3], along_v[3], low[3], high[3], both[3];
            patch_blend(j / 3.0, side[SIDE_V0][i], side[SIDE_V1][i], along_u);
            patch_blend(i / 3.0, side[SIDE_U0][j], side[SIDE_U1][j], along_v);
            patch_blend(i / 3.0, corner[0], corner[1], low);
            patch_blend(i / 3.0, corner[2], corner[3], high);
            patch_blend(j / 3.0, low, high, both);
            for (int k = 0; k < 3; k++)
                out[4 * j + i][k] = along_u[k] + (along_v[k] - both[k]);
        }
}

/* The derivative of a cubic Bezier curve at one of its ends. */
static void end_slope(double curve[4][3], bool at_end, double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = 3 * (at_end ? curve[3][k] - curve[2][k] : curve[1][k] - curve[0][k]);
}

/* What both sides at corner c say about it, in the mean. */
static struct patch_corner coons_corner(double side[N_PATCH_SIDES][4][3],
                                        double across[N_PATCH_SIDES][4][3], int c)
{
    const bool u1 = c & 1, v1 = c & 2;
    const enum patch_side along_u = v1 ? SIDE_V1 : SIDE_V0, along_v = u1 ? SIDE_U1 : SIDE_U0;
    struct patch_corner at = {.p = {0}};
    double a[3], b[3];
    corner_of(side, c, at.p);
    end_slope(side[along_u], u1, a);
    patch_blend(0.5, a, across[along_v][v1 ? 3 : 0], at.pu);
    end_slope(side[along_v], v1, a);
    patch_blend(0.5, a, across[along_u][u1 ? 3 : 0], at.pv);
    end_slope(across[along_u], u1, a);
    end_slope(across[along_v], v1, b);
    patch_blend(0.5, a, b, at.puv);
    return at;
}

/* The net of cubic Hermite interpolation from one side to the opposite one: four curves. */
static void between(double first[4][3], double first_across[4][3], double last[4][3],
                    double last_across[4][3], double out[4][4][3])
{
    for (int k = 0; k < 4; k++) {
        memcpy(out[0][k], first[k], sizeof out[0][k]);
        add(first[k], 1, first_across[k], 3, out[1][k]);
        add(last[k], -1, last_across[k], 3, out[2][k]);
        memcpy(out[3][k], last[k], sizeof out[3][k]);
    }
}

void patch_from_bicubic_coons(double side[N_PATCH_SIDES][4][3], double across[N_PATCH_SIDES][4][3],
                              double out[16][3])
{
    struct patch_corner corner[4];
    double over_v[4][4][3], over_u[4][4][3], both[16][3];
    for (int c = 0; c < 4; c++)
        corner[c] = coons_corner(side, across, c);
    patch_from_hermite(corner, both);
    between(side[SIDE_V0], across[SIDE_V0], side[SIDE_V1], across[SIDE_V1], over_v);
    between(side[SIDE_U0], across[SIDE_U0], side[SIDE_U1], across[SIDE_U1], over_u);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                out[4 * j + i][k] = over_v[j][i][k] + (over_u[i][j][k] - both[4 * j + i][k]);
}
