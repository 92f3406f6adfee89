/* Three kinds of numbers by which one formula is computed: a value with its derivatives, a range
 * with ranges of its derivatives, and a bound. A number is an array of doubles in memory that the
 * caller provides (struct number_room). Pure, any thread, cannot fail. */
#ifndef SHEEN_FIELDS_NUMBERS_H
#define SHEEN_FIELDS_NUMBERS_H

#include <stddef.h>

/* Memory for numbers, taken one after the other. The caller makes it large enough for the formula;
 * nothing checks this. */
struct number_room {
    double *memory;
    size_t used;
};

struct numbers {
    const double *(*product)(struct number_room *room, const double *a, const double *b);
    /* x a + y b */
    const double *(*sum)(struct number_room *room, double x, const double *a, double y,
                         const double *b);
    /* e[0] a[0] + e[1] a[1] + e[2] a[2] */
    const double *(*along)(struct number_room *room, const double e[3], const double *const a[3]);
    /* a + value */
    const double *(*shifted)(struct number_room *room, const double *a, double value);
    const double *(*constant)(struct number_room *room, double value);
    const double *(*root)(struct number_room *room, const double *a); /* the square root */
};

/* The value, and the derivatives by u and v. */
extern const struct numbers NUMBERS_JET;

/* An upper bound of the magnitude. */
extern const struct numbers NUMBERS_BOUND;

/* A function of x and y from -1 to 1, as a Taylor polynomial about (0,0) and bounds of the rest: a
 * Taylor model (Makino and Berz 1996) with bounds of the rest's derivatives too, because
 * derivatives decide whether a line is a graph. The square root of a number that may be 0 or
 * negative has an infinite rest. */
extern const struct numbers NUMBERS_RANGE;

enum { RANGE_ORDER = 3, RANGE_TERMS = (RANGE_ORDER + 1) * (RANGE_ORDER + 2) / 2 };
/* The places in a range: of the coefficients in the order 1, x, y, xx, xy, yy, ...; of the sums of
 * their magnitudes, degree by degree, and of those of their derivatives by x and by y; of the
 * bounds of the rest and of its derivatives by x and y; and of how far the function differs from
 * its value at (0,0) at most. */
enum {
    RANGE_SUM = RANGE_TERMS,
    RANGE_SUM_X = RANGE_SUM + RANGE_ORDER + 1,
    RANGE_SUM_Y = RANGE_SUM_X + RANGE_ORDER + 1,
    RANGE_REST = RANGE_SUM_Y + RANGE_ORDER + 1,
    RANGE_OFF = RANGE_REST + 3,
    RANGE_SIZE
};

/* The place of the coefficient of x^i y^j. */
static inline int range_at(int i, int j)
{
    return (i + j) * (i + j + 1) / 2 + j;
}

/* Derives what follows from the coefficients and the bounds of the rest. */
void range_complete(double range[RANGE_SIZE]);

/* The range of a / b; its rest is infinite where b may be 0. */
void range_quotient(const double a[RANGE_SIZE], const double b[RANGE_SIZE], double out[RANGE_SIZE]);

/* out = x a + y b + z c */
void range_combine(const double factor[3], const double *const a[3], double out[RANGE_SIZE]);

/* 1 or -1 if all values of a range have this sign, else 0. */
int range_sign(const double range[RANGE_SIZE]);

/* 1 or -1 if the derivative by x (axis 0) or y (axis 1) has this sign everywhere and its magnitude
 * exceeds `noise`, else 0. */
int range_slope_sign(const double range[RANGE_SIZE], int axis, double noise);

#endif
