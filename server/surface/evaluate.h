/* The limit tables evaluated on the CPU as tables.h describes them, in double from the single
 * precision points: what shaders/surface.glsl does. Pure; any thread.
 *
 * A place is (a,b) in [0,1] on a node and what lies below it, seen from one of the node's corners:
 * that corner is at (0,0), the next at (1,0). From corner 0 of a Ptex face's root that is (u,v);
 * near another corner doubles tell places apart from there that (u,v) would not. */
#ifndef SHEEN_SURFACE_EVALUATE_H
#define SHEEN_SURFACE_EVALUATE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/surface/tables.h"
#include "server/surface/vec.h"

struct limit_place {
    uint32_t node; /* a Ptex face's root is the node of that number */
    unsigned corner;
    double a, b;
};

/* World. At an extraordinary vertex itself all derivatives are zero: only the normal is known.
 *
 * Where the vertex has no single normal (ring.h) has_normal is false, and n is the normal that the
 * face's own corner comes to there: for who must draw something. */
struct limit_point {
    struct vec s;
    struct vec su, sv, suu, suv, svv; /* by u and v, or by the place's a and b */
    struct vec n;                     /* unit, along the face winding; zero where there is none */
    bool has_normal;
    double luu, luv, lvv; /* second derivatives along n; a rotation out of suu would lose digits */
};

/* One bicubic sub-patch and a place on it. */
struct limit_patch {
    const struct limit_node *node;
    double scale;           /* the points are divided by it */
    const float (*rows)[4]; /* texels of four rows (texels.h) */
    const float (
        *column)[4];      /* not NULL: these points come first in the rows, whose last drop out */
    int level_x, level_y; /* s and t run 2^level times faster than the node's local x and y */
    double s, t;          /* in [0,1] */
    unsigned turn;        /* local x, y are the place's a, b seen from so many corners on */
    int depth;            /* the node spans 2^-depth of the place's node */
    bool is_vertex;       /* beyond a CORNER's last level: the extraordinary vertex itself */
};

/* The sub-patch of level n (1 first) of a CORNER or STRIP that holds local (x,y), or of a REGULAR
 * node, for which n is 0. On the seam of two levels both may be asked. */
void limit_patch_of_level(struct limit_patch *patch, const struct limit_tables *tables,
                          const struct limit_node *node, int n, double x, double y);

/* The sub-patch that holds a place. False in a hole. */
bool limit_patch_find(const struct limit_tables *tables, const struct limit_place *place,
                      struct limit_patch *patch);

/* Its 16 points, 4 (j + 1) + (i + 1), in the node's frame and world units. */
void limit_patch_points(const struct limit_patch *patch, struct vec grid[16]);

/* A vector of a node's frame in the world. */
struct vec limit_frame_to_world(const struct limit_tables *tables, const struct limit_node *node,
                                struct vec v);

/* The patch at its place; the tables are those it was found in. */
void limit_patch_evaluate(const struct limit_tables *tables, const struct limit_patch *patch,
                          struct limit_point *out);

/* Both at once. False in a hole, which leaves *out alone. */
bool limit_evaluate_at(const struct limit_tables *tables, const struct limit_place *place,
                       struct limit_point *out);

/* (u,v) of a Ptex face. */
bool limit_evaluate(const struct limit_tables *tables, uint32_t face, double u, double v,
                    struct limit_point *out);

#endif
