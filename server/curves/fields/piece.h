/* A square part of a patch: position and normal as polynomials in Bernstein form, whose
 * coefficients bound their values. Pieces are quartered. The normal is computed once, from the
 * whole patch, as the polynomial s_u x s_v of degree 5. Quarters are cut from that polynomial, so
 * they keep all its digits, also where the normal nearly vanishes. Pure, any thread. */
#ifndef SHEEN_FIELDS_PIECE_H
#define SHEEN_FIELDS_PIECE_H

#include "server/curves/fields/bezier.h"
#include "server/curves/fields/numbers.h"

/* Degrees along each parameter, and numbers of coefficients. Coefficient (i, j), i along u and j
 * along v, is at i (degree + 1) + j. */
enum { POSITION_DEGREE = 3, NORMAL_DEGREE = 5 };
enum {
    POSITION_SIZE = (POSITION_DEGREE + 1) * (POSITION_DEGREE + 1),
    NORMAL_SIZE = (NORMAL_DEGREE + 1) * (NORMAL_DEGREE + 1),
};

struct piece {
    double at[2], size;         /* it covers [at, at + size] of the patch's u and of its v */
    double s[3][POSITION_SIZE]; /* relative to the patch's origin */
    double
        n[3]
         [NORMAL_SIZE]; /* divided by the largest coefficient; all 0 where the patch is a curve */
};

void piece_of_bezier(const struct bezier *bezier, struct piece *piece);

/* The quarters at the corners (0,0), (1,0), (1,1) and (0,1). */
void piece_quarter(const struct piece *piece, struct piece quarters[4]);

/* The largest magnitude of a coordinate relative to the patch's origin. */
double piece_reach(const struct piece *piece);

/* A part of a line of constant u or v. */
struct segment {
    double from[2], to[2]; /* in the patch's u and v */
    double s[3][POSITION_DEGREE + 1], n[3][NORMAL_DEGREE + 1];
};

/* Sides 0 to 3 are v = 0, u = 1, v = 1, u = 0, each run through counter-clockwise. */
void piece_side(const struct piece *piece, int side, struct segment *segment);
/* Side `side` of the whole patch, as piece_side() gives it for a piece. */
void segment_of_bezier(const struct bezier *bezier, int side, struct segment *segment);
void segment_reverse(struct segment *segment);
void segment_halve(const struct segment *segment, struct segment half[2]);

/* Position and normal as numbers of NUMBERS_RANGE. The normal is divided by its component along the
 * unit normal in the middle, because its length varies much more than its direction and would widen
 * the ranges. A segment's numbers depend on x alone; x runs along the segment. */
struct piece_range {
    double s[3][RANGE_SIZE], n[3][RANGE_SIZE];
};
void piece_find_range(const struct piece *piece, struct piece_range *range);
void segment_find_range(const struct segment *segment, struct piece_range *range);

#endif
