/* Joins arcs to curves: an arc ends at a crossing of a border, where the arc on the border's other side begins. */
#ifndef SHEEN_LINES_CHAINS_H
#define SHEEN_LINES_CHAINS_H

#include "server/base/error.h"
#include "server/curves/lines/tracer.h"

/* A curve: one line of the set, from end to end or closed. */
struct curve {
    uint32_t line;
    bool closed;     /* the last point is followed by the first one */
    size_t first, n; /* of its points */
};

struct curve_set {
    struct curve *curve;
    struct traced_point *point;
    double *length; /* of the polyline from the curve's first point to each point, world units */
    size_t n_curves, n_points;
};

/* Makes the curves of n parts of a surface, in the order of lines; of one line, in the order of the arcs. At a crossing
 * where more than two arcs of a line end, curves end. False with ERROR_SERVER when memory is short; there is then
 * nothing to finish. */
bool curve_set_make(struct curve_set *set, const struct traced *parts, size_t n,
                    struct error *error);
void curve_set_finish(struct curve_set *set);

#endif
