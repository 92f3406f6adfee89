/* What is found while lines are traced, and the memory of whoever traces. */
#ifndef SHEEN_LINES_TRACER_H
#define SHEEN_LINES_TRACER_H

#include "server/curves/lines/sides.h"

/* A point of a line. */
struct traced_point {
    uint32_t face;
    double u, v;      /* on the face */
    struct vec p, n;  /* world; n has unit length */
    struct vec along; /* unit tangent of the line; zero where it is not known */
    double residual;  /* field_residual() */
};

struct traced_arc {
    uint64_t node[2];
    uint32_t line;
    uint32_t first, n; /* of its points, at least 2 */
};

enum traced_mark_kind {
    MARK_SINGULAR, /* lines meet, or a line is a point; or a limit was reached before it was decided */
    MARK_FLAT,     /* the line is a whole part of the surface */
};

struct traced_mark {
    enum traced_mark_kind kind;
    uint32_t line;
    uint64_t node; /* arcs that end in the mark have this number */
    struct traced_point at;
};

/* What was found, in the order in which it was found. */
struct traced {
    struct traced_point *point;
    struct traced_arc *arc;
    struct traced_mark *mark;
    size_t n_points, n_arcs, n_marks, room_points, room_arcs, room_marks;
};
void traced_finish(struct traced *traced);
size_t traced_bytes(const struct traced *traced);

/* For all lines on one patch together: squares that are halved, parts of their sides where ranges cannot tell the sign of F,
 * and steps of Newton's method beyond the usual number. Beyond this many, what is undecided is marked. Where the normal is
 * little more than rounding, lines wind so much that those of one patch took more than a minute. */
enum { TRACE_MOST_WORK = 1 << 18 };

struct tracer {
    struct sides_work work;
    struct trace_square *squares; /* trace_squares_take() */
    double tolerance;   /* greatest distance between a polyline and its line, world units */
    size_t most_points; /* room for points; with more, is_over and work.failed are set */
    bool is_over;
    struct traced out;
    size_t n_work;             /* on the patch so far; see TRACE_MOST_WORK */
    size_t n_cells, n_deepest; /* squares looked at; the most often halved one */
};

/* Where a patch lies on its face: local (x,y) = (x0,y0) + (width s, height t) of a node. */
struct patch_place {
    uint32_t node;
    double x0, y0, width, height;
};

/* The face and (u,v) of a local place of a node. */
void trace_face_place(const struct limit_tables *tables, uint32_t node, double x, double y,
                      struct traced_point *point);

#endif
