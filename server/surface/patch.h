/* Patches: a patch is the smallest part of a surface that is one polynomial. It is found by a place
 * on the surface, or by its number in a node. Users find a patch, evaluate it (evaluate.h) and
 * bound it. Only this interface and evaluate.c know how many kinds of node there are and how many
 * corners a node's domain has. The degree of the patches (3) is also known to server/curves/fields,
 * to server/curves/compare and to devices that evaluate patches themselves (limit_patch_points()).
 *
 * A patch points into its tables, or holds points that were made for it; a copy of a patch still
 * points to those of the original. Any thread; cannot fail. */
#ifndef SHEEN_SURFACE_PATCH_H
#define SHEEN_SURFACE_PATCH_H

#include <stdbool.h>
#include <stdint.h>

#include "server/surface/bicubic.h"
#include "server/surface/source.h"
#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* A place on a node and its descendants: (a,b) in [0,1], seen from one of the node's corners, which
 * is at (0,0); the next corner is at (1,0). From corner 0 of a face's root, (a,b) is the face's
 * (u,v). Near another corner, doubles distinguish places that (u,v) could not. */
struct limit_place {
    uint32_t node; /* the root of face f is node f */
    unsigned corner;
    double a, b;
};

/* One patch and a place on it. */
struct limit_patch {
    const struct limit_node *node;
    struct bicubic_points points; /* all kinds of node have bicubic patches */
    double s, t;                  /* the place in the patch's own parameters, in [0,1] */
    int level_x, level_y; /* s and t change 2^level times as fast as the node's local x and y */
    /* Number of corners by which local x, y are turned from the place's a, b. */
    unsigned turn;
    int depth; /* the node's side is 2^-depth of that of the place's node */
    /* Beyond the last level of a CORNER: the patch is the extraordinary vertex itself. */
    bool is_vertex;
    int level;                /* as in limit_patch_of_level() */
    const float (*texels)[4]; /* the points of the whole level */
    /* The same in double precision (source.h); NULL if the tables are stored. */
    const struct vec *exact;
    struct limit_level made; /* tables on demand: the points */
};

/* Finds the patch at a place. False in a hole. */
bool limit_patch_find(const struct limit_tables *tables, const struct limit_place *place,
                      struct limit_patch *patch);

/* As limit_patch_find(), for a patch that an earlier call has found in these tables, or that is
 * zeroed: if the place is in the same level of the same node, its points are not made again. */
bool limit_patch_find_again(const struct limit_tables *tables, const struct limit_place *place,
                            struct limit_patch *patch);

/* Returns the number of the level of a node that contains local (x,y), as in
 * limit_patch_of_level(). Inside the last level of a CORNER it returns the number of levels + 1,
 * which stands for the vertex. */
int limit_level_at(const struct limit_node *node, double x, double y);

/* Gets the patch of level n (from 1) of a CORNER or STRIP that contains local (x,y), or that of a
 * REGULAR node, with n = 0. The last patch of a STRIP has number `levels` + 1. On the seam of two
 * levels either is allowed. */
void limit_patch_of_level(struct limit_patch *patch, const struct limit_tables *tables,
                          const struct limit_node *node, int n, double x, double y);

/* Gets the patch of the same level as `kept` that contains local (x,y), without making points
 * again: it points to those of `kept`, which came from limit_patch_of_level(). */
void limit_patch_in_level(struct limit_patch *patch, const struct limit_patch *kept, double x,
                          double y);

/* Gets the 16 control points of a patch, in double precision from tables on demand and rounded to
 * single precision from stored ones. The patch is a uniform bicubic B-spline: grid[4 (j + 1) + (i +
 * 1)], i along s and j along t, both from -1 to 2, in the node's frame and in the model's units.
 * Returns the power of two by which the tables divide them. For devices that evaluate patches
 * themselves. */
double limit_patch_points(const struct limit_patch *patch, struct vec grid[16]);

/* The square [s, s + size] x [t, t + size] in a patch's parameters. */
struct limit_square {
    double s, t, size;
};

/* Bounds how far a part of the patch extends from `centre` (world) and how much it bends (bound.h,
 * weighed). If `unseen` is not NULL, it is the unit vector along which a camera looks. The bend is
 * then bounded only across that vector, because the camera sees no bend along it. */
struct limit_bound limit_patch_bound(const struct limit_tables *tables,
                                     const struct limit_patch *patch, struct limit_square part,
                                     const struct vec *unseen, double centre[3]);

/* Turns a vector from the frame of a CORNER node into world coordinates. */
struct vec limit_turn_to_world(const struct limit_tables *tables, const struct limit_node *node,
                               struct vec v);

/* Turns a vector from a node's frame into world coordinates; only CORNERs have a frame of their
 * own. */
static inline struct vec limit_frame_to_world(const struct limit_tables *tables,
                                              const struct limit_node *node, struct vec v)
{
    return node->kind == LIMIT_CORNER ? limit_turn_to_world(tables, node, v) : v;
}

#endif
