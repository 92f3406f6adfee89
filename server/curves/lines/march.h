/* Marches along a line within a square in which the line is a graph over one parameter. */
#ifndef SHEEN_LINES_MARCH_H
#define SHEEN_LINES_MARCH_H

#include "server/curves/lines/tracer.h"

/* A patch and a line on it. */
struct march {
    struct tracer *tracer;
    const struct patch_place *place;
    const struct patch_field *on;
    uint32_t line; /* its number in the set */
};

/* An end of an arc: a crossing of the square's border. */
struct march_end {
    double at[2]; /* the patch's u and v */
    int fixed;    /* the parameter that is constant along the border; -1: no border */
    uint64_t node;
};

/* A square of the patch: its parameters go from at[k] to at[k] + size. */
struct march_square {
    double at[2], size;
};

/* Adds the arc from `from` to `to`, where the line is a graph over parameter `axis` and F rises
 * (slope 1) or falls (-1) along the other. Parts that no ray meets are left out. */
void march_arc(const struct march *march, const struct march_square *square, int axis, int slope,
               const struct march_end *from, const struct march_end *to);

/* Adds the arc as a straight piece between both ends: for pieces that are shorter than rounding or
 * the tolerance. */
void march_straight(const struct march *march, const struct march_end *from,
                    const struct march_end *to);

/* The point of the line's patch at (u,v), with the line's tangent. */
struct traced_point march_point(const struct march *march, const double at[2]);

/* Adds an arc that consists of the points themselves. */
void march_add(struct tracer *tracer, uint32_t line, uint64_t from, uint64_t to,
               const struct traced_point *points, size_t n);
void march_mark(struct tracer *tracer, enum traced_mark_kind kind, uint32_t line, uint64_t node,
                const struct traced_point *at);

#endif
