/* The reader of .patches files: one bicubic in each form, and one clear line for each kind of damage. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/unit/cage_expect.h"

static uint64_t state = 5;

static double uniform(void)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(state >> 11) * 0x1p-52 - 1;
}

/* A text that grows. */
struct writer {
    char text[8000];
    size_t n;
};

static void add_word(struct writer *writer, const char *word)
{
    writer->n +=
        (size_t)snprintf(writer->text + writer->n, sizeof writer->text - writer->n, "%s\n", word);
}

/* Adds the vector f (a - b). */
static void add_difference(struct writer *writer, double f, const double a[3], const double b[3])
{
    char row[100];
    snprintf(row, sizeof row, "%.17g %.17g %.17g", f * (a[0] - b[0]), f * (a[1] - b[1]),
             f * (a[2] - b[2]));
    add_word(writer, row);
}

static const double ZERO[3];

static void add_point(struct writer *writer, const double p[3])
{
    add_difference(writer, 1, p, ZERO);
}

static void add_corners(struct writer *writer, double net[16][3])
{
    add_word(writer, "hermite");
    for (int c = 0; c < 4; c++) {
        const int i = c & 1 ? 3 : 0, j = c & 2 ? 3 : 0, x = c & 1 ? -1 : 1, y = c & 2 ? -1 : 1;
        const double *p = net[4 * j + i], *q = net[4 * j + i + x], *r = net[4 * (j + y) + i],
                     *s = net[4 * (j + y) + i + x];
        double twist[3];
        for (int k = 0; k < 3; k++)
            twist[k] = (s[k] - q[k]) - (r[k] - p[k]);
        add_point(writer, p);
        add_difference(writer, 3 * x, q, p);
        add_difference(writer, 3 * y, r, p);
        add_difference(writer, 9 * x * y, twist, ZERO);
    }
}

static void add_sides(struct writer *writer, double net[16][3])
{
    static const int first[4] = {0, 12, 0, 3}, step[4] = {1, 1, 4, 4}, inwards[4] = {4, -4, 1, -1};
    add_word(writer, "coons-bicubic");
    for (int s = 0; s < 4; s++) {
        add_word(writer, "3");
        for (int i = 0; i < 4; i++)
            add_point(writer, net[first[s] + i * step[s]]);
    }
    for (int s = 0; s < 4; s++) {
        add_word(writer, "3");
        for (int i = 0; i < 4; i++) {
            const int at = first[s] + i * step[s];
            add_difference(writer, inwards[s] > 0 ? 3 : -3, net[at + inwards[s]], net[at]);
        }
    }
}

/* The same random bicubic as Bezier, B-spline, Hermite and bicubically blended Coons patch. */
static void test_one_bicubic_in_each_form(void **unused)
{
    (void)unused;
    for (int round = 0; round < 50; round++) {
        struct cage_patch bezier = {.basis = CAGE_BEZIER};
        struct writer writer = {.n = 0};
        struct cage cage;
        double spline[16][3], worst = 0;
        for (int k = 0; k < 16; k++)
            for (int i = 0; i < 3; i++)
                bezier.point[k][i] = uniform();
        cage_patch_bspline(&bezier, spline);
        add_word(&writer, "patches 1 # the form's version\nbezier 3 3");
        for (int k = 0; k < 16; k++)
            add_point(&writer, bezier.point[k]);
        add_word(&writer, "bspline");
        for (int k = 0; k < 16; k++)
            add_point(&writer, spline[k]);
        add_corners(&writer, bezier.point);
        add_sides(&writer, bezier.point);
        read_bytes(&cage, writer.text, writer.n, "part.patches");
        assert_int_equal(cage.n_patches, 4);
        assert_int_equal(cage.patch[0].line, 2);
        assert_int_equal(cage.patch[1].line, 19);
        assert_memory_equal(cage.patch[0].point, bezier.point, sizeof bezier.point);
        assert_memory_equal(cage.patch[1].point, spline, sizeof spline);
        for (int p = 1; p < 4; p++) {
            double got[16][3];
            cage_patch_bezier(&cage.patch[p], got);
            for (int k = 0; k < 16; k++)
                for (int i = 0; i < 3; i++)
                    worst = fmax(worst, fabs(got[k][i] - bezier.point[k][i]));
        }
        assert_true(worst < 2e-14);
        cage_finish(&cage);
    }
}

#define FLAT "0 0 0  1 0 0  0 1 0  1 1 0\n"
/* The sides of the unit square: v=0, v=1, u=0, u=1. */
#define SQUARE "1 0 0 0 1 0 0  1 0 1 0 1 1 0  1 0 0 0 0 1 0  1 1 0 0 1 1 0\n"
/* Their derivatives across: by v along the first two, by u along the others. */
#define ACROSS "1 0 1 0 0 1 0  1 0 1 0 0 1 0  1 1 0 0 1 0 0  1 1 0 0 1 0 0\n"

/* The unit square as Coons' patches and as Ferguson's; also by contents alone. */
static void test_squares(void **unused)
{
    static const char *const names[] = {"part.patches", "part"};
    static const char text[] =
        "patches 1\ncoons " SQUARE "coons-bicubic " SQUARE ACROSS
        "ferguson 0 0 0 1 0 0 0 1 0  1 0 0 1 0 0 0 1 0  0 1 0 1 0 0 0 1 0  1 1 0 1 0 0 0 1 0\n"
        "bezier 1 1 " FLAT;
    (void)unused;
    for (int i = 0; i < 2; i++) {
        struct cage cage;
        read_bytes(&cage, text, sizeof text - 1, names[i]);
        assert_int_equal(cage.n_patches, 4);
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 16; k++) {
                const double *at = cage.patch[p].point[k];
                assert_true(fabs(at[0] - k % 4 / 3.0) < 1e-15);
                assert_true(fabs(at[1] - k / 4 / 3.0) < 1e-15 && at[2] == 0);
            }
        cage_finish(&cage);
    }
}

/* Two twists at one corner: the mean, with one warning. */
static void test_twists(void **unused)
{
    static const char text[] =
        "patches 1\ncoons-bicubic " SQUARE
        "3 0 1 0 0 1 1 0 1 0 0 1 0  1 0 1 0 0 1 0  1 1 0 0 1 0 0  1 1 0 0 1 0 0\n";
    struct cage cage;
    (void)unused;
    read_bytes(&cage, text, sizeof text - 1, "part.patches");
    assert_string_equal(
        cage.warnings,
        "part.patches:3: the derivatives across both sides of a Coons patch give two "
        "twists at corner (0,0), and any others: their mean is taken");
    /* 3 on one side, 0 on the other: at the inner point of the corner, 1/9 of the mean less than of the side's alone. */
    assert_true(fabs(cage.patch[0].point[5][2] - (1.0 / 3 - 1.5 / 9)) < 1e-15);
    cage_finish(&cage);
}

static const struct {
    const char *text, *words;
} DAMAGED[] = {
    {"", "the file is empty"},
    {" ", "part.patches:1: is no .patches file: it does not begin with 'patches 1'"},
    {"v 0 0 0\n", "is no .patches file"},
    {"patches", "the file ends before the version of the form"},
    {"patches 2\n", ":1: the version of the form is 2, needs a whole number from 1 to 1"},
    {"patches x\n", ":1: the version of the form is not a number: 'x'"},
    {"patches 1\n", "no patch at all"},
    {"patches 1\nnurbs\n", ":2: no kind of patch: 'nurbs'; sheen draws bezier, bspline, hermite"},
    {"patches 1\n3 3\n", ":2: no kind of patch: '3'"},
    {"patches 1\nbezier\n", "ends before the degree along u"},
    {"patches 1\nbezier 3\n", "ends before the degree along v"},
    {"patches 1\nbezier 4 3\n", ":2: the degree along u is 4, needs a whole number from 1 to 3"},
    {"patches 1\nbezier 0 3\n", "the degree along u is 0"},
    {"patches 1\nbezier 1 1.5\n", "the degree along v is 1.5"},
    {"patches 1\nbezier 1 1\n", ":3: the file ends before coordinate x of point 1"},
    {"patches 1\nbezier 1 1 " FLAT "7\n", ":3: no kind of patch: '7'"},
    {"patches 1\nbezier 1 1 0 0 0 1 0 0 0 1 0 1 1\n", "ends before coordinate z of point 4"},
    {"patches 1\nbezier 1 1 0 0 nan\n", ":2: coordinate z of point 1 is not finite: 'nan'"},
    {"patches 1\nbspline 0 0 0\nbezier\n", ":3: coordinate x of point 2 is not a number: 'bezier'"},
    {"patches 1\nbspline 1e31\n", ":2: coordinate x of point 1 is 1e+31, beyond"},
    {"patches 1\nhermite 0 0 0\n", "ends before coordinate x of corner (0,0): row 2"},
    {"patches 1\nhermite 0 0 0 1 0 0 0 1 0 0 0 0\nx",
     ":3: coordinate x of corner (1,0): row 1 is not a number"},
    {"patches 1\nferguson 0 0 0 1 0 0 0 1 0 1 0 0 x",
     "coordinate x of corner (1,0): row 2 is not a number"},
    {"patches 1\ncoons\n", "ends before the degree of side v=0"},
    {"patches 1\ncoons 4\n", ":2: the degree of side v=0 is 4, needs a whole number from 1 to 3"},
    {"patches 1\ncoons 1 0 0 0 1 0 0 0\n", ":2: the degree of side v=1 is 0"},
    {"patches 1\ncoons 1 0 0 0 1 0 0 1 0 1 0 1 y",
     "coordinate y of side v=1: point 2 is not a number"},
    {"patches 1\ncoons 1 0 0 1 1 0 0  1 0 1 0 1 1 0  1 0 0 0 0 1 0  1 1 0 0 1 1 0\n",
     ":2: sides v=0 and u=0 of this Coons patch are 1 apart at corner (0,0)"},
    {"patches 1\ncoons 1 0 0 0 1 0 1  1 0 1 0 1 1 0  1 0 0 0 0 1 0  1 1 0 0 1 1 0\n",
     "sides v=0 and u=1 of this Coons patch are 1 apart at corner (1,0)"},
    {"patches 1\ncoons 1 0 0 0 1 0 0  1 0 1 1e-3 1 1 0  1 0 0 0 0 1 0  1 1 0 0 1 1 0\n",
     "sides v=1 and u=0 of this Coons patch are 0.001 apart at corner (0,1)"},
    {"patches 1\ncoons 1 0 0 0 1 0 0  1 0 1 0 1 1 0  1 0 0 0 0 1 0  1 1 0 0 1 1 1\n",
     "sides v=1 and u=1 of this Coons patch are 1 apart at corner (1,1)"},
    {"patches 1\ncoons-bicubic " SQUARE, "ends before the degree of derivative across v=0"},
    {"patches 1\ncoons-bicubic " SQUARE
     "1 0 1 1 0 1 0  1 0 1 0 0 1 0  1 1 0 0 1 0 0  1 1 0 0 1 0 0\n",
     "the derivative across side v=0 of this Coons patch is not that of side u=0 at corner (0,0)"},
    {"patches 1\ncoons-bicubic " SQUARE
     "1 0 1 0 0 1 0  1 0 1 0 0 1 0  1 1 0 0 1 1 0  1 1 0 0 1 0 0\n",
     "the derivative across side u=0 of this Coons patch is not that of side v=1 at corner (0,1)"},
    {"patches 1\ncoons-bicubic " SQUARE
     "1 0 1 0 0 1 0  1 0 1 0 0 2 0  1 1 0 0 1 0 0  1 1 0 0 1 0 0\n",
     "the derivative across side v=1 of this Coons patch is not that of side u=1 at corner (1,1)"},
    {"patches 1\nCoons " SQUARE, "no kind of patch: 'Coons'"},
};

static void expect_refusal(const char *text, size_t size, const char *words)
{
    expect_cage_refused_with(text, size, "part.patches", words);
}

static void test_damage(void **unused)
{
    static const char whole[] = "patches 1 coons-bicubic " SQUARE ACROSS;
    (void)unused;
    for (size_t i = 0; i < sizeof DAMAGED / sizeof *DAMAGED; i++)
        expect_refusal(DAMAGED[i].text, strlen(DAMAGED[i].text), DAMAGED[i].words);
    expect_refusal("patches 1\0", 10, "is not a .patches file: byte 9 is 0");
    for (size_t size = 1; size + 2 < sizeof whole - 1; size++) {
        char *part = strndup(whole, size);
        expect_refusal(part, size, "part.patches:");
        free(part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_bicubic_in_each_form),
        cmocka_unit_test(test_squares),
        cmocka_unit_test(test_twists),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
