/* Bicubic patches as a file gives them: the other form of a model, beside faces of a control cage.
 * Each patch is one polynomial of degree 3 x 3 over the unit square, given by 16 control points.
 * The patches of a model are joined where their boundary curves are equal (joints.h). Pure, any
 * thread.
 *
 * Patches of other degrees or with weights would be a further kind beside this one. */
#ifndef SHEEN_CAGE_PATCH_H
#define SHEEN_CAGE_PATCH_H

#include <stdbool.h>
#include <stdint.h>

/* The basis of a patch's control points. */
enum cage_basis {
    CAGE_BEZIER,  /* Bernstein polynomials: the corner points lie on the surface */
    CAGE_BSPLINE, /* uniform B-splines, i and j from -1 to 2: server/surface/README.md, chapter 2 */
    N_CAGE_BASES,
};

struct cage_patch {
    double point[16][3]; /* point[4 j + i], i along u, j along v; file units */
    uint32_t basis;      /* enum cage_basis */
    uint32_t line;       /* in the file, from 1 */
};

/* Get the 16 points of the same polynomial in one basis: those of the patch itself, bit for bit, if
 * they are in that basis; else converted in double (server/surface/README.md, chapter 8, equation
 * 17). Evaluated from them, the surface differs by less than 1e-14 of the largest coordinate. */
void cage_patch_bezier(const struct cage_patch *patch, double out[16][3]);
void cage_patch_bspline(const struct cage_patch *patch, double out[16][3]);

#endif
