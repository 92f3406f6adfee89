/* How far a B-spline net reaches and how much it bends: what chooses the grid it is drawn with. */
#ifndef SHEEN_LIMIT_BOUND_H
#define SHEEN_LIMIT_BOUND_H

#include <stdbool.h>

#include "server/limit/tables.h"
#include "server/limit/vec.h"

/* Of a size x size grid about the coordinates' origin. Second and mixed differences bound the
 * second derivatives of every patch of the grid (limit-surface 3.2), so a patch cut into m x m
 * cells lies within bend / (8 m^2) of its triangles. without_first: the first point is not one.
 *
 * weighed: an offset counts by what lies across the surface and a quarter of what lies along it,
 * which moves only the parameters that a pixel starts from, not what is seen; but borders, which
 * may be outlines, by the plain distance. All counts where the normal turns by more than 45
 * degrees. */
struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 bool weighed);

#endif
