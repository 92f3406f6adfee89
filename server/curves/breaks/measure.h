/* What breaks at one edge or vertex is measured by, at one place and at the worst one. Private to breaks*.c. Pure,
 * any thread. */
#ifndef SHEEN_CURVES_BREAKS_MEASURE_H
#define SHEEN_CURVES_BREAKS_MEASURE_H

#include "protocol/break_records.h"
#include "server/curves/breaks/break_limits.h"
#include "server/curves/edges.h"
#include "server/curves/line_position.h"

/* An edge by its severity, for sorting. */
struct break_sorted {
    double severity;
    size_t index;
};

/* What all edges of a computation are measured with. */
struct break_setup {
    const struct limit_tables *tables;
    struct break_limits limits;
    struct line_map lights[MAX_LIGHTS];
    uint32_t n_lights;
};

/* Measures an edge of this kind, enum break_kind. False where the surface cannot be evaluated on both sides. */
bool breaks_measure_edge(const struct break_setup *setup, const struct surface_edge *edge,
                         uint8_t kind, struct break_edge *out);

/* How far over its limits an edge is: the largest quotient of a measure and its limit. */
double breaks_severity(const struct break_setup *setup, const struct break_edge *edge);

struct break_border;

/* Measures border->of: sets the other members. */
void breaks_measure_border(const struct limit_tables *tables, struct break_border *border);

/* Measures the curvature around a vertex. False if there is none. */
bool breaks_measure_sector(const struct limit_tables *tables, const struct surface_sector *sector,
                           struct break_vertex *out);

#endif
