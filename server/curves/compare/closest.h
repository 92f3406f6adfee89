/* The counterpart of a point on another surface: where the line along the point's normal meets that surface, nearest
 * to the point; where it misses, the nearest point. Pure, any thread, cannot fail. */
#ifndef SHEEN_CURVES_COMPARE_CLOSEST_H
#define SHEEN_CURVES_COMPARE_CLOSEST_H

#include "server/curves/compare/surface_tree.h"

struct closest_rules {
    /* 1; or -1 where the other surface is wound the other way around as a whole. Surface whose normal, multiplied by
     * this, is turned by more than 90 degrees from the point's is another side of a body: only within `coincident` it
     * counts as a counterpart, for single faces that are wound differently. */
    double winding;
    double reach;      /* how far along the normal a counterpart may lie */
    double coincident; /* a distance, see above */
    /* Of places that are farther than the nearest one by no more than this, the one whose normal agrees best is taken
     * on the line, and otherwise one whose normal differs by less than 60 degrees: beside a crease the faces on both
     * sides are nearly equally near. */
    double tolerance;
};

enum closest_kind {
    CLOSEST_NONE,   /* nothing on this side of the body */
    CLOSEST_RAY,    /* on the line along the normal */
    CLOSEST_NEAR,   /* the nearest point */
    CLOSEST_BORDER, /* the nearest point, which lies where the surface ends */
};

struct closest {
    enum closest_kind kind;
    size_t leaf;
    double x, y;           /* local in the leaf */
    struct limit_point at; /* derivatives by x and y */
    double distance;       /* positive on the side to which the normal points */
};

/* A place at which the search begins, for example that of the same place in the same file: a counterpart is likely
 * nearby. */
struct closest_start {
    size_t leaf; /* SIZE_MAX: none */
    double x, y;
};

void closest_find(const struct surface_tree *tree, const struct closest_rules *rules, struct vec p,
                  struct vec n, const struct closest_start *start, struct closest *out);

/* Only the nearest point, whatever its normal. */
void closest_nearest(const struct surface_tree *tree, struct vec p, struct closest *out);

#endif
