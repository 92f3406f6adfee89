/* Polynomials of two variables on the unit square in Bernstein form, in double precision: their coefficients bound
 * their values, and the signs of the coefficients tell where a polynomial or its derivatives have one sign. A
 * polynomial of one variable is a net of degree m by 0. Pure, any thread. */
#ifndef SHEEN_FIELDS_BERNSTEIN_H
#define SHEEN_FIELDS_BERNSTEIN_H

#include <stdbool.h>
#include <stddef.h>

enum { NET_MOST_DEGREE = 32 };
#define NET_MOST_COEFFICIENTS ((NET_MOST_DEGREE + 1) * (NET_MOST_DEGREE + 1))

/* Coefficient (i, j), i = 0..m along u and j = 0..n along v, is c[i (n + 1) + j]. Nets are *scaled* while they are
 * multiplied and added: each coefficient is multiplied by binomial(m, i) binomial(n, j), so that a product is a plain
 * convolution. */
struct net {
    int m, n;
    double *c;
};

static inline size_t net_size(const struct net *net)
{
    return (size_t)(net->m + 1) * (size_t)(net->n + 1);
}

/* Memory for the coefficients of nets, taken like a stack: `used` is set back to give memory back. The caller has sized
 * it in advance: there is no check. */
struct net_room {
    double *memory;
    size_t used;
};
struct net net_take(struct net_room *room, int m, int n);

/* Between plain and scaled coefficients, in place. */
void net_scale(struct net *net);
void net_unscale(struct net *net);

/* Of scaled nets: a b, and x a + y b, of the higher degree of both along each variable. */
struct net net_product(struct net_room *room, const struct net *a, const struct net *b);
struct net net_sum(struct net_room *room, double x, const struct net *a, double y,
                   const struct net *b);
/* The scaled net of the same polynomial with degrees m and n, not below its own. */
struct net net_raised(struct net_room *room, const struct net *a, int m, int n);

/* Of plain nets from here on. The derivative by u (axis 0) or v (axis 1). The degree along it is at least 1. */
struct net net_derivative(struct net_room *room, const struct net *a, int axis);

/* 1 or -1 if all coefficients have this sign and none is 0, else 0. */
int net_sign(const struct net *a);
/* The same for the derivative along an axis, which is not made. */
int net_slope_sign(const struct net *a, int axis);

/* The two halves along an axis; `low` and `high` have the memory and degrees of `a`. */
void net_halve(const struct net *a, int axis, struct net *low, struct net *high);

double net_value(const struct net *a, double u, double v);

/* The value at t of the polynomial of one variable with the n + 1 coefficients c; NET_MOST_DEGREE at most. */
double curve_value(const double *c, int n, double t);

/* Finds the roots within (0,1) of the polynomial of one variable where its sign changes, ascending, to 2^-50: at most n. Roots nearer to each other than 2^-45 count as one, or as none if the sign is the same on both sides of them.
 * A polynomial whose coefficients are all 0 has none. Returns their number. */
int curve_roots(const double *c, int n, double roots[NET_MOST_DEGREE]);

#endif
