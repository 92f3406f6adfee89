/* The OBJ reader: geometry, OpenSubdiv's tags, every message, and real files. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/unit/cage_expect.h"

#define SHAPES "../shared/shapes"
#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" /* lines 1 to 4 */
/* Lines 1 to 8: two quads side by side, vertices 0 1 2 / 3 4 5. */
#define PAIR "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nf 1 2 5 4\nf 2 3 6 5\n"

#define NO_FACE(line, n) "part.obj:" line ": no face of " n " can be drawn; this is a face with "
#define FEW "fewer than 3 different corners"
#define KEYHOLE "a vertex at corners that are no neighbours (a keyhole: split it)"

static void expect_bad(const char *text, const char *message)
{
    expect_cage_refused(text, strlen(text), "part.obj", message);
}

static size_t found(const struct cage *cage, enum cage_finding_kind kind)
{
    for (size_t i = 0; i < cage->n_findings; i++)
        if (cage->finding[i].kind == kind)
            return cage->finding[i].count;
    return 0;
}

/* Geometry */

static void test_index_forms(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, SQUARE "vt 0 0\nvn 0 0 1\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\n"
                           "f 1/1/1 2/1/1 3/1/1\nf -4 -3 -2 -1\nf -4//-1 2/ 3// +4/1/\n");
    assert_int_equal(cage.n_faces, 6);
    assert_int_equal(cage.n_vertices, 4);
    for (size_t f = 0; f < 4; f++)
        EXPECT_FACE(&cage, f, 0, 1, 2);
    EXPECT_FACE(&cage, 4, 0, 1, 2, 3);
    EXPECT_FACE(&cage, 5, 0, 1, 2, 3);
    assert_true(cage.position[2][0] == 1 && cage.position[2][1] == 1 && cage.position[2][2] == 0);
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_ONLY);
    assert_int_equal(cage.scheme, CAGE_SCHEME_CATMULL_CLARK);
    assert_int_equal(cage.n_findings, 2);
    assert_int_equal(found(&cage, CAGE_FOUND_FACE_TWICE), 4);
    assert_int_equal(found(&cage, CAGE_FOUND_WOUND), 2);
    cage_finish(&cage);
}

/* Negative indices count from the vertices read so far, positive ones from the file's start. */
static void test_order(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, "f 1 2 3\n" SQUARE "f -3 -2 -1\nv 5 5 5\nf -3 -2 -1\n");
    assert_int_equal(cage.n_vertices, 5);
    EXPECT_FACE(&cage, 0, 0, 1, 2);
    EXPECT_FACE(&cage, 1, 1, 2, 3);
    EXPECT_FACE(&cage, 2, 2, 3, 4);
    cage_finish(&cage);
}

static void test_lines(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nf 1 2 3\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rf 1 2 3\r",
        "\xef\xbb\xbfv\t0\t0\t0\nv  1 \t 0 0 \nv 1 1 0\nf 1 2 3", /* no last newline */
        "\n\n  v 0 0 0 # here\n#v 9 9 9\n # \\\nv 1 0 0 #\nv 1 1 0\n f 1 2 3 #4\n",
        "v 0 \\\n0 0\nv 1 0 \\\r\n0\nv \\\n\\\n1 1 0\nf 1\\\n 2 3\\\n",
        "v 0 0 0 1.0\nv 1 0 0 0.5 0.25 0.125\nv 1 1 0 1\nf 1 2 3\n", /* weight, colour */
        "mtllib a.mtl\no x\ng a b\nusemtl m\ns off\ns 1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvp 1\nl 1 2\n"
        "p 1\nf 1 2 3\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct cage cage;
        read_obj(&cage, texts[i]);
        assert_int_equal(cage.n_vertices, 3);
        assert_int_equal(cage.n_faces, 1);
        EXPECT_FACE(&cage, 0, 0, 1, 2);
        assert_true(cage.position[1][0] == 1 && cage.position[2][1] == 1);
        assert_null(cage.warnings);
        cage_finish(&cage);
    }
}

/* One face of 20000 corners, on one line and on as many continued lines. */
static void test_long_line(void **state)
{
    (void)state;
    enum { N = 20000 };
    for (int continued = 0; continued < 2; continued++) {
        char *text = malloc(N * 64);
        assert_non_null(text);
        size_t at = 0;
        for (int i = 0; i < N; i++)
            at += (size_t)sprintf(text + at, "v %.17g %.17g 0\n", cos(i * 3e-4), sin(i * 3e-4));
        text[at++] = 'f';
        for (int i = 0; i < N; i++)
            at += (size_t)sprintf(text + at, "%s %d/1/1", continued ? "\\\n" : "", i + 1);
        text[at] = '\0';
        struct cage cage;
        read_obj(&cage, text);
        assert_int_equal(cage.n_faces, 1);
        assert_int_equal(cage.face_start[1], N);
        assert_int_equal(cage.face_vertex[N - 1], N - 1);
        assert_true(cage.position[777][0] == cos(777 * 3e-4));
        cage_finish(&cage);
        free(text);
    }
}

static void test_geometry_errors(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"", "part.obj: the file is empty"},
        {"# nothing\n",
         "part.obj: is not an OBJ file: it has no vertex and no face. sheen reads OBJ; "
         "glTF and GLB need a name that ends in .gltf or .glb"},
        {SQUARE, "part.obj: no face at all (4 vertices): a cage needs at least one face"},
        {"v\n", "part.obj:1: v has 0 coordinates, needs 3"},
        {SQUARE "v 1\n", "part.obj:5: v has 1 coordinate, needs 3"},
        {"v 1 2 # 3\n", "part.obj:1: v has 2 coordinates, needs 3"},
        {"\n\\\n\nv 0 x1 0\n", "part.obj:4: coordinate y of v is not a number: 'x1'"},
        {"v 0 0 1,5\n", "part.obj:1: coordinate z of v is not a number: '1,5'"},
        {"v nan 0 0\n", "part.obj:1: coordinate x of v is not finite: 'nan'"},
        {"v 0 0 -INF\n", "part.obj:1: coordinate z of v is not finite: '-INF'"},
        {"v 0 1e309 0\n", "part.obj:1: coordinate y of v is not finite: '1e309'"},
        {"v 0 1e308 0\n", "part.obj:1: coordinate y of v is 1e+308, beyond the largest that is "
                          "read, 1e+30"},
        {SQUARE "f 1 2\n", NO_FACE("5", "1") FEW},
        {SQUARE "\nf 1\nf\n", NO_FACE("6", "2") FEW},
        {SQUARE "f 1 2 1\n", NO_FACE("5", "1") FEW},
        {SQUARE "f 1 2 3 2\n", NO_FACE("5", "1") KEYHOLE},
        {SQUARE "f 1 1 3 2 1 3\nf 4 4 4\n", NO_FACE("5", "2") KEYHOLE},
        {SQUARE "f 1 2 3 5\n",
         "part.obj:5: face corner 4 refers to vertex 5, but the file has 4 vertices"},
        {"f 1 2 99\n" SQUARE,
         "part.obj:1: face corner 3 refers to vertex 99, but the file has 4 vertices"},
        {SQUARE "f 1 2 4294967297\n", "part.obj:5: face corner 3 refers to vertex 4294967297, "
                                      "beyond the largest that is read, 100000000"},
        {SQUARE "f 0 1 2\n", "part.obj:5: face corner 1 refers to vertex 0, but OBJ counts from 1"},
        {"f -1 -2 -3\n" SQUARE, "part.obj:1: face corner 1 refers to vertex -1, but only 0 "
                                "vertices stand before it"},
        {SQUARE "f 1 2 -5\n", "part.obj:5: face corner 3 refers to vertex -5, but only 4 vertices "
                              "stand before it"},
        {SQUARE "f 1 2 x\n", "part.obj:5: face corner 3 is not v, v/t, v//n or v/t/n: 'x'"},
        {SQUARE "f 1 2 3/a\n", "part.obj:5: face corner 3 is not v, v/t, v//n or v/t/n: '3/a'"},
        {SQUARE "f 1 2/1/1/1 3\n",
         "part.obj:5: face corner 2 is not v, v/t, v//n or v/t/n: '2/1/1/1'"},
        {SQUARE "f 1 2.0 3\n", "part.obj:5: face corner 2 is not v, v/t, v//n or v/t/n: '2.0'"},
        {SQUARE "f /1 2 3\n", "part.obj:5: face corner 1 is not v, v/t, v//n or v/t/n: '/1'"},
        {SQUARE "f 1 - 3\n", "part.obj:5: face corner 2 is not v, v/t, v//n or v/t/n: '-'"},
        {SQUARE "f 1 \\\n2 \\\n3 \\\n9\n",
         "part.obj:5: face corner 4 refers to vertex 9, but the file has 4 vertices"},
        {"v 0 0 \x1b[31m\n", "part.obj:1: coordinate z of v is not a number: '?[31m'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_bad(bad[i].text, bad[i].message);
}

static void test_bytes_that_are_no_text(void **state)
{
    (void)state;
    char bytes[4096];
    uint32_t random = 1;
    for (int round = 0; round < 200; round++) {
        for (size_t i = 0; i < sizeof bytes; i++) {
            random = random * 1664525 + 1013904223;
            bytes[i] =
                round % 2 ? (char)(1 + (random >> 24) % 255) : "vft 0123/-\\\n\r#."[random >> 28];
        }
        struct cage cage;
        struct error error = {0};
        if (cage_read(&cage, bytes, sizeof bytes, "part.obj", &error))
            cage_finish(&cage);
        else
            assert_true(error.text[0] && !strpbrk(error.text, "\n\r\x1b"));
    }
    static const char other[] = SQUARE "f 1 2 3 4\n\0";
    struct cage cage;
    struct error error = {0};
    assert_false(cage_read(&cage, other, sizeof other - 1, "part.obj", &error));
    assert_non_null(strstr(error.text, "part.obj: is not an OBJ file: byte 42 is 0, "));
}

/* Tags */

static void expect_crease(const struct cage *cage, size_t i, uint32_t a, uint32_t b, float sharp)
{
    assert_int_equal(cage->crease[i].vertex[0], a);
    assert_int_equal(cage->crease[i].vertex[1], b);
    assert_true(cage->crease[i].sharpness == sharp);
}

static void test_crease_tags(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, PAIR "t crease 2/1/0 1 4 2.5\n"
                         "t\tcrease  4/1/0\t0 1 1 2 \\\n 10\n"
                         "t crease 4/2/0 0 3 2 5 1 2\n"
                         "t crease 4/4/0 3 4 4 5 3 99 4 99\n"
                         "t crease 2/2/0 0 1 7 99\n"
                         "t crease 2/1/0 1 2 0\n");
    assert_int_equal(cage.n_creases, 9);
    expect_crease(&cage, 0, 1, 4, 2.5f);
    expect_crease(&cage, 1, 0, 1, 10);
    expect_crease(&cage, 2, 1, 2, 10);
    expect_crease(&cage, 3, 0, 3, 1);
    expect_crease(&cage, 4, 2, 5, 2);
    expect_crease(&cage, 5, 3, 4, 3);
    expect_crease(&cage, 6, 4, 5, 4);
    expect_crease(&cage, 7, 0, 1, 7);
    expect_crease(&cage, 8, 1, 2, 0);
    assert_null(cage.warnings);
    cage_finish(&cage);
}

static void test_other_tags(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, "t interpolateboundary 1/0/0 1\nt creasemethod 0/0/1 chaikin\n" PAIR
                    "t corner 1/1/0 2 3.5\nt corner 2/2/0 0 5 1 2\nt corner 2/1/0 1 3 4\n"
                    "t hole 2/0/0 1 0\nt smoothtriangles 0/0/1 smooth\n");
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_AND_CORNER);
    assert_true(cage.chaikin && cage.smooth_triangles);
    static const struct cage_corner corner[] = {{2, 3.5f}, {0, 1}, {5, 2}, {1, 4}, {3, 4}};
    assert_int_equal(cage.n_corners, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_int_equal(cage.corner[i].vertex, corner[i].vertex);
        assert_true(cage.corner[i].sharpness == corner[i].sharpness);
    }
    assert_int_equal(cage.n_holes, 2);
    assert_int_equal(cage.hole[0], 1);
    assert_int_equal(cage.hole[1], 0);
    cage_finish(&cage);

    read_obj(&cage, PAIR "t interpolateboundary 1/0/0 0\nt creasemethod 0/0/1 normal\n"
                         "t smoothtriangles 0/0/1 catmark\n");
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_NONE);
    assert_false(cage.chaikin || cage.smooth_triangles);
    cage_finish(&cage);
    read_obj(&cage, PAIR "t interpolateboundary 1/0/0 2\n");
    assert_int_equal(cage.boundary, CAGE_BOUNDARY_EDGE_ONLY);
    cage_finish(&cage);
}

/* The last tag holds, wherever it is in the file. */
static void test_scheme_tags(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        enum cage_scheme scheme;
    } good[] = {
        {"t scheme 0/0/1 loop\n" PAIR, CAGE_SCHEME_LOOP},
        {PAIR "t scheme 0/0/1 bilinear\n", CAGE_SCHEME_BILINEAR},
        {PAIR "t scheme 0/0/1 catmark\n", CAGE_SCHEME_CATMULL_CLARK},
        {"t scheme 0/0/1 loop\n" PAIR "t scheme 0/0/1 catmark\n", CAGE_SCHEME_CATMULL_CLARK},
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct cage cage;
        read_obj(&cage, good[i].text);
        assert_int_equal(cage.scheme, good[i].scheme);
        assert_null(cage.warnings);
        cage_finish(&cage);
    }
}

static void test_tag_errors(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message;
    } bad[] = {
        {"t\n", "t has no tag name"},
        {"t crease\n", "t crease has no counts, for example 2/1/0"},
        {"t crease 2/1 0 1 2\n",
         "t crease needs its counts as ints/floats/strings, for example 2/1/0, not '2/1'"},
        {"t crease 0 1 2\n",
         "t crease needs its counts as ints/floats/strings, for example 2/1/0, not '0'"},
        {"t crease 99999999999/1/0 0 1 2\n", "t crease needs its counts as ints/floats/strings, "
                                             "for example 2/1/0, not '99999999999/1/0'"},
        {"t crease 300000000/1/0 0 1 1 2\n",
         "t crease ends before its last integer: it announces 300000000/1/0"},
        {"t crease 2/1/0 1 4\n", "t crease ends before its last sharpness: it announces 2/1/0"},
        {"t crease 3/1/0 0 1 2 1\n", "t crease needs pairs of vertices, not 3"},
        {"t crease 0/1/0 1\n", "t crease needs pairs of vertices, not 0"},
        {"t crease 4/3/0 0 1 1 2 1 2 3\n",
         "t crease has 3 sharpnesses for 2 edges: give one, or one each"},
        {"t crease 2/0/0 0 1\n", "t crease has 0 sharpnesses for 1 edges: give one, or one each"},
        {"t crease 2/1/0 1 4 2 5\n", "t crease has more than it announces (2/1/0): '5'"},
        {"t crease 2/1/0 1 x 2\n", "t crease: not an index: 'x'"},
        {"t crease 2/1/0 1 - 2\n", "t crease: not an index: '-'"},
        {"t hole 1/0/0 -1.5\n", "t hole: not an index: '-1.5'"},
        {"t crease 2/1/0 1 4 hard\n", "t crease: not a sharpness: 'hard'"},
        {"t crease 2/1/0 1 4 inf\n", "t crease: not a sharpness: 'inf'"},
        {"t crease 2/1/0 1 4 1e39\n", "t crease: not a sharpness: '1e39'"},
        {"t corner 0/1/0 1\n", "t corner names no vertex"},
        {"t corner 3/2/0 0 1 2 1 2\n",
         "t corner has 2 sharpnesses for 3 vertices: give one, or one each"},
        {"t corner 1/1/0 0\n", "t corner ends before its last sharpness: it announces 1/1/0"},
        {"t hole 0/0/0\n", "t hole names no face"},
        {"t hole 2/0/0 1\n", "t hole ends before its last integer: it announces 2/0/0"},
        {"t interpolateboundary 1/0/0 3\n",
         "t interpolateboundary is none of 0 (none), 1 (edge and "
         "corner), 2 (edge only)"},
        {"t interpolateboundary 0/0/1 none\n", "t interpolateboundary needs one number, 1/0/0"},
        {"t creasemethod 0/0/1 Chaikin\n", "t creasemethod is 'Chaikin', needs normal or chaikin"},
        {"t creasemethod 1/0/0 1\n", "t creasemethod needs one word, 0/0/1"},
        {"t smoothtriangles 0/0/1\n",
         "t smoothtriangles ends before its last word: it announces 0/0/1"},
        {"t smoothtriangles 0/0/1 loop\n", "t smoothtriangles is 'loop', needs catmark or smooth"},
        {"t scheme 0/0/1 Loop\n", "t scheme is 'Loop', needs catmark, loop or bilinear"},
        {"t scheme 0/0/1\n", "t scheme ends before its last word: it announces 0/0/1"},
        {"t scheme 1/0/0 1\n", "t scheme needs one word, 0/0/1"},
        {"t scheme 0/0/1 loop catmark\n", "t scheme has more than it announces (0/0/1): 'catmark'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char text[400], message[480];
        snprintf(text, sizeof text, "%s%s", PAIR, bad[i].text);
        snprintf(message, sizeof message, "part.obj:9: %s", bad[i].message);
        expect_bad(text, message);
    }
}

static void test_warnings(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, PAIR "shadow_obj a\ntrace_obj b\nshadow_obj c\n"
                         "t facevaryinginterpolateboundary 1/0/0 1\n"
                         "t facevaryingpropagatecorners 1/0/0 1\n"
                         "t vertexedit 5/4/2 0 0 1 0 0 1 2 3 4 set P\n");
    assert_string_equal(
        cage.warnings,
        "part.obj:9: unknown keyword 'shadow_obj' passed over, and any others\n"
        "part.obj:12: t facevaryinginterpolateboundary is about textures and passed over\n"
        "part.obj:14: t vertexedit is not read: the surface is drawn as if it were not there");
    cage_finish(&cage);
}

/* Several negative sharpnesses make one warning, which names the first. */
static void test_negative_sharpness(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, PAIR "t crease 2/1/0 0 1 0\nt crease 4/2/0 0 1 1 2 3 -0.5\n"
                         "t corner 1/1/0 0 -7\n");
    assert_string_equal(cage.warnings, "part.obj:10: t crease: sharpness -0.5 counts as 0, as "
                                       "any other below 0");
    assert_true(cage.crease[1].sharpness == 3 && cage.crease[2].sharpness == 0);
    assert_true(cage.corner[0].sharpness == 0);
    cage_finish(&cage);
}

/* Files */

static char *load(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("cannot open %s: run the tests from the repository's root", path);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    *size = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*size + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *size, file), *size);
    bytes[*size] = '\0';
    fclose(file);
    return bytes;
}

static size_t count_lines(const char *text, const char *start)
{
    size_t n = strncmp(text, start, strlen(start)) == 0, length = strlen(start);
    for (const char *at = text; (at = strchr(at, '\n')); at++)
        n += strncmp(at + 1, start, length) == 0;
    return n;
}

static void test_own_models(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t n_vertices, n_faces, n_corners;
    } models[] = {
        {"fender", 229, 192, 768}, {"body", 98, 96, 384},   {"sheet", 169, 144, 576},
        {"plane", 49, 36, 144},    {"pole", 121, 120, 456}, {"ngons", 19, 14, 62},
        {"tetra", 4, 4, 12},
    };
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        char path[100];
        size_t size;
        snprintf(path, sizeof path, "tests/models/%s.obj", models[i].name);
        char *bytes = load(path, &size);
        struct cage cage;
        struct error error = {0};
        if (!cage_read(&cage, bytes, size, path, &error))
            fail_msg("%s", error.text);
        assert_int_equal(cage.n_vertices, models[i].n_vertices);
        assert_int_equal(cage.n_faces, models[i].n_faces);
        assert_int_equal(cage.face_start[cage.n_faces], models[i].n_corners);
        if (strcmp(models[i].name, "tetra") == 0) /* is made of triangles */
            assert_int_equal(cage.finding[0].kind, CAGE_FOUND_TRIANGLES);
        else
            assert_null(cage.warnings);
        cage_finish(&cage);
        free(bytes);
    }
}

/* Models of OpenSubdiv's suite in which faces repeat a vertex on purpose. */
static const struct {
    const char *name;
    size_t n_lost_a_corner, n_few_corners, n_keyholes;
} DEGENERATE[] = {
    {"catmark_nonman_edges", 10, 3, 1},
    {"loop_nonman_edges", 0, 4, 0},
    {"catmark_nonman_quadpole8", 8, 0, 0},
};

/* Returns how many faces of this model are dropped. */
static size_t check_degenerate(const char *path, const struct cage *cage)
{
    for (size_t i = 0; i < sizeof DEGENERATE / sizeof *DEGENERATE; i++) {
        if (!strstr(path, DEGENERATE[i].name))
            continue;
        assert_int_equal(found(cage, CAGE_FOUND_REPEATED_CORNER), DEGENERATE[i].n_lost_a_corner);
        assert_int_equal(found(cage, CAGE_FOUND_FEW_CORNERS), DEGENERATE[i].n_few_corners);
        assert_int_equal(found(cage, CAGE_FOUND_KEYHOLE), DEGENERATE[i].n_keyholes);
        return DEGENERATE[i].n_few_corners + DEGENERATE[i].n_keyholes;
    }
    for (size_t i = 0; i < cage->n_findings; i++)
        assert_true(cage->finding[i].kind > CAGE_FOUND_HOLE);
    return 0;
}

struct totals {
    size_t files, faces_lost, creases, corners, holes, boundaries, chaikin;
};

static void read_shape(const char *path, struct totals *totals)
{
    size_t size;
    char *bytes = load(path, &size);
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, bytes, size, path, &error))
        fail_msg("%s", error.text);
    size_t n_lost = check_degenerate(path, &cage);
    assert_int_equal(cage.n_vertices, count_lines(bytes, "v "));
    assert_int_equal(cage.n_faces + n_lost, count_lines(bytes, "f "));
    assert_int_equal(cage.n_creases, count_lines(bytes, "t crease "));
    assert_int_equal(cage.warnings && strstr(cage.warnings, "t facevarying"),
                     count_lines(bytes, "t facevarying") > 0);
    totals->files++;
    totals->faces_lost += n_lost;
    totals->creases += cage.n_creases;
    totals->corners += cage.n_corners;
    totals->holes += cage.n_holes;
    totals->boundaries += cage.boundary != CAGE_BOUNDARY_EDGE_ONLY;
    totals->chaikin += cage.chaikin;
    cage_finish(&cage);
    free(bytes);
}

static void test_shapes(void **state)
{
    (void)state;
    DIR *folder = opendir(SHAPES);
    if (!folder) {
        print_message("no %s here: OpenSubdiv's shapes are not tested\n", SHAPES);
        skip();
    }
    struct totals totals = {0};
    for (struct dirent *entry; (entry = readdir(folder));) {
        size_t length = strlen(entry->d_name);
        char path[400];
        if (length < 4 || strcmp(entry->d_name + length - 4, ".obj") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", SHAPES, entry->d_name);
        read_shape(path, &totals);
    }
    closedir(folder);
    assert_int_equal(totals.files, 50);
    assert_int_equal(totals.faces_lost, 8);
    assert_int_equal(totals.creases, 717);
    assert_int_equal(totals.corners, 15);
    assert_int_equal(totals.holes, 9);
    assert_int_equal(totals.chaikin, 1);
    assert_true(totals.boundaries > 10);
}

/* A sheet of side * side quads, with the digits that modellers write. */
static char *make_sheet(size_t side, size_t *size)
{
    char *text = malloc((side + 1) * (side + 1) * 40 + side * side * 60 + 1);
    assert_non_null(text);
    char *at = text;
    for (size_t i = 0; i < (side + 1) * (side + 1); i++)
        at += sprintf(at, "v %.6f %.6f %.6f\n", (double)(i % (side + 1)) * 0.731,
                      (double)(i / (side + 1)) * 0.517, sin((double)i));
    for (size_t f = 0; f < side * side; f++) {
        size_t a = f / side * (side + 1) + f % side + 1, b = a + side + 1;
        at += sprintf(at, "f %zu/1 %zu/1 %zu/1 %zu/1\n", a, a + 1, b + 1, b);
    }
    *size = (size_t)(at - text);
    return text;
}

static void test_a_million_faces(void **state)
{
    (void)state;
#if defined(__SANITIZE_ADDRESS__)
    const size_t side = 200; /* under a sanitizer the time tells nothing about the reader */
#else
    const size_t side = 1000;
#endif
    size_t size;
    char *text = make_sheet(side, &size);
    struct cage cage;
    struct error error = {0};
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    bool ok = cage_read(&cage, text, size, "sheet.obj", &error);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    if (!ok)
        fail_msg("%s", error.text);
    double seconds =
        (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    print_message("%zu faces, %zu bytes: %.2f s\n", side * side, size, seconds);
    assert_int_equal(cage.n_faces, side * side);
    assert_true(seconds < 4);
    cage_finish(&cage);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_index_forms),     cmocka_unit_test(test_order),
        cmocka_unit_test(test_lines),           cmocka_unit_test(test_long_line),
        cmocka_unit_test(test_geometry_errors), cmocka_unit_test(test_bytes_that_are_no_text),
        cmocka_unit_test(test_crease_tags),     cmocka_unit_test(test_other_tags),
        cmocka_unit_test(test_scheme_tags),     cmocka_unit_test(test_tag_errors),
        cmocka_unit_test(test_warnings),        cmocka_unit_test(test_negative_sharpness),
        cmocka_unit_test(test_own_models),      cmocka_unit_test(test_shapes),
        cmocka_unit_test(test_a_million_faces),
    };
    return cmocka_run_group_tests_name("cage/obj", tests, NULL, NULL);
}
