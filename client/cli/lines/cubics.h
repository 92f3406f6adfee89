/* Cubic pieces in the plane through points with tangents: few pieces, G1, within a tolerance. Pure,
 * any thread. */
#ifndef SHEEN_CLI_CUBICS_H
#define SHEEN_CLI_CUBICS_H

#include <stddef.h>

/* A point of a plane curve; `along` has any length, and is zero where there is no tangent. */
struct plane_point {
    double at[2], along[2];
};

struct cubic {
    double control[4][2];
};

/* Fits pieces through the n points (2 or more), in order: the first piece begins in the first
 * point, each other one where the one before ends, with its tangent. The curve passes within
 * `tolerance` of all points. `cubics` has room for n - 1 pieces. Returns their number. */
size_t cubics_fit(const struct plane_point *points, size_t n, double tolerance,
                  struct cubic *cubics);

#endif
