/* cage_check(), cage_warn(), cage_found(), and how cage_read() chooses a reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/cage/read/read.h"

/* Two quads side by side, an edge between them with a crease, a sharp corner and a hole. */
struct sample {
    double position[6][3];
    uint32_t start[3];
    uint32_t vertex[8];
    struct cage_crease crease[2];
    struct cage_corner corner[1];
    uint32_t hole[1];
    struct cage cage;
};

static void sample_init(struct sample *sample)
{
    *sample = (struct sample){
        .position = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
        .start = {0, 4, 8},
        .vertex = {0, 1, 4, 3, 1, 2, 5, 4},
        .crease = {{{4, 1}, 2}, {{0, 3}, 10}},
        .corner = {{2, 3.5f}},
        .hole = {1},
    };
    sample->cage = (struct cage){
        .n_vertices = 6,
        .position = sample->position,
        .n_faces = 2,
        .face_start = sample->start,
        .face_vertex = sample->vertex,
        .n_creases = 2,
        .crease = sample->crease,
        .n_corners = 1,
        .corner = sample->corner,
        .n_holes = 1,
        .hole = sample->hole,
    };
}

static void expect_good(const struct sample *sample)
{
    struct error error = {0};
    if (!cage_check(&sample->cage, "part", &error))
        fail_msg("refused: %s", error.text);
}

static void expect_bad(const struct sample *sample, const char *text)
{
    struct error error = {0};
    assert_false(cage_check(&sample->cage, "part", &error));
    assert_int_equal(error.kind, ERROR_MODEL);
    assert_string_equal(error.text, text);
}

static void test_good(void **state)
{
    (void)state;
    struct sample sample;
    sample_init(&sample);
    expect_good(&sample);
    sample.position[3][1] = CAGE_MAX_COORDINATE;
    sample.crease[0].sharpness = 0;
    sample.crease[1].sharpness = 1e30f;
    expect_good(&sample);
    assert_true(cage_check(&sample.cage, NULL, NULL));
}

static void test_faces(void **state)
{
    (void)state;
    struct sample sample;
    sample_init(&sample);
    sample.vertex[6] = 6;
    expect_bad(&sample, "part: face 1 (counting from 0) has vertex 6 (counting from 0) at corner 3,"
                        " but there are 6 vertices");
    sample_init(&sample);
    sample.vertex[7] = 1; /* neighbours: the last corner and the first */
    expect_bad(&sample, "part: face 1 (counting from 0) has vertex 1 twice: give every corner its "
                        "own vertex");
    sample_init(&sample);
    sample.vertex[2] = 0; /* opposite corners */
    expect_bad(&sample, "part: face 0 (counting from 0) has vertex 0 twice: give every corner its "
                        "own vertex");
    sample_init(&sample);
    sample.start[1] = 2;
    expect_bad(&sample, "part: face 0 (counting from 0) has 2 corners, needs at least 3");
    sample_init(&sample);
    sample.start[1] = 7;
    expect_bad(&sample, "part: face 0 (counting from 0) has vertex 1 twice: give every corner its "
                        "own vertex");
    sample_init(&sample);
    sample.start[1] = 9; /* beyond the end of the corner list */
    expect_bad(&sample, "part: face 0 (counting from 0) has a broken corner list");
    sample_init(&sample);
    sample.cage.n_faces = 0;
    expect_bad(&sample, "part: no face at all (6 vertices): a cage needs at least one face");
}

static void test_counts(void **state)
{
    (void)state;
    struct sample sample;
    sample_init(&sample);
    sample.cage.n_vertices = (size_t)CAGE_MAX_VERTICES + 1;
    expect_bad(&sample, "part: 100000001 vertices, the most that is read is 100000000");
    sample_init(&sample);
    sample.cage.n_faces = (size_t)CAGE_MAX_FACES + 1;
    expect_bad(&sample, "part: 50000001 faces, the most that is read is 50000000");
    sample_init(&sample);
    sample.start[2] = CAGE_MAX_CORNERS + 1;
    expect_bad(&sample, "part: 400000001 face corners, the most that is read is 400000000");
}

static void test_coordinates(void **state)
{
    (void)state;
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    struct sample sample;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sample_init(&sample);
        sample.position[5][i] = bad[i];
        char text[100];
        snprintf(text, sizeof text,
                 "part: vertex 5 (counting from 0) has a coordinate %c that is not finite",
                 "xyz"[i]);
        expect_bad(&sample, text);
    }
    sample_init(&sample);
    sample.position[2][1] = -1e308;
    expect_bad(&sample, "part: vertex 2 (counting from 0) has coordinate y = -1e+308, beyond the "
                        "largest that is read, 1e+30");
}

static void test_tags(void **state)
{
    (void)state;
    struct sample sample;
    sample_init(&sample);
    sample.crease[1].vertex[1] = 6;
    expect_bad(&sample, "part: crease 1 (counting from 0) refers to vertex 6 (counting from 0), "
                        "but there are 6 vertices");
    sample_init(&sample);
    sample.crease[0].vertex[0] = 3; /* both exist, the edge does not */
    expect_bad(&sample, "part: crease 0 (counting from 0) joins vertices 3 and 1 (counting from "
                        "0), which no face has as an edge");
    sample_init(&sample);
    sample.crease[0].vertex[0] = 1;
    expect_bad(&sample,
               "part: crease 0 (counting from 0) joins vertex 1 (counting from 0) with itself");
    sample_init(&sample);
    sample.crease[0].sharpness = -1;
    expect_bad(&sample, "part: crease 0 (counting from 0) has sharpness -1, needs a number from 0");
    sample_init(&sample);
    sample.corner[0].sharpness = INFINITY;
    expect_bad(&sample,
               "part: corner 0 (counting from 0) has sharpness inf, needs a number from 0");
    sample_init(&sample);
    sample.corner[0].vertex = 6;
    expect_bad(&sample, "part: corner 0 (counting from 0) refers to vertex 6 (counting from 0), "
                        "but there are 6 vertices");
    sample_init(&sample);
    sample.hole[0] = 2;
    expect_bad(&sample, "part: hole 0 (counting from 0) refers to face 2 (counting from 0), but "
                        "there are 2 faces");
}

/* Every edge of a grid as a crease, more than once: the edge set must hold them all. */
static void test_many_creases(void **state)
{
    (void)state;
    enum { N = 40, V = (N + 1) * (N + 1), E = 2 * N * (N + 1) };
    double(*position)[3] = calloc(V, sizeof *position);
    uint32_t *start = calloc(N * N + 1, sizeof *start), *vertex = calloc(4 * N * N, sizeof *vertex);
    struct cage_crease *crease = calloc(2 * E, sizeof *crease);
    assert_true(position && start && vertex && crease);
    size_t n = 0;
    for (uint32_t f = 0; f < N * N; f++) {
        uint32_t a = f / N * (N + 1) + f % N;
        const uint32_t quad[4] = {a, a + 1, a + N + 2, a + N + 1};
        memcpy(&vertex[4 * f], quad, sizeof quad);
        start[f + 1] = 4 * f + 4;
        crease[n++] = (struct cage_crease){{a, a + 1}, 1};
        crease[n++] = (struct cage_crease){{a + N + 1, a}, 1};
        crease[n++] = (struct cage_crease){{a + 1, a}, 2};
    }
    struct cage cage = {.n_vertices = V,
                        .position = position,
                        .n_faces = N * N,
                        .face_start = start,
                        .face_vertex = vertex,
                        .n_creases = n,
                        .crease = crease};
    struct error error = {0};
    assert_true(cage_check(&cage, "grid", &error));
    crease[n - 1].vertex[0] = crease[n - 1].vertex[1] + N + 2; /* a diagonal */
    assert_false(cage_check(&cage, "grid", &error));
    assert_non_null(strstr(error.text, "which no face has as an edge"));
    free(position);
    free(start);
    free(vertex);
    free(crease);
}

static void test_warnings(void **state)
{
    (void)state;
    struct cage cage = {0};
    cage_warn(&cage, "first %d", 1);
    cage_warn(&cage, "second\nwith a newline\x1b[31m");
    assert_string_equal(cage.warnings, "first 1\nsecond?with a newline?[31m");
    for (int i = 0; i < 1000; i++)
        cage_warn(&cage, "warning %d that takes some room", i);
    size_t length = strlen(cage.warnings);
    assert_true(length < 4096 && length > 3900);
    assert_string_equal(strrchr(cage.warnings, '\n'), "\nmore warnings followed");
    cage_warn(&cage, "x");
    assert_int_equal(strlen(cage.warnings), length);
    cage_finish(&cage);
    assert_null(cage.warnings);
    cage_finish(&cage);
}

/* After a line that is longer than the whole buffer, the next short line must not be written beyond
 * the buffer's end. */
static void test_long_warning(void **state)
{
    (void)state;
    struct cage cage = {0};
    for (int i = 0; i < 20; i++)
        cage_warn(&cage, "%0400d", i);
    assert_string_equal(strrchr(cage.warnings, '\n'), "\nmore warnings followed");
    assert_true(strlen(cage.warnings) < 4096);
    cage_finish(&cage);
}

/* A kind that is found twice takes one entry of the array, so the array does not overflow. */
static void test_one_finding_of_a_kind(void **state)
{
    (void)state;
    struct cage cage = {0};
    for (int i = 0; i < 3 * N_CAGE_FINDINGS; i++) {
        const struct cage_finding finding = {(enum cage_finding_kind)(i / 3), 1 + (uint32_t)i, 0,
                                             CAGE_NO_FACE};
        cage_found(&cage, &finding, "part", "%d", i);
        cage_found(&cage, &finding, "part", "%d again", i);
    }
    assert_int_equal(cage.n_findings, N_CAGE_FINDINGS);
    for (uint32_t k = 0; k < N_CAGE_FINDINGS; k++) {
        assert_int_equal(cage.finding[k].kind, k);
        assert_int_equal(cage.finding[k].count, 1 + 3 * k);
    }
    assert_null(strstr(cage.warnings, "again"));
    assert_ptr_equal(strstr(cage.warnings, "part: 0\npart: 3\npart: 6\n"), cage.warnings);
    cage_finish(&cage);
}

static void test_choice_of_reader(void **state)
{
    (void)state;
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char *const names[] = {"a.obj", "A.OBJ", "upload", "a.txt", "", NULL};
    struct cage cage;
    struct error error = {0};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (!cage_read(&cage, obj, sizeof obj - 1, names[i], &error))
            fail_msg("%s", error.text);
        assert_int_equal(cage.n_faces, 1);
        cage_finish(&cage);
    }
    /* The file name's extension decides on the format; without a known extension the content
     * does. */
    assert_false(cage_read(&cage, obj, sizeof obj - 1, "a.gltf", &error));
    assert_non_null(strstr(error.text, "a.gltf: not a glTF file"));
    assert_false(cage_read(&cage, " \n{]", 4, "upload", &error));
    assert_non_null(strstr(error.text, "upload: not a glTF file"));
    assert_false(cage_read(&cage, "glTF", 4, "upload", &error));
    assert_non_null(strstr(error.text, "upload: truncated: a GLB has at least 20 bytes"));
    assert_false(cage_read(&cage, "{}", 2, "upload.obj", &error));
    assert_non_null(
        strstr(error.text, "upload.obj: is not an OBJ file: it has no vertex and no face"));
}

static void test_empty_and_long_names(void **state)
{
    (void)state;
    struct cage cage;
    struct error error = {0};
    static const char *const names[] = {"a.obj", "a.gltf", "a.glb", "a"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char text[64];
        assert_false(cage_read(&cage, "", 0, names[i], &error));
        assert_int_equal(error.kind, ERROR_MODEL);
        snprintf(text, sizeof text, "%s: the file is empty", names[i]);
        assert_string_equal(error.text, text);
        assert_null(cage.position);
    }
    char name[5000];
    memset(name, 'n', sizeof name);
    strcpy(name + sizeof name - 9, "part.obj");
    assert_false(cage_read(&cage, "v 1 2\n", 6, name, &error));
    assert_non_null(strstr(error.text, "part.obj:1: v has 2 coordinates, needs 3"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good),
        cmocka_unit_test(test_faces),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_coordinates),
        cmocka_unit_test(test_tags),
        cmocka_unit_test(test_many_creases),
        cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_long_warning),
        cmocka_unit_test(test_one_finding_of_a_kind),
        cmocka_unit_test(test_choice_of_reader),
        cmocka_unit_test(test_empty_and_long_names),
    };
    return cmocka_run_group_tests_name("cage/check", tests, NULL, NULL);
}
