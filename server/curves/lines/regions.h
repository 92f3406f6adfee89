/* Traces the lines on a face: divides it into its patches, finds where lines cross the borders between them, and traces
 * each patch. */
#ifndef SHEEN_LINES_REGIONS_H
#define SHEEN_LINES_REGIONS_H

#include "server/curves/lines/borders.h"
#include "server/curves/lines/trace.h"

/* All crossings of lines and borders of faces, and the signs at all vertices. */
struct border_roots {
    const struct border_vertices *vertices;
    const struct line_signs *sign; /* of each vertex */
    const size_t *first;           /* [4 n_faces + 1]: of the border whose owner is an edge */
    const struct side_root *root;  /* t runs along the owner */
};

void trace_face(struct tracer *tracer, uint32_t face, const struct border_roots *borders);

/* Sets work->levels of the CORNERs of a face: down to the first level that is smaller than the tolerance. */
void set_levels_of_face(const struct limit_tables *tables, uint32_t face, double tolerance,
                        uint8_t *levels);

#endif
