/* Cuts a B-spline surface into bicubic patches: exactly but for rounding, in double, by the polar
 * form (Ramshaw 1989). Pure, any thread. Internal to server/cage. */
#ifndef SHEEN_CAGE_BUILD_SPLINE_SURFACE_H
#define SHEEN_CAGE_BUILD_SPLINE_SURFACE_H

#include "server/cage/build/builder.h"

/* One of both parameters of a surface. */
struct spline_axis {
    unsigned degree;    /* 1 to 3 */
    size_t n;           /* control points, more than the degree */
    const double *knot; /* [n + degree + 1], not decreasing, each at most degree + 1 times */
    double low, high;   /* the part of the surface: within knot[degree] to knot[n], low < high */
};

/* Adds the surface's patches to a builder, one for each pair of spans of different knots, those
 * along u first. point[j u->n + i] are the control points. A patch of degree 3 x 3 between uniform
 * knots keeps its 16 control points, bit by bit; the others become Bezier patches. `line` is the
 * surface's in the file. False with ERROR_SERVER when memory is short, or with ERROR_MODEL for too
 * many patches. */
bool spline_surface_add(struct cage_builder *builder, const struct spline_axis *u,
                        const struct spline_axis *v, const double (*point)[3], uint32_t line,
                        struct error *error);

/* Gets the Bezier points out[0..p] of the part [a,b] of a B-spline curve of degree p, 1 to 3: a and
 * b lie in the span knot[p..p+1], a < b; knot[1..2p] are read. control[0..p] are the control points
 * of this span, `stride` apart. */
void spline_span(const double (*control)[3], size_t stride, unsigned p, const double *knot,
                 double a, double b, double out[4][3]);

#endif
