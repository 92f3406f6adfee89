#include "server/curves/fields/numbers.h"

#include <math.h>
#include <string.h>

static double *take(struct number_room *room, size_t n)
{
    double *out = room->memory + room->used;
    room->used += n;
    return out;
}

/* --- value and derivatives */

static const double *jet_product(struct number_room *room, const double *a, const double *b)
{
    double *out = take(room, 3);
    out[0] = a[0] * b[0];
    out[1] = a[1] * b[0] + a[0] * b[1];
    out[2] = a[2] * b[0] + a[0] * b[2];
    return out;
}

static const double *jet_sum(struct number_room *room, double x, const double *a, double y,
                             const double *b)
{
    double *out = take(room, 3);
    for (int k = 0; k < 3; k++)
        out[k] = x * a[k] + y * b[k];
    return out;
}

static const double *jet_along(struct number_room *room, const double e[3],
                               const double *const a[3])
{
    double *out = take(room, 3);
    for (int k = 0; k < 3; k++)
        out[k] = e[0] * a[0][k] + e[1] * a[1][k] + e[2] * a[2][k];
    return out;
}

static const double *jet_shifted(struct number_room *room, const double *a, double value)
{
    double *out = take(room, 3);
    out[0] = a[0] + value;
    out[1] = a[1];
    out[2] = a[2];
    return out;
}

static const double *jet_constant(struct number_room *room, double value)
{
    double *out = take(room, 3);
    out[0] = value;
    out[1] = out[2] = 0;
    return out;
}

static const double *jet_root(struct number_room *room, const double *a)
{
    double *out = take(room, 3);
    out[0] = sqrt(a[0]);
    for (int k = 1; k < 3; k++)
        out[k] = out[0] > 0 ? a[k] / (2 * out[0]) : 0;
    return out;
}

const struct numbers NUMBERS_JET = {jet_product, jet_sum,      jet_along,
                                    jet_shifted, jet_constant, jet_root};

/* --- ranges */

/* The coefficients of degree d begin at FIRST(d), d + 1 of them. */
#define FIRST(d) ((d) * ((d) + 1) / 2)

/* The loops below are short, and their bodies are shorter than the work of counting. */
#define UNROLLED _Pragma("GCC unroll 8")

void range_complete(double a[RANGE_SIZE])
{
    double off = a[RANGE_REST];
    UNROLLED
    for (int d = 0; d <= RANGE_ORDER; d++) {
        double sum = 0, by_x = 0, by_y = 0;
        UNROLLED
        for (int j = 0; j <= d; j++) {
            double size = fabs(a[FIRST(d) + j]);
            sum += size;
            by_x += (double)(d - j) * size;
            by_y += (double)j * size;
        }
        a[RANGE_SUM + d] = sum;
        a[RANGE_SUM_X + d] = by_x;
        a[RANGE_SUM_Y + d] = by_y;
        off += d ? sum : 0;
    }
    a[RANGE_OFF] = off;
}

/* Bounds are rounded. */
static const double WIDER = 1 + 1e-9;

int range_sign(const double a[RANGE_SIZE])
{
    return !(fabs(a[0]) > WIDER * a[RANGE_OFF]) ? 0 : a[0] > 0 ? 1 : -1;
}

int range_slope_sign(const double a[RANGE_SIZE], int axis, double noise)
{
    const double *sums = a + (axis ? RANGE_SUM_Y : RANGE_SUM_X);
    double slope = a[1 + axis], off = a[RANGE_REST + 1 + axis];
    for (int d = 2; d <= RANGE_ORDER; d++)
        off += sums[d];
    return !(fabs(slope) > WIDER * off + noise) ? 0 : slope > 0 ? 1 : -1;
}

/* Bounds of a function and of its derivatives by x and y. */
static void bounds_of(const double a[RANGE_SIZE], double bounds[3])
{
    for (int k = 0; k < 3; k++) {
        const double *sums = a + RANGE_SUM + k * (RANGE_ORDER + 1);
        bounds[k] = a[RANGE_REST + k];
        for (int d = 0; d <= RANGE_ORDER; d++)
            bounds[k] += sums[d];
    }
}

/* Adds to `out`, the coefficients of degree d + e, the products of those of degree d of a and of degree e of b. */
static inline void add_products(const double *a, int d, const double *b, int e, double *out)
{
    a += FIRST(d);
    b += FIRST(e);
    for (int i = 0; i <= d; i++)
        for (int k = 0; k <= e; k++)
            out[i + k] += a[i] * b[k];
}

/* Adds bounds of what a product of two polynomials has beyond RANGE_ORDER, and of its derivatives. */
static inline void add_higher(const double *a, const double *b, double rest[3])
{
    UNROLLED
    for (int d = 1; d <= RANGE_ORDER; d++) {
        UNROLLED
        for (int e = RANGE_ORDER + 1 - d; e <= RANGE_ORDER; e++) {
            rest[0] += a[RANGE_SUM + d] * b[RANGE_SUM + e];
            rest[1] +=
                a[RANGE_SUM_X + d] * b[RANGE_SUM + e] + a[RANGE_SUM + d] * b[RANGE_SUM_X + e];
            rest[2] +=
                a[RANGE_SUM_Y + d] * b[RANGE_SUM + e] + a[RANGE_SUM + d] * b[RANGE_SUM_Y + e];
        }
    }
}

/* Adds bounds of a product of two functions with the bounds a and b, and of its derivatives. */
static void add_bounds(const double a[3], const double b[3], double rest[3])
{
    rest[0] += a[0] * b[0];
    rest[1] += a[1] * b[0] + a[0] * b[1];
    rest[2] += a[2] * b[0] + a[0] * b[2];
}

static const double *range_product(struct number_room *room, const double *a, const double *b)
{
    double *out = take(room, RANGE_SIZE), *rest = out + RANGE_REST, of_b[3], poly[3];
    memset(out, 0, RANGE_SIZE * sizeof *out);
    UNROLLED
    for (int d = 0; d <= RANGE_ORDER; d++)
        UNROLLED
    for (int e = 0; e <= RANGE_ORDER - d; e++)
        add_products(a, d, b, e, out + FIRST(d + e));
    /* (p + r) (q + s) - p q = r (q + s) + p s, with the rests r and s. */
    add_higher(a, b, rest);
    bounds_of(b, of_b);
    bounds_of(a, poly);
    for (int k = 0; k < 3; k++)
        poly[k] -= a[RANGE_REST + k];
    add_bounds(a + RANGE_REST, of_b, rest);
    add_bounds(poly, b + RANGE_REST, rest);
    range_complete(out);
    return out;
}

static const double *range_sum(struct number_room *room, double x, const double *a, double y,
                               const double *b)
{
    double *out = take(room, RANGE_SIZE), p = fabs(x), q = fabs(y);
    for (int k = 0; k < RANGE_TERMS; k++)
        out[k] = x * a[k] + y * b[k];
    for (int k = RANGE_REST; k < RANGE_REST + 3; k++)
        out[k] = p * a[k] + q * b[k];
    range_complete(out);
    return out;
}

void range_combine(const double factor[3], const double *const a[3], double out[RANGE_SIZE])
{
    for (int k = 0; k < RANGE_TERMS; k++)
        out[k] = factor[0] * a[0][k] + factor[1] * a[1][k] + factor[2] * a[2][k];
    for (int k = RANGE_REST; k < RANGE_REST + 3; k++)
        out[k] = fabs(factor[0]) * a[0][k] + fabs(factor[1]) * a[1][k] + fabs(factor[2]) * a[2][k];
    range_complete(out);
}

static const double *range_along(struct number_room *room, const double e[3],
                                 const double *const a[3])
{
    double *out = take(room, RANGE_SIZE);
    range_combine(e, a, out);
    return out;
}

static const double *range_shifted(struct number_room *room, const double *a, double value)
{
    double *out = take(room, RANGE_SIZE);
    memcpy(out, a, RANGE_SIZE * sizeof *out);
    out[0] += value;
    out[RANGE_SUM] = fabs(out[0]);
    return out;
}

static const double *range_constant(struct number_room *room, double value)
{
    double *out = take(room, RANGE_SIZE);
    memset(out, 0, RANGE_SIZE * sizeof *out);
    out[0] = value;
    range_complete(out);
    return out;
}

static void set_unknown(double out[RANGE_SIZE])
{
    memset(out, 0, RANGE_SIZE * sizeof *out);
    for (int k = RANGE_REST; k < RANGE_SIZE; k++)
        out[k] = INFINITY;
}

/* The polynomial q by degrees: b_0 q_d = a_d - sum q_e b_(d-e). What a - q b leaves, divided by b, is the rest. */
void range_quotient(const double a[RANGE_SIZE], const double b[RANGE_SIZE], double q[RANGE_SIZE])
{
    double least = fabs(b[0]) - b[RANGE_OFF];
    if (!(least > 0)) {
        set_unknown(q);
        return;
    }
    memset(q, 0, RANGE_SIZE * sizeof *q);
    for (int d = 0; d <= RANGE_ORDER; d++) {
        double sum[RANGE_ORDER + 1] = {0};
        for (int e = 0; e < d; e++)
            add_products(q, e, b, d - e, sum);
        for (int j = 0; j <= d; j++)
            q[FIRST(d) + j] = (a[FIRST(d) + j] - sum[j]) / b[0];
    }
    range_complete(q);
    double left[3] = {a[RANGE_REST], a[RANGE_REST + 1], a[RANGE_REST + 2]}, of_q[3], of_b[3];
    bounds_of(q, of_q);
    bounds_of(b, of_b);
    add_higher(q, b, left);
    add_bounds(of_q, b + RANGE_REST, left);
    q[RANGE_REST] = left[0] / least;
    for (int k = 1; k < 3; k++)
        q[RANGE_REST + k] = left[k] / least + left[0] * of_b[k] / (least * least);
    range_complete(q);
}

/* The polynomial q by degrees: 2 q_0 q_d = a_d - sum of q_e q_(d-e) with e from 1 to d - 1. What a - q q leaves, divided by
 * sqrt(a) + q, is the rest. */
static const double *range_root(struct number_room *room, const double *a)
{
    double *q = take(room, RANGE_SIZE), least = a[0] - a[RANGE_OFF];
    if (!(least > 1e-9 * a[0])) {
        set_unknown(q);
        return q;
    }
    memset(q, 0, RANGE_SIZE * sizeof *q);
    q[0] = sqrt(a[0]);
    for (int d = 1; d <= RANGE_ORDER; d++) {
        double sum[RANGE_ORDER + 1] = {0};
        for (int e = 1; e < d; e++)
            add_products(q, e, q, d - e, sum);
        for (int j = 0; j <= d; j++)
            q[FIRST(d) + j] = (a[FIRST(d) + j] - sum[j]) / (2 * q[0]);
    }
    range_complete(q);
    double left[3] = {a[RANGE_REST], a[RANGE_REST + 1], a[RANGE_REST + 2]}, of_q[3], of_a[3];
    double low = sqrt(least), both = low + fmax(q[0] - q[RANGE_OFF], 0);
    bounds_of(q, of_q);
    bounds_of(a, of_a);
    add_higher(q, q, left);
    q[RANGE_REST] = left[0] / both;
    for (int k = 1; k < 3; k++)
        q[RANGE_REST + k] =
            left[k] / both + left[0] * (of_a[k] / (2 * low) + of_q[k]) / (both * both);
    range_complete(q);
    return q;
}

const struct numbers NUMBERS_RANGE = {range_product, range_sum,      range_along,
                                      range_shifted, range_constant, range_root};

/* --- bounds */

static const double *bound_of(struct number_room *room, double value)
{
    double *out = take(room, 1);
    out[0] = value;
    return out;
}

static const double *bound_product(struct number_room *room, const double *a, const double *b)
{
    return bound_of(room, a[0] * b[0]);
}

static const double *bound_sum(struct number_room *room, double x, const double *a, double y,
                               const double *b)
{
    return bound_of(room, fabs(x) * a[0] + fabs(y) * b[0]);
}

static const double *bound_along(struct number_room *room, const double e[3],
                                 const double *const a[3])
{
    return bound_of(room, fabs(e[0]) * a[0][0] + fabs(e[1]) * a[1][0] + fabs(e[2]) * a[2][0]);
}

static const double *bound_shifted(struct number_room *room, const double *a, double value)
{
    return bound_of(room, a[0] + fabs(value));
}

static const double *bound_constant(struct number_room *room, double value)
{
    return bound_of(room, fabs(value));
}

static const double *bound_root(struct number_room *room, const double *a)
{
    return bound_of(room, sqrt(a[0]));
}

const struct numbers NUMBERS_BOUND = {bound_product, bound_sum,      bound_along,
                                      bound_shifted, bound_constant, bound_root};
