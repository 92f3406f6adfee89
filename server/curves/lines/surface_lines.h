/* All lines of a set on a surface, as curves: a computation (computation.h) in four phases. It
 * finds the signs at the vertices of faces, the crossings on their borders, the arcs on each face,
 * and joins them. */
#ifndef SHEEN_LINES_SURFACE_LINES_H
#define SHEEN_LINES_SURFACE_LINES_H

#include "server/curves/lines/chains.h"
#include "server/curves/computation.h"
#include "server/curves/fields/line_set.h"

struct surface_lines;

/* What was found. Owned by the computation. */
struct surface_lines_result {
    const struct line_set *set; /* what was asked for */
    const struct curve_set *curves;
    const struct traced_mark *marks; /* where arcs end or a line covers a part of the surface */
    size_t n_marks;
    size_t n_cells, n_deepest; /* squares that were decided, and how often one was halved */
};

/* Makes the computation: lines to within `tolerance` (world units, above 0) of polylines. It takes
 * at most about `most_bytes`, and fails when it needs more. `tables` must stay valid; `set` is
 * copied. NULL with ERROR_SERVER when memory is short. */
struct surface_lines *surface_lines_create(const struct limit_tables *tables,
                                           const struct line_set *set, double tolerance,
                                           size_t most_bytes, struct error *error);
struct computation *surface_lines_computation(struct surface_lines *lines);

/* After the last phase. */
struct surface_lines_result surface_lines_get(const struct surface_lines *lines);

#endif
