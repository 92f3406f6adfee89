/* Conversions of patches, against other formulas in long double, on random patches (seed 20). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/cage/build/patch_blends.h"
#include "server/cage/build/patch_forms.h"
#include "server/cage/build/piece_basis.h"
#include "server/cage/build/spline_surface.h"
#include "server/cage/patch.h"

enum { ROUNDS = 2000 };

static uint64_t state = 20;

static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-52 - 1; /* [-1, 1) */
}

/* A size from 1e-3 to 1e3, and a place up to 100 sizes from the origin. */
static void random_points(double (*p)[3], size_t n)
{
    double size = pow(10, 3 * uniform()), place[3];
    for (int k = 0; k < 3; k++)
        place[k] = 100 * size * uniform() * (uniform() > 0);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            p[i][k] = place[k] + size * uniform();
}

static double largest_of(const double (*p)[3], size_t n)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            largest = fmax(largest, fabs(p[i][k]));
    return largest;
}

/* Bernstein polynomials of degree n, by powers. */
static void bernstein(int n, long double t, long double b[4])
{
    static const int choose[4][4] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
    for (int i = 0; i <= n; i++)
        b[i] = choose[n][i] * powl(t, i) * powl(1 - t, n - i);
}

/* Cardinal cubic B-splines by the truncated powers of their definition. */
static void splines(long double t, long double b[4])
{
    static const int binomial[5] = {1, -4, 6, -4, 1};
    for (int i = 0; i < 4; i++) {
        b[i] = 0;
        for (int k = 0; k < 5; k++) {
            long double x = t - (i - 3) - k;
            b[i] += x > 0 ? binomial[k] * x * x * x / 6 : 0;
        }
    }
}

struct tensor {
    long double x[4], y[4];
    int m, n;
};

static void evaluate(const double (*p)[3], const struct tensor *at, long double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = 0;
    for (int j = 0; j <= at->n; j++)
        for (int i = 0; i <= at->m; i++)
            for (int k = 0; k < 3; k++)
                out[k] += at->x[i] * at->y[j] * (long double)p[j * (at->m + 1) + i][k];
}

static struct tensor bezier_at(int m, int n, long double u, long double v)
{
    struct tensor at = {.m = m, .n = n};
    bernstein(m, u, at.x);
    bernstein(n, v, at.y);
    return at;
}

static double farthest(const long double a[3], const long double b[3])
{
    long double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmaxl(most, fabsl(a[k] - b[k]));
    return (double)most;
}

/* The surface is the same in both bases, and points in their own basis stay as they are. */
static void test_bases(void **unused)
{
    double worst = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        struct cage_patch patch = {.basis = round & 1 ? CAGE_BSPLINE : CAGE_BEZIER};
        double bezier[16][3], bspline[16][3];
        random_points(patch.point, 16);
        cage_patch_bezier(&patch, bezier);
        cage_patch_bspline(&patch, bspline);
        assert_memory_equal(patch.basis == CAGE_BEZIER ? bezier : bspline, patch.point,
                            sizeof bezier);
        const double(*own)[3] = (const double(*)[3])patch.point;
        for (int i = 0; i < 5; i++) {
            const long double u = (long double)(uniform() + 1) / 2, v = i / 4.0L;
            struct tensor a = bezier_at(3, 3, u, v), b = {.m = 3, .n = 3};
            long double p[3], q[3];
            splines(u, b.x);
            splines(v, b.y);
            evaluate((const double(*)[3])bezier, &a, p);
            evaluate((const double(*)[3])bspline, &b, q);
            worst = fmax(worst, farthest(p, q) / largest_of(own, 16));
        }
    }
    print_message("bases: %.2g of the largest coordinate\n", worst);
    assert_true(worst < 1e-14);
}

static void test_degrees(void **unused)
{
    double worst = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        const int m = 1 + round % 3, n = 1 + round / 3 % 3;
        double given[16][3], raised[16][3];
        random_points(given, 16);
        patch_from_bezier((const double(*)[3])given, (unsigned)m, (unsigned)n, raised);
        if (m == 3 && n == 3)
            assert_memory_equal(raised, given, sizeof given);
        for (int i = 0; i < 5; i++) {
            const long double u = (long double)(uniform() + 1) / 2, v = i / 4.0L;
            struct tensor a = bezier_at(m, n, u, v), b = bezier_at(3, 3, u, v);
            long double p[3], q[3];
            evaluate((const double(*)[3])given, &a, p);
            evaluate((const double(*)[3])raised, &b, q);
            worst = fmax(worst, farthest(p, q) / largest_of((const double(*)[3])given, 16));
        }
    }
    print_message("degrees: %.2g of the largest coordinate\n", worst);
    assert_true(worst < 1e-15);
}

/* The point of a cubic Bezier curve, and its derivative. */
static void curve_at(double curve[4][3], long double t, long double p[3], long double d[3])
{
    long double b[4], c[4];
    bernstein(3, t, b);
    bernstein(2, t, c);
    for (int k = 0; k < 3; k++) {
        p[k] = d[k] = 0;
        for (int i = 0; i < 4; i++)
            p[k] += b[i] * (long double)curve[i][k];
        for (int i = 0; i < 3; i++)
            d[k] += 3 * c[i] * ((long double)curve[i + 1][k] - (long double)curve[i][k]);
    }
}

/* The point of a Bezier patch and its derivatives by u and v. */
static void patch_at(double net[16][3], long double u, long double v, long double p[3],
                     long double pu[3], long double pv[3])
{
    double column[4][3];
    long double rows[4][3], slopes[4][3];
    for (int j = 0; j < 4; j++) {
        memcpy(column, net + 4 * j, sizeof column);
        curve_at(column, u, rows[j], slopes[j]);
    }
    long double b[4], c[4];
    bernstein(3, v, b);
    bernstein(2, v, c);
    for (int k = 0; k < 3; k++) {
        p[k] = pu[k] = pv[k] = 0;
        for (int j = 0; j < 4; j++) {
            p[k] += b[j] * rows[j][k];
            pu[k] += b[j] * slopes[j][k];
        }
        for (int j = 0; j < 3; j++)
            pv[k] += 3 * c[j] * (rows[j + 1][k] - rows[j][k]);
    }
}

/* A patch by its corners, whose derivatives are those of a random Bezier patch: it is that patch. */
static void test_hermite(void **unused)
{
    double worst = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        double net[16][3], got[16][3];
        struct patch_corner corner[4];
        random_points(net, 16);
        for (int c = 0; c < 4; c++) {
            const int i = c & 1 ? 3 : 0, j = c & 2 ? 3 : 0, x = c & 1 ? -1 : 1, y = c & 2 ? -1 : 1;
            for (int k = 0; k < 3; k++) {
                const double p = net[4 * j + i][k], q = net[4 * j + i + x][k],
                             r = net[4 * (j + y) + i][k], s = net[4 * (j + y) + i + x][k];
                corner[c].p[k] = p;
                corner[c].pu[k] = 3 * x * (q - p);
                corner[c].pv[k] = 3 * y * (r - p);
                corner[c].puv[k] = 9 * x * y * ((s - q) - (r - p));
            }
        }
        patch_from_hermite(corner, got);
        for (int k = 0; k < 16; k++)
            for (int i = 0; i < 3; i++)
                worst = fmax(worst,
                             fabs(got[k][i] - net[k][i]) / largest_of((const double(*)[3])net, 16));
    }
    print_message("hermite: %.2g of the largest coordinate\n", worst);
    assert_true(worst < 1e-14);
}

/* A piece of a basis at t, by its definition. */
static long double piece_at(const double (*d)[3], int k, int kind, int n, const double *matrix,
                            long double t)
{
    const long double c[4] = {d[0][k], d[1][k], n > 1 ? d[2][k] : 0, n > 2 ? d[3][k] : 0};
    long double sum = 0;
    if (kind == 0) { /* Hermite's cubic with the slopes of chords */
        const long double from = (c[2] - c[0]) / 2, to = (c[3] - c[1]) / 2;
        return (1 + 2 * t) * (1 - t) * (1 - t) * c[1] + t * (1 - t) * (1 - t) * from +
               t * t * (3 - 2 * t) * c[2] + t * t * (t - 1) * to;
    }
    for (int i = 0; i <= n; i++) {
        long double weight = kind == 1 ? powl(t, i) : 0;
        for (int j = 0; kind == 2 && j <= n; j++)
            weight += (long double)matrix[i * (n + 1) + j] * powl(t, j);
        sum += weight * c[i];
    }
    return sum;
}

/* Rows of pieces of all three bases, all degrees and steps 1 to 5. */
static void test_pieces(void **unused)
{
    double worst = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        enum { PIECES = 3, MOST = 2 * 5 + 4 };
        const int kind = round % 3, n = kind == 0 ? 3 : 1 + round / 3 % 3;
        double control[2 * MOST][3], out[PIECES * 4][3], matrix[16];
        for (int i = 0; i < 16; i++)
            matrix[i] = 3 * uniform();
        const size_t step = 1 + (size_t)round / 9 % 5;
        const struct piece_basis basis = kind == 0 ? piece_basis_cardinal()
                                         : kind == 1
                                             ? piece_basis_taylor((unsigned)n)
                                             : piece_basis_matrix((unsigned)n, step, matrix);
        random_points(control, 2 * MOST);
        assert_true(piece_basis_points(&basis, PIECES) ==
                    (PIECES - 1) * basis.step + (size_t)n + 1);
        piece_basis_row(&basis, PIECES, (const double(*)[3])control, 2, out, 1);
        const double size = largest_of((const double(*)[3])control, 2 * MOST);
        for (size_t piece = 0; piece < PIECES; piece++)
            for (int place = 0; place <= 4; place++) {
                long double b[4];
                double window[4][3];
                for (size_t i = 0; i <= (size_t)n; i++)
                    memcpy(window[i], control[2 * (piece * basis.step + i)], sizeof window[i]);
                bernstein(n, place / 4.0L, b);
                for (int k = 0; k < 3; k++) {
                    long double got = 0;
                    for (int i = 0; i <= n; i++)
                        got += b[i] * (long double)out[(int)piece * (n + 1) + i][k];
                    const long double expected =
                        piece_at((const double(*)[3])window, k, kind, n, matrix, place / 4.0L);
                    worst = fmax(worst, (double)fabsl(got - expected) / size);
                }
            }
    }
    print_message("pieces: %.2g of the largest coordinate\n", worst);
    assert_true(worst < 2e-14); /* the weights of a random matrix add up to 48 */
}

/* Four random sides that meet at the corners. */
static void random_sides(double side[N_PATCH_SIDES][4][3])
{
    random_points(side[0], 4 * N_PATCH_SIDES);
    memcpy(side[SIDE_U0][0], side[SIDE_V0][0], sizeof side[0][0]);
    memcpy(side[SIDE_U1][0], side[SIDE_V0][3], sizeof side[0][0]);
    memcpy(side[SIDE_U0][3], side[SIDE_V1][0], sizeof side[0][0]);
    memcpy(side[SIDE_U1][3], side[SIDE_V1][3], sizeof side[0][0]);
}

/* The parameters of the place t on a side. */
static void side_place(int s, long double t, long double *u, long double *v)
{
    *u = s == SIDE_U0 ? 0 : s == SIDE_U1 ? 1 : t;
    *v = s == SIDE_V0 ? 0 : s == SIDE_V1 ? 1 : t;
}

/* The sides are interpolated, and in the middle the surface is what Coons' formula says. */
static void test_coons(void **unused)
{
    double on_sides = 0, inside = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        double side[N_PATCH_SIDES][4][3], net[16][3];
        long double p[3], q[3], d[3], e[3], u, v;
        random_sides(side);
        patch_from_coons(side, net);
        const double size = largest_of((const double(*)[3])side[0], 16);
        for (int s = 0; s < N_PATCH_SIDES; s++) {
            const long double t = (long double)(uniform() + 1) / 2;
            curve_at(side[s], t, p, d);
            side_place(s, t, &u, &v);
            patch_at(net, u, v, q, d, e);
            on_sides = fmax(on_sides, farthest(p, q) / size);
        }
        u = (long double)(uniform() + 1) / 2;
        v = (long double)(uniform() + 1) / 2;
        long double c0[3], c1[3], d0[3], d1[3], expected[3];
        curve_at(side[SIDE_V0], u, c0, d);
        curve_at(side[SIDE_V1], u, c1, d);
        curve_at(side[SIDE_U0], v, d0, d);
        curve_at(side[SIDE_U1], v, d1, d);
        for (int k = 0; k < 3; k++)
            expected[k] = (1 - v) * c0[k] + v * c1[k] + (1 - u) * d0[k] + u * d1[k] -
                          (1 - u) * (1 - v) * (long double)side[SIDE_V0][0][k] -
                          u * (1 - v) * (long double)side[SIDE_V0][3][k] -
                          (1 - u) * v * (long double)side[SIDE_V1][0][k] -
                          u * v * (long double)side[SIDE_V1][3][k];
        patch_at(net, u, v, q, d, e);
        inside = fmax(inside, farthest(expected, q) / size);
    }
    print_message("coons: sides %.2g, inside %.2g of the largest coordinate\n", on_sides, inside);
    assert_true(on_sides < 1e-14 && inside < 1e-14);
}

/* Sides and derivatives across them are interpolated, where the derivatives agree at the corners: those of a
 * random patch, which the four sides describe completely. */
static void test_bicubic_coons(void **unused)
{
    double on_sides = 0, across_sides = 0;
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        static const int first[4] = {0, 12, 0, 3}, step[4] = {1, 1, 4, 4},
                         inwards[4] = {4, -4, 1, -1};
        double side[N_PATCH_SIDES][4][3], across[N_PATCH_SIDES][4][3], net[16][3], got[16][3];
        random_points(net, 16);
        for (int s = 0; s < N_PATCH_SIDES; s++)
            for (int i = 0; i < 4; i++)
                for (int k = 0; k < 3; k++) {
                    const int at = first[s] + i * step[s];
                    side[s][i][k] = net[at][k];
                    across[s][i][k] =
                        3 * (inwards[s] > 0 ? 1 : -1) * (net[at + inwards[s]][k] - net[at][k]);
                }
        patch_from_bicubic_coons(side, across, got);
        const double size = largest_of((const double(*)[3])net, 16);
        for (int k = 0; k < 16; k++)
            for (int i = 0; i < 3; i++) /* a bicubic patch given by its sides is itself */
                on_sides = fmax(on_sides, fabs(got[k][i] - net[k][i]) / size);
        for (int s = 0; s < N_PATCH_SIDES; s++) {
            const long double t = (long double)(uniform() + 1) / 2;
            long double p[3], q[3], d[3], by[2][3], u, v;
            curve_at(side[s], t, p, d);
            side_place(s, t, &u, &v);
            patch_at(got, u, v, q, by[0], by[1]);
            on_sides = fmax(on_sides, farthest(p, q) / size);
            curve_at(across[s], t, p, d);
            across_sides = fmax(across_sides, farthest(p, by[s == SIDE_V0 || s == SIDE_V1]) / size);
        }
    }
    print_message("bicubic coons: sides %.2g, across %.2g of the largest coordinate\n", on_sides,
                  across_sides);
    assert_true(on_sides < 1e-13 && across_sides < 1e-12);
}

/* A B-spline's basis function by Cox and de Boor's recurrence. */
static long double cox(const double *knot, int i, int p, long double t, long double last)
{
    if (p == 0)
        return t >= (long double)knot[i] &&
               (t < (long double)knot[i + 1] ||
                (t == last && (long double)knot[i + 1] == last && knot[i] < knot[i + 1]));
    long double a = (long double)knot[i + p] - (long double)knot[i],
                b = (long double)knot[i + p + 1] - (long double)knot[i + 1], sum = 0;
    if (a > 0)
        sum += (t - (long double)knot[i]) / a * cox(knot, i, p - 1, t, last);
    if (b > 0)
        sum += ((long double)knot[i + p + 1] - t) / b * cox(knot, i + 1, p - 1, t, last);
    return sum;
}

enum { MOST_POINTS = 9 };

/* Random knots: of any multiplicity, clamped or not, or uniform. */
static void random_axis(struct spline_axis *axis, double *knot)
{
    const unsigned p = 1 + (unsigned)((uniform() + 1) * 1.5);
    const size_t n = p + 1 + (size_t)((uniform() + 1) / 2 * (MOST_POINTS - p));
    const bool is_uniform = uniform() < 0;
    size_t equal = 1;
    *axis = (struct spline_axis){.degree = p, .n = n, .knot = knot};
    knot[0] = uniform();
    for (size_t i = 1; i < n + p + 1; i++) {
        bool repeats = !is_uniform && equal <= p && uniform() < -0.2;
        knot[i] = knot[i - 1] + (is_uniform ? 0.25 : repeats ? 0 : 1.01 + uniform());
        equal = knot[i] > knot[i - 1] ? 1 : equal + 1;
    }
    axis->low = knot[p];
    axis->high = knot[n];
    if (uniform() < 0 && axis->low < axis->high) { /* a part of it */
        axis->low += (axis->high - axis->low) * (uniform() + 1) / 5;
        axis->high -= (axis->high - axis->low) * (uniform() + 1) / 5;
    }
}

/* The patches of a random B-spline surface, against its basis functions. */
static void test_spline_surfaces(void **unused)
{
    double worst = 0;
    int n_uniform = 0, n_bezier = 0;
    (void)unused;
    for (int round = 0; round < 300; round++) {
        double knot[2][2 * MOST_POINTS], points[MOST_POINTS * MOST_POINTS][3];
        struct spline_axis u, v;
        struct cage_builder builder = {.name = "spline"};
        struct error error = {0};
        random_axis(&u, knot[0]);
        random_axis(&v, knot[1]);
        if (!(u.low < u.high && v.low < v.high))
            continue;
        random_points(points, u.n * v.n);
        assert_true(spline_surface_add(&builder, &u, &v, (const double(*)[3])points, 7, &error));
        size_t f = 0;
        for (size_t j = v.degree; j < v.n; j++)
            for (size_t i = u.degree; i < u.n; i++) {
                const double a = fmax(knot[0][i], u.low), b = fmin(knot[0][i + 1], u.high);
                const double c = fmax(knot[1][j], v.low), d = fmin(knot[1][j + 1], v.high);
                if (!(a < b && c < d))
                    continue;
                assert_true(f < builder.cage.n_patches);
                const struct cage_patch *patch = &builder.cage.patch[f++];
                double net[16][3];
                assert_int_equal(patch->line, 7);
                n_uniform += patch->basis == CAGE_BSPLINE;
                n_bezier += patch->basis == CAGE_BEZIER;
                if (patch->basis == CAGE_BSPLINE)
                    for (size_t k = 0; k < 16; k++)
                        assert_memory_equal(patch->point[k],
                                            points[(j - 3 + k / 4) * u.n + i - 3 + k % 4],
                                            sizeof points[0]);
                cage_patch_bezier(patch, net);
                const long double s = (long double)(uniform() + 1) / 2,
                                  t = (long double)(uniform() + 1) / 2;
                const long double x = (long double)a + s * ((long double)b - (long double)a),
                                  y = (long double)c + t * ((long double)d - (long double)c);
                long double p[3], unused_slope[2][3], expected[3] = {0};
                patch_at(net, s, t, p, unused_slope[0], unused_slope[1]);
                for (size_t m = 0; m < u.n; m++)
                    for (size_t n = 0; n < v.n; n++) {
                        long double w =
                            cox(knot[0], (int)m, (int)u.degree, x, (long double)knot[0][u.n]) *
                            cox(knot[1], (int)n, (int)v.degree, y, (long double)knot[1][v.n]);
                        for (int k = 0; k < 3; k++)
                            expected[k] += w * (long double)points[n * u.n + m][k];
                    }
                worst = fmax(worst, farthest(p, expected) /
                                        largest_of((const double(*)[3])points, u.n * v.n));
            }
        assert_int_equal(f, builder.cage.n_patches);
        cage_builder_finish(&builder);
    }
    print_message("splines: %d uniform patches, %d others: %.2g of the largest coordinate\n",
                  n_uniform, n_bezier, worst);
    assert_true(n_uniform > 50 && n_bezier > 1000);
    assert_true(worst < 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bases),           cmocka_unit_test(test_degrees),
        cmocka_unit_test(test_hermite),         cmocka_unit_test(test_pieces),
        cmocka_unit_test(test_coons),           cmocka_unit_test(test_bicubic_coons),
        cmocka_unit_test(test_spline_surfaces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
