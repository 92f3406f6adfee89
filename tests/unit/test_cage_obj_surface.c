/* Free-form surfaces of OBJ: what is read of them, and one clear line, with the place, for what is not drawn or damaged. */
#include <math.h>
#include <stdio.h>

#include "tests/unit/cage_expect.h"

/* A grid of 4 x 4 vertices, eight lines. */
#define GRID                                                                                       \
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 1\nv 2 1 2\nv 3 1 0\n"                     \
    "v 0 2 0\nv 1 2 3\nv 2 2 1\nv 3 2 0\nv 0 3 0\nv 1 3 0\nv 2 3 0\nv 3 3 0\n"
#define POINTS "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16"
#define BEZIER "cstype bezier\ndeg 3 3\n"
#define ENDS "parm u 0 1\nparm v 0 1\nend\n"

static void expect_grid(const struct cage *cage, uint32_t basis)
{
    static const double z[16] = {0, 0, 0, 0, 0, 1, 2, 0, 0, 3, 1, 0, 0, 0, 0, 0};
    assert_int_equal(cage->n_patches, 1);
    assert_int_equal(cage->n_vertices, 0);
    assert_int_equal(cage->patch[0].basis, basis);
    for (int k = 0; k < 16; k++) {
        const double *p = cage->patch[0].point[k];
        assert_true(p[0] == k % 4 && p[1] == k / 4 && p[2] == z[k]);
    }
}

static void test_bezier(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS);
    expect_grid(&cage, CAGE_BEZIER);
    assert_int_equal(cage.patch[0].line, 19);
    assert_null(cage.warnings);
    cage_finish(&cage);
}

/* Texture and normal indices, indices that count back, a line that continues, parm in two lines; and curves beside it. */
static void test_forms_of_lines(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID "vp 0 0\ncstype bezier\ndeg 3\ncurv2 1 1\nparm u 0 1\nend\n" BEZIER
                         "surf 0 1 0 1 1/1 2//3 3/1/2 4 -12 -11 -10 -9 \\\n9 10 11 12 13 14 15 16\n"
                         "parm u 0\nparm v 0 1\nparm u 1\nend\nctech cparm 1\nstech cparma 1 1\n");
    expect_grid(&cage, CAGE_BEZIER);
    assert_null(cage.warnings);
    cage_finish(&cage);
}

/* Between uniform knots a bicubic keeps its points bit by bit. */
static void test_uniform_bspline(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID "cstype bspline\ndeg 3 3\nsurf 0 1 3 4 " POINTS "\n"
                         "parm u -3 -2 -1 0 1 2 3 4\nparm v 0 1 2 3 4 5 6 7\nend\n");
    expect_grid(&cage, CAGE_BSPLINE);
    cage_finish(&cage);
}

/* Clamped knots make the Bezier patch with the same points. */
static void test_clamped_bspline(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID "cstype bspline\ndeg 3 3\nsurf 0 2 0 1 " POINTS "\n"
                         "parm u 0 0 0 0 2 2 2 2\nparm v 0 0 0 0 1 1 1 1\nend\n");
    expect_grid(&cage, CAGE_BEZIER);
    cage_finish(&cage);
}

/* Bezier pieces in a row: two of degree 1 along u; and a part of them by the range. */
static void test_pieces_and_range(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, "v 0 0 0\nv 1 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 3 1 0\ncstype bezier\ndeg 1 1\n"
                    "surf 0.5 2 0 1 1 2 3 4 5 6\nparm u 0 1 2\nparm v 0 1\nend\n");
    assert_int_equal(cage.n_patches, 2);
    assert_true(cage.patch[0].point[0][0] == 0.5 && cage.patch[0].point[3][0] == 1);
    assert_true(cage.patch[1].point[0][0] == 1 && cage.patch[1].point[15][0] == 3);
    assert_true(cage.patch[1].point[15][1] == 1);
    cage_finish(&cage);
}

static void expect_patches(const struct cage *cage, const struct cage *expected, double within)
{
    assert_int_equal(cage->n_patches, expected->n_patches);
    for (size_t f = 0; f < cage->n_patches; f++)
        for (int k = 0; k < 16; k++)
            for (int i = 0; i < 3; i++)
                assert_true(fabs(cage->patch[f].point[k][i] - expected->patch[f].point[k][i]) <=
                            within);
}

/* Reads both texts after the grid, and expects the same patches, within so many units. */
static void expect_same(const char *text, const char *expected_text, double within)
{
    char whole[2000];
    struct cage cage, expected;
    snprintf(whole, sizeof whole, GRID "%s", text);
    read_obj(&cage, whole);
    snprintf(whole, sizeof whole, GRID "%s", expected_text);
    read_obj(&expected, whole);
    expect_patches(&cage, &expected, within);
    cage_finish(&cage);
    cage_finish(&expected);
}

/* A rational surface of equal weights is the polynomial one of the same points, bit by bit. */
static void test_equal_weights(void **state)
{
    (void)state;
    expect_same("cstype rat bezier\ndeg 3 3\nsurf 0 1 0 1 " POINTS "\n" ENDS,
                BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS, 0);
    expect_same("v 0 0 0 0.3\nv 1 0 0.5 0.3\nv 0 1 1 0.3\nv 1 1 4 0.3\ncstype rat bspline\n"
                "deg 1 1\nsurf 0 1 0 1 -4 -3 -2 -1\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n",
                "v 0 0 0 9 9 9\nv 1 0 0.5\nv 0 1 1 7\nv 1 1 4\ncstype bezier\ndeg 1 1\n"
                "surf 0 1 0 1 17 18 19 20\n" ENDS,
                0);
    /* A colour is no weight. */
    expect_same(
        "v 0 0 0 1 0 0\nv 1 0 0.5\ncstype rat bezier\ndeg 1 1\nsurf 0 1 0 1 17 18 5 6\n" ENDS,
        "v 0 0 0\nv 1 0 0.5\ncstype bezier\ndeg 1 1\nsurf 0 1 0 1 17 18 5 6\n" ENDS, 0);
}

#define BERNSTEIN_3 "1 -3 3 -1  0 3 -6 3  0 0 3 -3  0 0 0 1"
#define UNIFORM_3                                                                                  \
    "0.16666666666666667 -0.5 0.5 -0.16666666666666667  0.66666666666666667 0 -1 0.5 "             \
    "0.16666666666666667 0.5 0.5 -0.5  0 0 0 0.16666666666666667"

/* The basis matrices of Bezier and of uniform B-spline surfaces, one of each along u and v, one piece and two. */
static void test_matrices(void **state)
{
    (void)state;
    expect_same("cstype bmatrix\ndeg 3 3\nstep 3 3\nbmat u " BERNSTEIN_3 "\nbmat v \\\n" BERNSTEIN_3
                "\nsurf 0 1 0 1 " POINTS "\n" ENDS,
                BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS, 1e-15);
    expect_same("cstype bmatrix\ndeg 1 3\nstep 1 1\nbmat u 1 -1 0 1\nbmat v " UNIFORM_3
                "\nsurf 0 2.5 5 6 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\nparm u 0 1 2 3\n"
                "parm v 5 6\nend\n",
                "cstype bspline\ndeg 1 3\nsurf 0 2.5 3 4 " POINTS
                "\nparm u -1 0 1 2 3 4\nparm v 0 1 2 3 4 5 6 7\nend\n",
                1e-14);
}

/* Two cardinal pieces along u go through the inner control points, with the slopes of chords. */
static void test_cardinal(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID "v 4 0 0\nv 4 1 0\nv 4 2 3\nv 4 3 0\ncstype cardinal\ndeg 3 3\n"
                         "surf 0 2 0 1 1 2 3 4 17 5 6 7 8 18 9 10 11 12 19 13 14 15 16 20\n"
                         "parm u 0 1 2\nparm v 0 1\nend\n");
    assert_int_equal(cage.n_patches, 2);
    const double(*p)[3] = (const double(*)[3])cage.patch[0].point;
    const double(*q)[3] = (const double(*)[3])cage.patch[1].point;
    static const double first[3] = {1, 1, 1}, middle[3] = {2, 1, 2}, last[3] = {3, 2, 0};
    assert_memory_equal(p[0], first, sizeof first);
    assert_memory_equal(p[3], middle, sizeof middle);
    assert_memory_equal(q[15], last, sizeof last);
    for (int j = 0; j < 4; j++) /* the pieces meet exactly */
        assert_memory_equal(p[4 * j + 3], q[4 * j], sizeof first);
    assert_true(fabs(3 * (p[1][2] - p[0][2]) - (2 - 0) / 2.0) < 1e-14);
    assert_true(fabs(3 * (q[1][2] - q[0][2]) - (0 - 1) / 2.0) < 1e-14);
    cage_finish(&cage);
}

/* 1 + 2 u + 3 v + 4 u v, and the same as a Bezier surface. */
static void test_taylor(void **state)
{
    (void)state;
    expect_same("v 0 0 1\nv 1 0 2\nv 0 1 3\nv 0 0 4\ncstype taylor\ndeg 1 1\n"
                "surf 0.25 1 0 1 17 18 19 20\n" ENDS,
                "v 0 0 1\nv 1 0 3\nv 0 1 4\nv 1 1 10\ncstype bezier\ndeg 1 1\n"
                "surf 0.25 1 0 1 17 18 19 20\n" ENDS,
                1e-15);
}

/* --weld joins vertices of faces; there are none. */
static void test_weld(void **state)
{
    struct cage cage;
    (void)state;
    read_obj(&cage, GRID BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS "t weld 0/0/0\n");
    expect_grid(&cage, CAGE_BEZIER);
    cage_finish(&cage);
}

static const struct {
    const char *text, *words;
} DAMAGED[] = {
    {"surf 0 1 0 1 1\n", ":17: surf comes before any cstype"},
    {"cstype\n", ":17: cstype has no type"},
    {"cstype rat\n", ":17: cstype rat has no type"},
    {"v 0 0 1 0.5\ncstype rat bezier\ndeg 3 3\nsurf 0 1 0 1 1 2 17\n",
     ":20: control point 3 has the weight 0.5, and the first one 1: of rational surfaces sheen "
     "draws "
     "those whose weights are all equal"},
    {"v 0 0 1 0\ncstype rat bezier\ndeg 3 3\nsurf 0 1 0 1 1 17\n",
     ":20: control point 2 has the weight 0, which is not above 0"},
    {"v 0 0 1 -1\ncstype rat bezier\ndeg 3 3\nsurf 0 1 0 1 17\n", "the weight -1, which is not"},
    {"v 0 0 1 x\ncstype rat bezier\ndeg 3 3\nsurf 0 1 0 1 17\n", "the weight nan, which is not"},
    {"cstype rat taylor\ndeg 3 3\nsurf 0 1 0 1 1\n",
     ":19: a rational surface of cstype rat taylor (line 17): sheen draws rat with bezier, bspline "
     "and cardinal"},
    {"cstype rat bmatrix\ndeg 3 3\nsurf 0 1 0 1 1\n", "a rational surface of cstype rat bmatrix"},
    {"cstype cardinal\ndeg 3 2\nsurf 0 1 0 1 1\n" ENDS,
     ":22: a cardinal surface of degree 2 along v: the degree is 3"},
    {"cstype taylor\ndeg 3 3\nsurf 0 1 0 1 " POINTS "\nparm u 0 2\nparm v 0 1\nend\n",
     ":22: parm u of a taylor surface: sheen draws one piece from 0 to 1"},
    {"cstype taylor\ndeg 3 3\nsurf 0 1 0 1 " POINTS "\nparm u 0 1\nparm v 0 1 2\nend\n",
     ":22: parm v of a taylor surface"},
    {"cstype taylor\ndeg 3 2\nsurf 0 1 0 1 " POINTS "\n" ENDS,
     "has 16 control points, but deg and parm make 4 x 3"},
    {"bmat\n", ":17: bmat needs u or v"},
    {"bmat w 1\n", ":17: bmat needs u or v"},
    {"bmat u 1 x\n", ":17: a number of bmat is no finite number: 'x'"},
    {"step y\n", ":17: a step is no finite number: 'y'"},
    {"cstype bmatrix\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\n" ENDS,
     ":22: bmat u has 0 numbers, degree 1 needs 4"},
    {"cstype bmatrix\ndeg 1 1\nbmat u 1 -1 0 1\nbmat v 1\nstep 1 1\nsurf 0 1 0 1 1 2 3 4\n" ENDS,
     ":25: bmat v has 1 numbers, degree 1 needs 4"},
    {"cstype bmatrix\ndeg 1 1\nbmat u 1 -1 0 1\nbmat v 1 -1 0 1\nsurf 0 1 0 1 1 2 3 4\n" ENDS,
     ":24: the step along u is 0, not a whole number from 1 to 1000000"},
    {"cstype bmatrix\ndeg 1 1\nbmat u 1 -1 0 1\nbmat v 1 -1 0 1\nstep 1 1.5\nsurf 0 1 0 1 1 2 3 "
     "4\n" ENDS,
     ":25: the step along v is 1.5, not"},
    {"cstype bmatrix\ndeg 1 1\nbmat u 1 -1 0 1\nbmat v 1 -1 0 1\nstep 1e6 1\nsurf 0 9 0 1 1 2 3 4\n"
     "parm u 0 9\nparm u 10\nparm v 0 1\nend\n",
     "has 4 control points, but deg and parm make 1000002 x 2"},
    {"cstype bmatrix\ndeg 1 1\nbmat u 1e30 -1 1e30 1\nbmat v 1e30 -1 0 1\nstep 1 1\n"
     "surf 0 1 0 1 2 3 4 5\n" ENDS,
     "beyond"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nbmat u 1\n" ENDS, ":20: bmat within the surface of line 19"},
    {"cstype \1\ndeg 3 3\nsurf 0 1 0 1 1\n", ":19: a surface of cstype"},
    {"cstype bezier\nsurf 0 1 0 1 1\n", ":18: surf comes before a deg with two degrees"},
    {"cstype bezier\ndeg 3\nsurf 0 1 0 1 1\n", ":19: surf comes before a deg with two degrees"},
    {"cstype bezier\ndeg x 3\n", ":18: a degree of deg is no finite number: 'x'"},
    {"cstype bezier\ndeg 4 3\nsurf 0 1 0 1 1\n",
     ":19: a surface of degree 4 along u: sheen draws degrees 1 to 3"},
    {"cstype bspline\ndeg 3 5\nsurf 0 1 0 1 1\n", ":19: a surface of degree 5 along v"},
    {"cstype bezier\ndeg -1 3\nsurf 0 1 0 1 1\n", ":19: a surface of degree -1 along u"},
    {"cstype bezier\ndeg 2.5 3\nsurf 0 1 0 1 1\n", ":19: a surface of degree 2.5 along u"},
    {BEZIER "surf\n", ":19: surf has 0 numbers, needs its range: u from and to, v from and to"},
    {BEZIER "surf 0 1 0\n", ":19: surf has 3 numbers, needs its range"},
    {BEZIER "surf 0 1 0 x 1\n", ":19: a number of surf's range is no finite number: 'x'"},
    {BEZIER "surf 0 nan 0 1 1\n", ":19: a number of surf's range is no finite number: 'nan'"},
    {BEZIER "surf 0 1e31 0 1 1\n", ":19: a number of surf's range is 1e+31, beyond the largest"},
    {BEZIER "surf 0 1 0 1 x\n", ":19: control point 1 is not v, v/t, v//n or v/t/n: 'x'"},
    {BEZIER "surf 0 1 0 1 1 2/x\n", ":19: control point 2 is not"},
    {BEZIER "surf 0 1 0 1 1 0\n",
     ":19: control point 2 refers to vertex 0, but 16 vertices stand before it"},
    {BEZIER "surf 0 1 0 1 17\n", ":19: control point 1 refers to vertex 17"},
    {BEZIER "surf 0 1 0 1 -17\n", ":19: control point 1 refers to vertex -17"},
    {BEZIER "surf 0 1 0 1 99999999999999999999\n", ":19: control point 1 refers to vertex"},
    {BEZIER "surf 0 1 0 1 " POINTS "\ndeg -1 3\n" ENDS,
     ":20: deg within the surface of line 19, which has no end before"},
    {BEZIER "surf 0 1 0 1 " POINTS "\ncstype bspline\n" ENDS,
     ":20: cstype within the surface of line 19"},
    {BEZIER "surf 0 1 0 1 1\nsurf 0 1 0 1 1\n", ":20: the surface of line 19 has no end"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 0 1\nparm v 0 1\n",
     "the file ends in the surface of line 19"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm w 0 1\n", ":20: parm needs u or v"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm\n", ":20: parm needs u or v"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 0 x\n",
     ":20: a number of parm is no finite number: 'x'"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 0 inf\n", ":20: a number of parm is no finite number"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nend\n", ":20: parm u has 0 numbers, needs at least 2"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 0 1\nend\n", ":21: parm v has 0 numbers"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 1 0\nparm v 0 1\nend\n",
     ":22: parm u decreases from 1 to 0"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nparm u 0 0\nparm v 0 1\nend\n",
     ":22: parm u has 0 more than 1 time"},
    {BEZIER "surf 0 1 0 1 1 2 3\n" ENDS,
     ":22: the surface of line 19 has 3 control points, but deg and parm make 4 x 4"},
    {BEZIER "surf 0 1 0 1 " POINTS " 1\n" ENDS, "has 17 control points"},
    {BEZIER "surf 1 0 0 1 " POINTS "\n" ENDS, "surf's range of u goes from 1 to 0"},
    {BEZIER "surf 0 1 1 1 " POINTS "\n" ENDS, "surf's range of v goes from 1 to 1"},
    {BEZIER "surf 0 2 0 1 " POINTS "\n" ENDS,
     "surf's range of u, 0 to 2, is not within parm's, 0 to 1"},
    {BEZIER "surf 0 1 -1 1 " POINTS "\n" ENDS, "surf's range of v, -1 to 1, is not within"},
    {BEZIER "surf 1 1.0000001 0 1 " POINTS "\n" ENDS, "surf's range of u is empty"},
    {BEZIER "surf 0 1 0 1 " POINTS "\ntrim 0 1 1\n",
     ":20: a surface with a trim: sheen draws whole surfaces only"},
    {BEZIER "surf 0 1 0 1 " POINTS "\nhole 0 1 1\n", ":20: a surface with a hole"},
    {BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS "f 1 2 6 5\n",
     ":19: a surface in a file with 1 faces: sheen draws either"},
    {"f 1 2 6 5\n" BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS,
     ":20: a surface in a file with 1 faces"},
    {"cstype bspline\ndeg 3 3\nsurf 0 1 0 1 " POINTS
     "\nparm u 0 0 0 0 1 1 1\nparm v 0 0 0 0 1 1 1 1\nend\n",
     "parm u has 7 numbers, needs at least 8"},
    {"cstype bspline\ndeg 3 3\nsurf 0 1 0 1 " POINTS
     "\nparm u 0 0 0 0 0 1 1 1 1\nparm v 0 0 0 0 1 1 1 1\nend\n",
     "parm u has 0 more than 4 times"},
    {"cstype bspline\ndeg 3 3\nsurf 0 1 0 1 " POINTS
     "\nparm u 0 0 0 0 1 1 1 0\nparm v 0 0 0 0 1 1 1 1\nend\n",
     "parm u decreases from 1 to 0"},
    {"cstype bspline\ndeg 3 3\nsurf 0 1 0 1 " POINTS
     "\nparm u 0 0 0 1 1 1 1 2\nparm v 0 0 0 0 1 1 1 1\nend\n",
     "is not within parm's, 1 to 1"},
    {"cstype bspline\ndeg 3 3\nsurf -1 1 0 1 " POINTS
     "\nparm u -3 -2 -1 0 1 2 3 4\nparm v 0 0 0 0 1 1 1 1\nend\n",
     "surf's range of u, -1 to 1, is not within parm's, 0 to 1"},
    {"cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 3 4\nparm u 0 0 1 1\nend\n",
     "parm v has 0 numbers, needs at least 4"},
    {"t crease 2/1/0 0 1 2\n" BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS, "refers to vertex 0"},
};

static void test_damage(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof DAMAGED / sizeof *DAMAGED; i++) {
        char text[1000];
        int size = snprintf(text, sizeof text, "%s%s", GRID, DAMAGED[i].text);
        expect_cage_refused_with(text, (size_t)size, "part.obj", DAMAGED[i].words);
    }
}

/* Every shorter part of a file is refused with one line. */
static void test_cut_off(void **state)
{
    static const char whole[] = GRID BEZIER "surf 0 1 0 1 " POINTS "\n" ENDS;
    (void)state;
    for (size_t size = 1; size + 2 < sizeof whole - 1; size++)
        expect_cage_refused_with(whole, size, "part.obj", "part.obj:");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bezier),           cmocka_unit_test(test_forms_of_lines),
        cmocka_unit_test(test_uniform_bspline),  cmocka_unit_test(test_clamped_bspline),
        cmocka_unit_test(test_pieces_and_range), cmocka_unit_test(test_weld),
        cmocka_unit_test(test_equal_weights),    cmocka_unit_test(test_matrices),
        cmocka_unit_test(test_cardinal),         cmocka_unit_test(test_taylor),
        cmocka_unit_test(test_damage),           cmocka_unit_test(test_cut_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
