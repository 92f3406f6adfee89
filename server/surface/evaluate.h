/* Evaluates the limit surface on the processor as the tables describe it: in double precision from
 * the single-precision points, like shaders/surface.glsl. Pure, any thread. */
#ifndef SHEEN_SURFACE_EVALUATE_H
#define SHEEN_SURFACE_EVALUATE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/surface/patch.h"
#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* A point of the surface, in world units. At an extraordinary vertex all derivatives are zero: only
 * position and normal are known.
 *
 * If the vertex has no single normal (README.md 4.4), has_normal is false, and n is the limit of
 * the normal in the face's own corner, for callers that must draw something. */
struct limit_point {
    struct vec s;
    struct vec su, sv, suu, suv, svv; /* derivatives by u and v, or by a and b of the place */
    /* Unit length, by the face's winding; zero if there is none. */
    struct vec n;
    bool has_normal;
    /* Second derivatives along n: suu.n and so on, without the digits that turning suu into the
     * world would lose. */
    double luu, luv, lvv;
};

/* Evaluates a patch at its place. `tables` are those that it was found in. */
void limit_patch_evaluate(const struct limit_tables *tables, const struct limit_patch *patch,
                          struct limit_point *out);

/* Finds the patch of a place and evaluates it. False in a hole; *out is then unchanged. */
bool limit_evaluate_at(const struct limit_tables *tables, const struct limit_place *place,
                       struct limit_point *out);

/* As limit_evaluate_at(), at (u,v) of a face. */
bool limit_evaluate(const struct limit_tables *tables, uint32_t face, double u, double v,
                    struct limit_point *out);

#endif
