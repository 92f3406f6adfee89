/* A patch of a surface as a polynomial in Bernstein form, in the patch's own parameters and
 * relative to its node's origin, so that patches near a vertex keep their digits. The degree is 3
 * along u and along v. Pure, any thread. */
#ifndef SHEEN_FIELDS_BEZIER_H
#define SHEEN_FIELDS_BEZIER_H

#include "server/surface/patch.h"
#include "server/surface/vec.h"

struct bezier {
    struct vec origin; /* world */
    double p[3][4]
            [4]; /* coordinate, index along u, index along v; world axes, relative to origin */
};

void bezier_of_patch(struct bezier *bezier, const struct limit_tables *tables,
                     const struct limit_patch *patch);

/* Position and normal, not of unit length, with their derivatives by u and v: rows value, by u, by
 * v. */
struct bezier_jet {
    struct vec s[3], n[3];
};
void bezier_jet_at(const struct bezier *bezier, double u, double v, struct bezier_jet *out);

#endif
