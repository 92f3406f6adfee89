#include "server/curves/lines/tracer.h"

#include <math.h>
#include <stdlib.h>

void traced_finish(struct traced *traced)
{
    free(traced->point);
    free(traced->arc);
    free(traced->mark);
    *traced = (struct traced){0};
}

size_t traced_bytes(const struct traced *traced)
{
    return traced->room_points * sizeof *traced->point + traced->room_arcs * sizeof *traced->arc +
           traced->room_marks * sizeof *traced->mark;
}

void trace_face_place(const struct limit_tables *tables, uint32_t index, double x, double y,
                      struct traced_point *point)
{
    const struct limit_node *node = &tables->nodes[index];
    const double as[4] = {x, 1 - y, 1 - x, y}, bs[4] = {y, x, 1 - y, 1 - x};
    double a = as[node->rotation & 3], b = bs[node->rotation & 3];
    point->face = node->face;
    point->u = ldexp((double)(node->cell & 0xffff) + a, -node->depth);
    point->v = ldexp((double)(node->cell >> 16) + b, -node->depth);
}
