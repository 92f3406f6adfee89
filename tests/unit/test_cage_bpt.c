/* The reader of .bpt files: what it reads, and one clear line for each kind of damage. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/unit/cage_expect.h"

/* A bilinear patch with a comment and a line that continues. */
static const char BILINEAR[] = "1 # patch\n1 1\n0 0 0\n1 0 \\\n 0\n0 1 0\n1 1 2\n";

static void test_degrees_are_raised(void **state)
{
    struct cage cage;
    (void)state;
    read_bytes(&cage, BILINEAR, sizeof BILINEAR - 1, "part.bpt");
    assert_int_equal(cage.n_patches, 1);
    assert_int_equal(cage.n_faces, 0);
    assert_int_equal(cage.n_vertices, 0);
    assert_int_equal(cage.patch[0].basis, CAGE_BEZIER);
    assert_int_equal(cage.patch[0].line, 2);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) {
            const double *p = cage.patch[0].point[4 * j + i], u = i / 3.0, v = j / 3.0;
            assert_true(fabs(p[0] - u) < 1e-15 && fabs(p[1] - v) < 1e-15);
            assert_true(fabs(p[2] - 2 * u * v) < 1e-15);
        }
    cage_finish(&cage);
}

/* Of degree 1 x 2: rows along u have two points, and there are three rows. */
static void test_u_is_the_faster_index(void **state)
{
    struct cage cage;
    static const char text[] = "1\n1 2\n0 0 0 5 0 0\n0 1 0 5 1 0\n0 2 0 5 2 0\n";
    (void)state;
    read_bytes(&cage, text, sizeof text - 1, "part.bpt");
    assert_true(cage.patch[0].point[3][0] == 5 && cage.patch[0].point[3][1] == 0);
    assert_true(cage.patch[0].point[12][0] == 0 && cage.patch[0].point[12][1] == 2);
    cage_finish(&cage);
}

/* Without an ending the contents decide. */
static void test_format_by_contents(void **state)
{
    struct cage cage;
    (void)state;
    read_bytes(&cage, BILINEAR, sizeof BILINEAR - 1, "part");
    assert_int_equal(cage.n_patches, 1);
    cage_finish(&cage);
    read_bytes(&cage, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 32, "part");
    assert_int_equal(cage.n_faces, 1);
    cage_finish(&cage);
}

static void test_patches_against_each_other(void **state)
{
    static const char *const second[] = {"1 0 0 1 1 0 2 0 0 2 1 0",  /* u and v exchanged */
                                         "1 0 0 2 0 0 1 1 0 2 1 0"}; /* as it should be */
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct cage cage;
        char text[200];
        int size =
            snprintf(text, sizeof text, "2\n1 1 0 0 0 1 0 0 0 1 0 1 1 0\n1 1 %s\n", second[i]);
        read_bytes(&cage, text, (size_t)size, "part.bpt");
        assert_int_equal(cage.n_findings, i == 0);
        if (i == 0) {
            assert_int_equal(cage.finding[0].kind, CAGE_FOUND_WOUND);
            assert_int_equal(cage.finding[0].count, 1);
            assert_int_equal(cage.finding[0].line, 2);
            assert_non_null(strstr(cage.warnings, "part.bpt:2: a patch is wound against"));
        }
        cage_finish(&cage);
    }
}

static void expect_refusal(const char *text, size_t size, const char *words)
{
    expect_cage_refused_with(text, size, "part.bpt", words);
}

static const struct {
    const char *text, *words;
} DAMAGED[] = {
    {"", "the file is empty"},
    {" ", "ends before the number of patches"},
    {"# nothing\n", "ends before the number of patches"},
    {"x", "the number of patches is not a number: 'x'"},
    {"0\n", "the number of patches is 0, needs a whole number from 1 to 10000000"},
    {"-1\n", "the number of patches is -1, needs"},
    {"1.5\n", "the number of patches is 1.5, needs"},
    {"1e9\n", "the number of patches is 1e+09, needs"},
    {"nan\n", "the number of patches is not finite: 'nan'"},
    {"inf\n", "not finite"},
    {"1\n", "part.bpt:2: the file ends before the degree along u"},
    {"1\n3\n", "ends before the degree along v"},
    {"1\n3 x", "part.bpt:2: the degree along v is not a number: 'x'"},
    {"1\n0 3\n", "the degree along u is 0, needs"},
    {"1\n3 0\n", "the degree along v is 0, needs"},
    {"1\n3 2.5\n", "the degree along v is 2.5, needs"},
    {"1\n4 3\n",
     "part.bpt:2: a patch of degree 4 along u: sheen draws Bezier patches of degree 1 to 3"},
    {"1\n3 25\n", "part.bpt:2: a patch of degree 25 along v: sheen draws"},
    {"1\n1001 1\n", "the degree along u is 1001, needs a whole number from 1 to 1000"},
    {"1\n1 1\n", "part.bpt:3: the file ends before coordinate x of point 1"},
    {"1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1",
     "part.bpt:6: the file ends before coordinate z of point 4"},
    {"1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 z",
     "part.bpt:6: coordinate z of point 4 is not a number: 'z'"},
    {"1\n1 1\n0 0 0\n1 nan 0\n", "part.bpt:4: coordinate y of point 2 is not finite"},
    {"1\n1 1\n0 0 1e400\n", "coordinate z of point 1 is not finite"},
    {"1\n1 1\n0 0 1e31\n", "part.bpt:3: coordinate z of point 1 is 1e+31, beyond the largest"},
    {"1\n1 1\n0,0,0\n", "coordinate x of point 1 is not a number: '0,0,0'"},
    {"1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0 7\n", "more follows after the last of 1 patches: '7'"},
    {"2\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0\n", "ends before the degree along u"},
    {"1\n1 1\n0 0 0 1 0 0 0 1 0 1 1 0\n1 1\n", "part.bpt:4: more follows"},
    {"1 1 1 0 0 0 1 0 0 0 1 0 1 1 0x1\n", "coordinate z of point 4 is not a number: '0x1'"},
};

static void test_damage(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof DAMAGED / sizeof *DAMAGED; i++)
        expect_refusal(DAMAGED[i].text, strlen(DAMAGED[i].text), DAMAGED[i].words);
    expect_refusal("1\n1 1\n0 0 0\0", 12, "is not a .bpt file: byte 11 is 0");
}

/* Every shorter part of a file is refused with one line. */
static void test_cut_off(void **state)
{
    (void)state;
    for (size_t size = 0; size + 2 < sizeof BILINEAR - 1; size++) {
        char *part = strndup(BILINEAR, size);
        expect_refusal(part, size, size ? "part.bpt:" : "part.bpt: the file is empty");
        free(part);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_degrees_are_raised),
        cmocka_unit_test(test_u_is_the_faster_index),
        cmocka_unit_test(test_format_by_contents),
        cmocka_unit_test(test_patches_against_each_other),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_cut_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
