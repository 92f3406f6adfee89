/* Converts patches of other forms to bicubic Bezier patches: exactly but for rounding, in double.
 * Parameters are u and v in [0,1]; of two indices i along u is the faster one. Pure, any thread.
 * Internal to server/cage. */
#ifndef SHEEN_CAGE_BUILD_PATCH_FORMS_H
#define SHEEN_CAGE_BUILD_PATCH_FORMS_H

#include <stdbool.h>
#include <stddef.h>

#include "server/cage/patch.h"

/* The largest degree that a bicubic patch holds. */
#define PATCH_MAX_DEGREE 3

/* out = (1 - t) a + t b; exact for t = 0 and 1. out may be a or b. */
static inline void patch_blend(double t, const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (1 - t) * a[k] + t * b[k];
}

/* Raises the degree of a Bezier curve of degree m, 1 to 3, to 3: p[0..m] become p[0..3] (Farin,
 * Curves and Surfaces for CAGD, chapter 6: b_i' = i/(m+1) b_(i-1) + (1 - i/(m+1)) b_i). */
void patch_raise_curve(double p[4][3], unsigned m);

/* A Bezier patch of degree m x n, each 1 to 3: (m+1)(n+1) points, point[j (m + 1) + i]. */
void patch_from_bezier(const double (*point)[3], unsigned m, unsigned n, double out[16][3]);

#endif
