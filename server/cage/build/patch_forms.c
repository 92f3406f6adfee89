#include "server/cage/build/patch_forms.h"

#include <string.h>

void patch_raise_curve(double p[4][3], unsigned m)
{
    for (; m < PATCH_MAX_DEGREE; m++) {
        memcpy(p[m + 1], p[m], sizeof p[m]);
        for (unsigned i = m; i > 0; i--)
            patch_blend((double)i / (m + 1), p[i], p[i - 1], p[i]);
    }
}

void patch_from_bezier(const double (*point)[3], unsigned m, unsigned n, double out[16][3])
{
    double row[4][3];
    for (unsigned j = 0; j <= n; j++) {
        memcpy(row, point + j * (m + 1), (m + 1) * sizeof *row);
        patch_raise_curve(row, m);
        memcpy(out + 4 * j, row, sizeof row);
    }
    for (unsigned i = 0; i < 4; i++) {
        for (unsigned j = 0; j <= n; j++)
            memcpy(row[j], out[4 * j + i], sizeof row[j]);
        patch_raise_curve(row, n);
        for (unsigned j = 0; j < 4; j++)
            memcpy(out[4 * j + i], row[j], sizeof row[j]);
    }
}
