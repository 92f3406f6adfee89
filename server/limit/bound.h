/* How far a B-spline net reaches and how much it bends: what chooses the grid it is drawn with. */
#ifndef SHEEN_LIMIT_BOUND_H
#define SHEEN_LIMIT_BOUND_H

#include <stdbool.h>

#include "server/limit/tables.h"
#include "server/limit/vec.h"

/* How much an offset inside the surface counts: what lies along it moves only the parameters that a
 * pixel starts from, not what is seen, so a quarter of that. `normal` is the surface's, or zero
 * where it turns too far to have one: then all counts. A norm, so bounds hold in it. */
double bound_weigh(struct vec offset, struct vec normal);

/* The normal of a size x size net, zero where it turns by more than 45 degrees. */
struct vec bound_normal(const struct vec *grid, int size, bool without_first);

/* Of a size x size grid about the coordinates' origin. Second and mixed differences bound the
 * second derivatives of every patch of the grid (limit-surface 3.2), so a patch cut into m x m
 * cells lies within bend / (8 m^2) of its triangles, weighed by the normal; and its borders, which
 * may be outlines, by the plain distance. without_first: the first point is not one. */
struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 struct vec normal);

#endif
