/* The transform of a prim, from its xformOps. Internal to the USD reader. Any thread. */
#ifndef SHEEN_CAGE_READ_USD_XFORM_H
#define SHEEN_CAGE_READ_USD_XFORM_H

#include "server/cage/read/numbers/transform.h"
#include "server/cage/read/usd/prim.h"

/* A prim's transform relative to its parent. */
struct usd_xform {
    struct transform matrix;
    bool is_identity; /* no op at all: the matrix need not be applied */
    bool resets;      /* !resetXformStack!: the transforms of parents do not count */
    /* An entry of xformOpOrder that the prim has no property for, which is passed over; of length
     * 0 if there is none. */
    struct usd_token unknown;
};

/* Multiplies the ops that xformOpOrder names, the first of them outermost (UsdGeomXformable). False
 * with ERROR_MODEL for an op that is not known, for a bad value, for a matrix whose last column is
 * not 0 0 0 1 up to rounding, and for the inverse of an op that has none. */
bool usd_xform(struct usd_xform *xform, const struct usd_values *values,
               const struct usd_file *file);

#endif
