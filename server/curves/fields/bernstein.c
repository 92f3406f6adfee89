#include "server/curves/fields/bernstein.h"

#include <math.h>
#include <string.h>

/* Binomial coefficients, row by row: those of n are at n (n + 1) / 2. Each is exact in double. */
enum { N_ROWS = NET_MOST_DEGREE + 1, N_BINOMIALS = N_ROWS * (N_ROWS + 1) / 2 };

static const double *binomials(int n)
{
    static _Thread_local double table[N_BINOMIALS];
    if (table[0] == 0) {
        for (int r = 0; r < N_ROWS; r++) {
            double *row = table + r * (r + 1) / 2, *above = row - r;
            row[0] = row[r] = 1;
            for (int k = 1; k < r; k++)
                row[k] = above[k - 1] + above[k];
        }
    }
    return table + n * (n + 1) / 2;
}

struct net net_take(struct net_room *room, int m, int n)
{
    struct net net = {m, n, room->memory + room->used};
    room->used += net_size(&net);
    return net;
}

void net_scale(struct net *net)
{
    const double *bm = binomials(net->m), *bn = binomials(net->n);
    double *c = net->c;
    for (int i = 0; i <= net->m; i++)
        for (int j = 0; j <= net->n; j++)
            *c++ *= bm[i] * bn[j];
}

void net_unscale(struct net *net)
{
    const double *bm = binomials(net->m), *bn = binomials(net->n);
    double *c = net->c;
    for (int i = 0; i <= net->m; i++)
        for (int j = 0; j <= net->n; j++)
            *c++ /= bm[i] * bn[j];
}

struct net net_product(struct net_room *room, const struct net *a, const struct net *b)
{
    struct net out = net_take(room, a->m + b->m, a->n + b->n);
    memset(out.c, 0, net_size(&out) * sizeof *out.c);
    int width = b->n + 1;
    for (int i = 0; i <= a->m; i++) {
        for (int j = 0; j <= a->n; j++) {
            double x = a->c[i * (a->n + 1) + j];
            for (int k = 0; k <= b->m; k++) {
                const double *restrict from = b->c + k * width;
                double *restrict to = out.c + (i + k) * (out.n + 1) + j;
                for (int l = 0; l < width; l++)
                    to[l] += x * from[l];
            }
        }
    }
    return out;
}

struct net net_raised(struct net_room *room, const struct net *a, int m, int n)
{
    if (a->m == m && a->n == n)
        return *a;
    struct net along = net_take(room, m - a->m, 0), across = net_take(room, 0, n - a->n);
    memcpy(along.c, binomials(along.m), net_size(&along) * sizeof *along.c);
    memcpy(across.c, binomials(across.n), net_size(&across) * sizeof *across.c);
    struct net half = net_product(room, &along, a);
    return net_product(room, &across, &half);
}

struct net net_sum(struct net_room *room, double x, const struct net *a, double y,
                   const struct net *b)
{
    int m = a->m > b->m ? a->m : b->m, n = a->n > b->n ? a->n : b->n;
    struct net p = net_raised(room, a, m, n), q = net_raised(room, b, m, n);
    struct net out = net_take(room, m, n);
    size_t size = net_size(&out);
    for (size_t k = 0; k < size; k++)
        out.c[k] = x * p.c[k] + y * q.c[k];
    return out;
}

struct net net_derivative(struct net_room *room, const struct net *a, int axis)
{
    struct net out = net_take(room, a->m - (axis == 0), a->n - (axis == 1));
    int width = a->n + 1, step = axis ? 1 : width, degree = axis ? a->n : a->m;
    double *c = out.c;
    for (int i = 0; i <= out.m; i++)
        for (int j = 0; j <= out.n; j++)
            *c++ = degree * (a->c[i * width + j + step] - a->c[i * width + j]);
    return out;
}

int net_sign(const struct net *a)
{
    size_t size = net_size(a);
    bool above = a->c[0] > 0;
    for (size_t k = 0; k < size; k++)
        if (above ? !(a->c[k] > 0) : !(a->c[k] < 0))
            return 0;
    return above ? 1 : -1;
}

int net_slope_sign(const struct net *a, int axis)
{
    int width = a->n + 1, step = axis ? 1 : width, m = a->m - (axis == 0), n = a->n - (axis == 1);
    if (m < 0 || n < 0)
        return 0;
    bool above = a->c[step] > a->c[0];
    for (int i = 0; i <= m; i++) {
        for (int j = 0; j <= n; j++) {
            const double *c = a->c + i * width + j;
            if (above ? !(c[step] > c[0]) : !(c[step] < c[0]))
                return 0;
        }
    }
    return above ? 1 : -1;
}

void net_halve(const struct net *a, int axis, struct net *low, struct net *high)
{
    int degree = axis ? a->n : a->m, others = axis ? a->m : a->n, width = a->n + 1;
    int step = axis ? 1 : width, other_step = axis ? width : 1;
    for (int o = 0; o <= others; o++) {
        double row[NET_MOST_DEGREE + 1];
        for (int i = 0; i <= degree; i++)
            row[i] = a->c[o * other_step + i * step];
        for (int k = 0; k <= degree; k++) {
            low->c[o * other_step + k * step] = row[0];
            high->c[o * other_step + (degree - k) * step] = row[degree - k];
            for (int i = 0; i < degree - k; i++)
                row[i] = 0.5 * (row[i] + row[i + 1]);
        }
    }
}

double curve_value(const double *c, int n, double t)
{
    double row[NET_MOST_DEGREE + 1];
    memcpy(row, c, (size_t)(n + 1) * sizeof *row);
    for (int k = n; k > 0; k--)
        for (int i = 0; i < k; i++)
            row[i] += t * (row[i + 1] - row[i]);
    return row[0];
}

double net_value(const struct net *a, double u, double v)
{
    double column[NET_MOST_DEGREE + 1] = {0};
    for (int i = 0; i <= a->m; i++)
        column[i] = curve_value(a->c + i * (a->n + 1), a->n, v);
    return curve_value(column, a->m, u);
}

/* The number of sign changes of the coefficients, which is at least the number of roots and differs from it by an even
 * number (Descartes). 0 counts as positive. */
static int sign_changes(const double *c, int n)
{
    int changes = 0;
    for (int i = 1; i <= n; i++)
        changes += (c[i] < 0) != (c[i - 1] < 0);
    return changes;
}

/* The polynomial's value in linear time: by Horner's rule in t / (1 - t), or in the inverse of
 * that where it is above 1. `scaled` has the scaled coefficients. */
static double horner(const double *scaled, int n, double t)
{
    bool is_low = t <= 0.5;
    double x = is_low ? t / (1 - t) : (1 - t) / t, sum = scaled[is_low ? n : 0];
    for (int k = 1; k <= n; k++)
        sum = sum * x + scaled[is_low ? n - k : k];
    double power = is_low ? 1 - t : t, scale = 1;
    for (int k = n; k > 0; k >>= 1, power *= power)
        scale *= k & 1 ? power : 1;
    return sum * scale;
}

/* The only root between a and b, where the polynomial has different signs: bisection, and regula falsi with the Illinois
 * rule where that is faster. */
static double only_root(const double *plain, int n, double a, double b)
{
    double c[NET_MOST_DEGREE + 1] = {0};
    const double *binomial = binomials(n);
    for (int k = 0; k <= n; k++)
        c[k] = plain[k] * binomial[k];
    double fa = horner(c, n, a), fb = horner(c, n, b);
    for (int i = 0; i < 200 && b - a > 0x1p-50; i++) {
        double t = a - fa * ((b - a) / (fb - fa)), middle = 0.5 * (a + b);
        if (!(t > a && t < b) || i % 8 == 7)
            t = middle;
        if (!(t > a && t < b))
            break;
        double f = horner(c, n, t);
        if (f == 0)
            return t;
        if ((f < 0) == (fa < 0)) {
            a = t;
            fa = f;
            fb *= 0.5;
        } else {
            b = t;
            fb = f;
            fa *= 0.5;
        }
    }
    return 0.5 * (a + b);
}

/* Appends the roots between a and b, over which `part` are the coefficients of c. */
static int roots_between(const double *c, int n, const double *part, double a, double b,
                         double *roots)
{
    int changes = sign_changes(part, n);
    if (changes == 0)
        return 0;
    bool ends_differ = (part[0] < 0) != (part[n] < 0);
    if (b - a < 0x1p-45) {
        if (ends_differ)
            *roots = 0.5 * (a + b);
        return ends_differ;
    }
    if (changes == 1) {
        *roots = only_root(c, n, a, b);
        return 1;
    }
    double low[NET_MOST_DEGREE + 1], high[NET_MOST_DEGREE + 1], middle = 0.5 * (a + b);
    struct net whole = {n, 0, NULL}, first = {n, 0, low}, second = {n, 0, high};
    double copy[NET_MOST_DEGREE + 1];
    memcpy(copy, part, (size_t)(n + 1) * sizeof *copy);
    whole.c = copy;
    net_halve(&whole, 0, &first, &second);
    int n_low = roots_between(c, n, low, a, middle, roots);
    return n_low + roots_between(c, n, high, middle, b, roots + n_low);
}

int curve_roots(const double *c, int n, double roots[NET_MOST_DEGREE])
{
    return roots_between(c, n, c, 0, 1, roots);
}
