/* Cubic pieces through points with tangents (client/cli/lines/cubics.h): against the curves that the points are of. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "client/cli/lines/cubics.h"

enum { MOST = 400 };

static void place_on(const struct cubic *cubic, double t, double at[2], double along[2])
{
    double r = 1 - t;
    for (int i = 0; i < 2; i++) {
        double p[4];
        for (int k = 0; k < 4; k++)
            p[k] = cubic->control[k][i];
        at[i] = r * r * r * p[0] + 3 * r * r * t * p[1] + 3 * r * t * t * p[2] + t * t * t * p[3];
        along[i] = r * r * (p[1] - p[0]) + 2 * r * t * (p[2] - p[1]) + t * t * (p[3] - p[2]);
    }
}

/* Points of a circle, from angle 0 on, with tangents of length 1. */
static void circle(struct plane_point *points, size_t n, double radius, double turn)
{
    for (size_t k = 0; k < n; k++) {
        double a = turn * (double)k / (double)(n - 1);
        points[k] = (struct plane_point){{radius * cos(a), radius * sin(a)}, {-sin(a), cos(a)}};
    }
}

/* The pieces follow one another, and where they meet they have the tangent of the point. */
static void check_joints(const struct plane_point *points, size_t n, const struct cubic *cubics,
                         size_t n_cubics)
{
    for (int i = 0; i < 2; i++) {
        assert_true(cubics[0].control[0][i] == points[0].at[i]);
        assert_true(cubics[n_cubics - 1].control[3][i] == points[n - 1].at[i]);
    }
    for (size_t k = 1; k < n_cubics; k++) {
        double before[2], after[2], end[2], start[2];
        place_on(&cubics[k - 1], 1, end, before);
        place_on(&cubics[k], 0, start, after);
        assert_true(end[0] == start[0] && end[1] == start[1]);
        double sine = (before[0] * after[1] - before[1] * after[0]) /
                      (hypot(before[0], before[1]) * hypot(after[0], after[1]));
        assert_true(fabs(sine) < 1e-12);
        assert_true(before[0] * after[0] + before[1] * after[1] > 0);
    }
}

static void a_circle_takes_few_pieces(void **state)
{
    (void)state;
    static struct plane_point points[MOST];
    static struct cubic cubics[MOST];
    const double radius = 100, tolerance = 0.05;
    circle(points, MOST, radius, 6);
    size_t n = cubics_fit(points, MOST, tolerance, cubics);
    /* An arc of angle a is off by about radius a^6 / 18,000 with the best handles; ours are a third of its length. */
    assert_true(n >= 4 && n <= 12);
    check_joints(points, MOST, cubics, n);
    for (size_t k = 0; k < n; k++) {
        for (int i = 0; i <= 20; i++) {
            double at[2], along[2];
            place_on(&cubics[k], i / 20., at, along);
            assert_true(fabs(hypot(at[0], at[1]) - radius) < 1.05 * tolerance);
        }
    }
    assert_true(cubics_fit(points, MOST, 1e-4, cubics) > n);
}

static void a_corner_ends_a_piece(void **state)
{
    (void)state;
    /* Along x, then, from point 3 on, along y: the tangent turns between neighbours. */
    struct plane_point points[7];
    struct cubic cubics[7];
    for (int k = 0; k < 7; k++)
        points[k] =
            k < 4 ? (struct plane_point){{k, 0}, {1, 0}} : (struct plane_point){{3, k - 3}, {0, 1}};
    size_t n = cubics_fit(points, 7, 1e-3, cubics);
    assert_true(n == 3);
    check_joints(points, 7, cubics, n);
    assert_true(cubics[0].control[3][0] == 3 && cubics[0].control[3][1] == 0);
    assert_true(cubics[2].control[0][0] == 3 && cubics[2].control[0][1] == 1);
}

/* Without tangents handles lie on the chords, so that no piece leaves the polyline. */
static void points_without_tangents_are_joined_by_chords(void **state)
{
    (void)state;
    struct plane_point points[3] = {{{0, 0}, {0, 0}}, {{2, 1}, {0, 0}}, {{4, 0}, {0, 0}}};
    struct cubic cubics[3];
    size_t n = cubics_fit(points, 3, 1e-3, cubics);
    assert_true(n == 2);
    for (int i = 0; i <= 10; i++) {
        double at[2], along[2];
        place_on(&cubics[0], i / 10., at, along);
        assert_true(fabs(at[0] - 2 * at[1]) < 1e-12);
    }
}

static void two_points_are_one_piece(void **state)
{
    (void)state;
    struct plane_point points[2] = {{{0, 0}, {1, 0}}, {{1, 1}, {0, 1}}};
    struct cubic cubics[1];
    assert_int_equal(cubics_fit(points, 2, 1e-9, cubics), 1);
    assert_true(cubics[0].control[1][1] == 0 && cubics[0].control[1][0] > 0);
    assert_true(cubics[0].control[2][0] == 1 && cubics[0].control[2][1] < 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_circle_takes_few_pieces),
        cmocka_unit_test(a_corner_ends_a_piece),
        cmocka_unit_test(points_without_tangents_are_joined_by_chords),
        cmocka_unit_test(two_points_are_one_piece),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
