/* The smallest part of a surface that is one polynomial: a patch, found by a place on the surface
 * or by where it stands in its node. How many kinds of node there are, how many corners a node's
 * domain has and of which degree its patches are is known behind this interface and in evaluate.c;
 * users take a patch, evaluate it (evaluate.h) and bound it.
 *
 * Patches point into the tables they were found in, or hold points that were made for them: a copy of a
 * patch still reads the first one's. Any thread; no failure. */
#ifndef SHEEN_SURFACE_PATCH_H
#define SHEEN_SURFACE_PATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "server/surface/bicubic.h"
#include "server/surface/source.h"
#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* (a,b) in [0,1] on a node and what lies below it, seen from one of the node's corners: that corner
 * is at (0,0), the next one at (1,0). From corner 0 of a face's root that is the face's (u,v); near
 * another corner doubles tell places apart from there that (u,v) would not. */
struct limit_place {
    uint32_t node; /* a face's root is the node of the face's number */
    unsigned corner;
    double a, b;
};

/* One patch and a place on it. */
struct limit_patch {
    const struct limit_node *node;
    struct bicubic_texels points; /* every present kind of node holds bicubic patches */
    double s, t;                  /* the place by the patch's own parameters, in [0,1] */
    int level_x, level_y;    /* s and t run 2^level times faster than the node's local x and y */
    unsigned turn;           /* local x, y are the place's a, b seen from so many corners on */
    int depth;               /* the node spans 2^-depth of the place's node */
    bool is_vertex;          /* beyond a CORNER's last level: the extraordinary vertex itself */
    struct limit_level made; /* of tables on demand: the points */
};

/* The patch that holds a place. False in a hole. */
bool limit_patch_find(const struct limit_tables *tables, const struct limit_place *place,
                      struct limit_patch *patch);

/* The patch of level n (from 1) of a CORNER or STRIP that holds local (x,y), or that of a REGULAR
 * node, for which n is 0. A STRIP's last patch has its number of levels plus 1. On the seam of two
 * levels both may be asked for. */
void limit_patch_of_level(struct limit_patch *patch, const struct limit_tables *tables,
                          const struct limit_node *node, int n, double x, double y);

/* The 16 control points of the patch, a uniform bicubic B-spline: grid[4 (j + 1) + (i + 1)], i along s
 * and j along t in -1..2, in the frame of the node and in units of the model. Returns the power of two
 * that the tables divide them by. For devices that evaluate patches themselves. */
double limit_patch_points(const struct limit_patch *patch, struct vec grid[16]);

/* The square [s, s + size] x [t, t + size] of a patch's parameters. */
struct limit_square {
    double s, t, size;
};

/* How far that part of the patch reaches from `centre`, which is world, and how much it bends as a
 * part of the model (bound.h: weighed by its normal). With `unseen`, a unit vector: at most what it
 * bends across that, for a camera that looks along it and sees no more. */
struct limit_bound limit_patch_bound(const struct limit_tables *tables,
                                     const struct limit_patch *patch, struct limit_square part,
                                     const struct vec *unseen, double centre[3]);

/* Turns a vector from the frame of a CORNER node into the world. */
struct vec limit_turn_to_world(const struct limit_tables *tables, const struct limit_node *node,
                               struct vec v);

/* A vector of a node's frame in the world: only a CORNER has a frame of its own. */
static inline struct vec limit_frame_to_world(const struct limit_tables *tables,
                                              const struct limit_node *node, struct vec v)
{
    return node->kind == LIMIT_CORNER ? limit_turn_to_world(tables, node, v) : v;
}

#endif
