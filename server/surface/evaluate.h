/* The limit surface evaluated on the processor as the tables describe it, in double from the single
 * precision points: what shaders/surface.glsl does. Pure; any thread. */
#ifndef SHEEN_SURFACE_EVALUATE_H
#define SHEEN_SURFACE_EVALUATE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/surface/patch.h"
#include "server/surface/tables.h"
#include "server/surface/vec.h"

/* In the world. At an extraordinary vertex itself all derivatives are zero: only the normal is
 * known.
 *
 * Where the vertex has no single normal (README.md 4.4) has_normal is false, and n is the normal
 * that the face's own corner tends to there: for who must draw something. */
struct limit_point {
    struct vec s;
    struct vec su, sv, suu, suv, svv; /* by u and v, or by the place's a and b */
    struct vec n;                     /* unit, along the face winding; zero where there is none */
    bool has_normal;
    double luu, luv, lvv; /* second derivatives along n: suu.n and so on, which a rotation of suu
                             into the world would cost digits */
};

/* A patch at its place; `tables` are those it was found in. */
void limit_patch_evaluate(const struct limit_tables *tables, const struct limit_patch *patch,
                          struct limit_point *out);

/* Finds the patch of a place and evaluates it. False in a hole, and *out is left as it is. */
bool limit_evaluate_at(const struct limit_tables *tables, const struct limit_place *place,
                       struct limit_point *out);

/* The same at (u,v) of a face. */
bool limit_evaluate(const struct limit_tables *tables, uint32_t face, double u, double v,
                    struct limit_point *out);

#endif
