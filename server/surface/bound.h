/* Bounds how far a net of control points extends and how much it bends. Pure, any thread. */
#ifndef SHEEN_SURFACE_BOUND_H
#define SHEEN_SURFACE_BOUND_H

#include <stdbool.h>

#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* Bounds a grid of size x size B-spline control points (size 4 or 5) about the origin of their
 * coordinates, by its largest second and mixed differences, which bound the second derivatives of
 * every bicubic patch of the grid (README.md 6.1). without_first: the first point is missing.
 *
 * weighed: the part of a second difference along the normal counts fully, the part along the
 * surface a quarter, because the latter only changes the parameters that a pixel's solution starts
 * from, not what is visible. Differences along the borders (border_u, border_v), which may be
 * outlines, always count fully, and so do all differences if the net's normal turns by more than 45
 * degrees. */
struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 bool weighed);

/* The total bend. If it is at most 8 times a distance, one cell of two triangles lies within that
 * distance of the surface. */
static inline float bound_bend(const struct limit_bound *bound)
{
    float bend = bound->u + 2 * bound->mixed + bound->v;
    float border = bound->border_u > bound->border_v ? bound->border_u : bound->border_v;
    return bend > border ? bend : border;
}

#endif
