/* Files of curves: SVG, DXF, CSV, JSON. All write to a stream of the caller, which reports errors.
 *
 * Thread: one. */
#ifndef SHEEN_CLIENT_CURVE_FILES_H
#define SHEEN_CLIENT_CURVE_FILES_H

#include <stdio.h>

#include "client/cli/lines/curve_view.h"

struct curve_drawing {
    const struct sheen_curves *curves;
    const struct curve_part *parts; /* of curve_parts() */
    size_t n_parts;
    const struct projection *projection;
    bool visible_only; /* SVG and DXF: leave hidden parts out; CSV and JSON: points of them */
};

/* Visible parts as cubic paths in pixels, a group for each line, in a group for each light; hidden parts dashed.
 * False when memory is short. */
bool curve_write_svg(FILE *out, const struct curve_drawing *drawing);
/* DXF R12: 3-D polylines through all points, on a layer for each light. */
void curve_write_dxf(FILE *out, const struct curve_drawing *drawing);
/* A line for each point, with a heading; numbers have all digits. */
void curve_write_csv(FILE *out, const struct curve_drawing *drawing);

#endif
