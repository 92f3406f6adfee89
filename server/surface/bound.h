/* How far a net of control points reaches and how much it bends. Pure; any thread. */
#ifndef SHEEN_SURFACE_BOUND_H
#define SHEEN_SURFACE_BOUND_H

#include <stdbool.h>

#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* Of a size x size grid of B-spline control points, size 4 or 5, about the coordinates' origin:
 * largest second and mixed differences, which bound the second derivatives of every bicubic patch
 * of the grid (README.md 6.1). without_first: there is no first point.
 *
 * weighed: of a second difference inside the surface the part across the surface counts whole and
 * the part along it a quarter. What lies along the surface moves only the parameters that a pixel's
 * solution starts from, not what is seen. Differences along the borders (border_u, border_v), which
 * may be outlines, always count whole, and so do all where the net's normal turns by more than 45
 * degrees. */
struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 bool weighed);

/* How much it bends in all: where this is no more than 8 times a distance, one cell of two
 * triangles stays within that distance of the surface. */
static inline float bound_bend(const struct limit_bound *bound)
{
    float bend = bound->u + 2 * bound->mixed + bound->v;
    float border = bound->border_u > bound->border_v ? bound->border_u : bound->border_v;
    return bend > border ? bend : border;
}

#endif
