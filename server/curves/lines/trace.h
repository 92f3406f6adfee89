/* Traces lines within patches: arcs from one crossing of a border to another, as points with exact
 * normals. A line's zero set in a square is known once its F is of one sign there, or rises or
 * falls throughout along one parameter: then the set is a graph over the other parameter, and the
 * crossings on the square's border tell where it begins and ends. All other squares are quartered.
 * So no line is lost, neither a short nor a closed one (Snyder 1992).
 *
 * Where the surface is smooth and F has a saddle or an extremum of exactly 0, no square becomes a
 * graph. There a mark is set, at which arcs end. */
#ifndef SHEEN_LINES_TRACE_H
#define SHEEN_LINES_TRACE_H

#include "server/curves/lines/tracer.h"

/* Memory for the squares of one patch at a time, malloc'd; NULL when memory is short. */
struct trace_square *trace_squares_take(void);

/* A part of a surface, seen from its own corner 0, with all crossings of lines on its sides. */
struct region {
    struct line_signs sign[4]; /* at its corners */
    struct root_list side[4];
};
void region_finish(struct region *region);

/* Traces all lines in a patch, whose sides are those of the region. */
void trace_patch(struct tracer *tracer, const struct limit_patch *patch,
                 const struct patch_place *place, const struct region *region);

/* Joins the crossings on the sides of a region that is smaller than the tolerance, around an
 * extraordinary vertex. */
void trace_vertex(struct tracer *tracer, const struct patch_place *place,
                  const struct region *region);

#endif
