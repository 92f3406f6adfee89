/* A patch of a surface as a polynomial in Bernstein form, in the patch's own parameters and relative to its node's
 * origin, so that patches near a vertex keep their digits. Of server/curves only bezier.c knows the degree of
 * patches. Pure, any thread. */
#ifndef SHEEN_FIELDS_BEZIER_H
#define SHEEN_FIELDS_BEZIER_H

#include "server/curves/fields/bernstein.h"
#include "server/surface/patch.h"
#include "server/surface/vec.h"

struct bezier {
    struct vec origin; /* world */
    double p[3][4]
            [4]; /* coordinate, index along u, index along v; world axes, relative to origin */
};

void bezier_of_patch(struct bezier *bezier, const struct limit_tables *tables,
                     const struct limit_patch *patch);

/* Scaled nets of position (relative to the origin) and of the normal, of any length: s_u x s_v divided by its largest
 * coefficient. */
struct bezier_nets {
    struct net s[3], n[3];
    double reach; /* no coefficient of s is larger */
};

/* Intervals that contain all coefficients of each net, plain ones: the middle, then the radius. */
struct bezier_box {
    double s[3][2], n[3][2];
};
void bezier_box_of(const struct bezier_nets *nets, struct bezier_box *box);

/* Over the whole patch, with u and v from 0 to 1. */
void bezier_make_nets(const struct bezier *bezier, struct net_room *room, struct bezier_nets *out);
/* Along a side, as polynomials of one variable: sides 0 to 3 are v = 0, u = 1, v = 1, u = 0, each run through
 * counter-clockwise. */
void bezier_side_nets(const struct bezier *bezier, struct net_room *room, int side,
                      struct bezier_nets *out);

/* Position and normal, not of unit length, with their derivatives by u and v: rows value, by u, by v. */
struct bezier_jet {
    struct vec s[3], n[3];
};
void bezier_jet_at(const struct bezier *bezier, double u, double v, struct bezier_jet *out);

#endif
