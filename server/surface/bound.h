/* How far a B-spline net reaches and how much it bends: what chooses the grid it is drawn with. */
#ifndef SHEEN_SURFACE_BOUND_H
#define SHEEN_SURFACE_BOUND_H

#include <stdbool.h>

#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* Of a size x size grid about the coordinates' origin. Second and mixed differences bound the
 * second derivatives of every patch of the grid (limit-surface 3.2). without_first: the first
 * point is not one.
 *
 * weighed: an offset counts by what lies across the surface and a quarter of what lies along it,
 * which moves only the parameters that a pixel starts from, not what is seen; but borders, which
 * may be outlines, by the plain distance. All counts where the normal turns by more than 45
 * degrees. */
struct limit_bound bound_of_grid(const struct vec *grid, int size, bool without_first,
                                 bool weighed);

/* How much it bends in all: within an eighth of this it is one cell. */
static inline float bound_bend(const struct limit_bound *bound)
{
    float bend = bound->u + 2 * bound->mixed + bound->v;
    float border = bound->border_u > bound->border_v ? bound->border_u : bound->border_v;
    return bend > border ? bend : border;
}

#endif
