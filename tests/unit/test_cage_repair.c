/* A damaged element of a file costs that element and one warning of its kind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/cage_expect.h"

/* Lines 1 to 6: vertices 0 to 5, 0 1 2 below 3 4 5. */
#define SIX "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
#define KEYHOLE_TEXT                                                                               \
    "a face with a vertex at corners that are no neighbours (a keyhole: split it) is ignored"

static void expect_finding(const struct cage *cage, size_t i, enum cage_finding_kind kind,
                           uint32_t count, uint32_t line)
{
    assert_true(i < cage->n_findings);
    assert_int_equal(cage->finding[i].kind, kind);
    assert_int_equal(cage->finding[i].count, count);
    assert_int_equal(cage->finding[i].line, line);
    assert_int_equal(cage->finding[i].face, CAGE_NO_FACE);
}

/* A repeated corner is removed anywhere in the face, also if the last corner repeats the first. */
static void test_repeated_corners(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, SIX "f 1 2 5 4\nf 2 2 3 6\nf 2 3 6 6 5\nf 1 2 5 1\nf 3 6 6 6 6 5 3 3\n");
    assert_int_equal(cage.n_faces, 5);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 5);
    EXPECT_FACE(&cage, 2, 1, 2, 5, 4);
    EXPECT_FACE(&cage, 3, 0, 1, 4);
    EXPECT_FACE(&cage, 4, 2, 5, 4);
    expect_finding(&cage, 0, CAGE_FOUND_REPEATED_CORNER, 4, 8);
    assert_memory_equal(cage.warnings,
                        "part.obj:8: a face names a vertex twice in a row: the second is dropped; "
                        "4 in all, this is "
                        "the first",
                        97);
    cage_finish(&cage);
}

static void test_faces_passed_over(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, SIX "f 2 5\nf 1 2 5 4\nf 4 4 5 4\nf\nf 2 3 6 2 5\nf 2 3 6 5\n");
    assert_int_equal(cage.n_faces, 2);
    EXPECT_FACE(&cage, 0, 0, 1, 4, 3);
    EXPECT_FACE(&cage, 1, 1, 2, 5, 4);
    assert_int_equal(cage.n_findings, 2);
    expect_finding(&cage, 0, CAGE_FOUND_FEW_CORNERS, 3, 7);
    expect_finding(&cage, 1, CAGE_FOUND_KEYHOLE, 1, 11);
    assert_string_equal(cage.warnings,
                        "part.obj:7: a face with fewer than 3 different corners is ignored; 3 "
                        "in all, this is the first\n"
                        "part.obj:11: " KEYHOLE_TEXT);
    cage_finish(&cage);
}

/* Holes name faces by their numbers in the file, which count dropped faces as well. */
static void test_tags_after_faces_passed_over(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, "f 1 2\n" SIX "f 1 2 5 4\nf 1 1 1\nf 2 3 6 5\nf 3 2 1\n"
                    "t hole 1/0/0 3\nt hole 3/0/0 2 0 1\nt crease 2/1/0 2 5 3\n"
                    "t crease 4/2/0 0 1 1 4 1 2\n");
    assert_int_equal(cage.n_faces, 3);
    assert_int_equal(cage.n_holes, 2);
    assert_int_equal(cage.hole[0], 1);
    assert_int_equal(cage.hole[1], 0);
    assert_int_equal(cage.n_creases, 3);
    assert_int_equal(cage.n_findings, 1);
    expect_finding(&cage, 0, CAGE_FOUND_FEW_CORNERS, 2, 1);
    cage_finish(&cage);
}

static void test_tags_without_element(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, SIX "f 1 2 5 4\nf 2 3 6 5\nf 3 6\n"
                        "t crease 8/4/0 0 1 0 4 1 4 0 2 1 2 3 4\nt crease 2/1/0 5 5 1\n"
                        "t crease 2/1/0 6 1 1\nt crease 2/1/0 1 -1 1\n"
                        "t crease 2/1/0 1 99999999999999999999 1\nt crease 2/1/0 0 0 1\n"
                        "t corner 4/4/0 5 6 -7 2 1 2 3 4\nt hole 4/0/0 3 1 -1 2\n");
    assert_int_equal(cage.n_creases, 2);
    assert_int_equal(cage.crease[1].vertex[1], 4);
    assert_true(cage.crease[1].sharpness == 3);
    assert_int_equal(cage.n_corners, 2);
    assert_int_equal(cage.corner[1].vertex, 2);
    assert_true(cage.corner[1].sharpness == 4);
    assert_int_equal(cage.n_holes, 1);
    assert_int_equal(cage.hole[0], 1);
    assert_int_equal(cage.n_findings, 4);
    expect_finding(&cage, 0, CAGE_FOUND_FEW_CORNERS, 1, 9);
    expect_finding(&cage, 1, CAGE_FOUND_CREASE, 7, 10);
    expect_finding(&cage, 2, CAGE_FOUND_CORNER, 2, 16);
    expect_finding(&cage, 3, CAGE_FOUND_HOLE, 2, 17);
    assert_string_equal(
        cage.warnings,
        "part.obj:9: a face with fewer than 3 different corners is ignored\n"
        "part.obj:10: a crease whose vertices share no edge is ignored; 7 in all, this "
        "is the first\n"
        "part.obj:16: a corner tag of a vertex that does not exist is ignored; 2 in "
        "all, this is the first\n"
        "part.obj:17: a hole of a face that does not exist is ignored; 2 in all, this "
        "is the first");
    cage_finish(&cage);
}

/* Two squares side by side, each with its own vertices, lines 1 to 10. */
#define APART                                                                                      \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 -0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\n"                    \
    "f 1 2 3 4\nf 5 6 7 8\n"

/* The tag may stand anywhere in the file and applies to all of it. Tags refer to the welded
 * vertices. */
static void test_weld(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "t weld 0/0/0\n" APART "t crease 2/1/0 4 7 2\nt corner 1/1/0 7 3\nt hole 1/0/0 1\n",
        APART "t crease 2/1/0 1 2 2\nt corner 1/1/0 2 3\nt hole 1/0/0 1\n\\\n\nt weld 0/0/0\n",
    };
    for (size_t i = 0; i < 2; i++) {
        struct cage cage;
        read_obj(&cage, texts[i]);
        assert_int_equal(cage.n_vertices, 6);
        EXPECT_FACE(&cage, 0, 0, 1, 2, 3);
        EXPECT_FACE(&cage, 1, 1, 4, 5, 2);
        assert_int_equal(cage.n_creases, 1);
        assert_int_equal(cage.crease[0].vertex[0] + cage.crease[0].vertex[1], 3);
        assert_int_equal(cage.corner[0].vertex, 2);
        assert_int_equal(cage.hole[0], 1);
        assert_null(cage.warnings);
        cage_finish(&cage);
    }
}

/* Corners that coincide by welding are treated like corners that the file itself repeats. */
static void test_weld_of_damage(void **state)
{
    (void)state;
    struct cage cage;
    read_obj(&cage, APART "v 1 0 0\nv 2 0 0\nv 2 1 0\nf 2 9 6 7 3\nf 2 5 9\nf 2 6 9 7 3\nf\nf 2 5\n"
                          "f 1 2 7\nt hole 2/0/0 7 2\nt crease 4/2/0 1 99 1 4 1 2\nt weld 0/0/0\n");
    assert_int_equal(cage.n_vertices, 6);
    assert_int_equal(cage.n_faces, 4);
    EXPECT_FACE(&cage, 2, 1, 4, 5, 2);
    EXPECT_FACE(&cage, 3, 0, 1, 5);
    assert_int_equal(cage.n_holes, 2);
    assert_int_equal(cage.hole[0], 3);
    assert_int_equal(cage.hole[1], 2);
    assert_int_equal(cage.n_creases, 0);
    cage_finish(&cage);
    struct error error = {0};
    static const char bad[] = APART "t weld 1/0/0 1\n";
    assert_false(cage_read(&cage, bad, sizeof bad - 1, "part.obj", &error));
    assert_string_equal(error.text, "part.obj:11: t weld needs nothing, 0/0/0");
}

/* --- random faces and tags, against the rules applied one by one */

enum { VERTICES = 7, MOST_FACES = 12, MOST_CORNERS = 6, MOST_TAGS = 10 };

struct sketch {
    int n_faces, n_tags;
    int n_corners[MOST_FACES], vertex[MOST_FACES][MOST_CORNERS];
    int tag[MOST_TAGS][3]; /* kind: 0 crease, 1 corner, 2 hole; and what it names */
};

static int below(uint32_t *random, int n)
{
    *random = *random * 1664525 + 1013904223;
    return (int)((*random >> 8) % (uint32_t)n);
}

static void sketch_init(struct sketch *sketch, uint32_t *random)
{
    sketch->n_faces = 1 + below(random, MOST_FACES);
    sketch->n_tags = below(random, MOST_TAGS + 1);
    for (int f = 0; f < sketch->n_faces; f++) {
        sketch->n_corners[f] = below(random, MOST_CORNERS + 1);
        for (int c = 0; c < sketch->n_corners[f]; c++)
            sketch->vertex[f][c] = below(random, VERTICES);
    }
    for (int t = 0; t < sketch->n_tags; t++) {
        sketch->tag[t][0] = below(random, 3);
        int n = sketch->tag[t][0] == 2 ? sketch->n_faces : VERTICES;
        for (int k = 1; k < 3; k++)
            sketch->tag[t][k] = below(random, n + 2);
    }
}

static void write_text(const struct sketch *sketch, char *text, size_t size)
{
    size_t used = 0;
    for (int v = 0; v < VERTICES; v++)
        used += (size_t)snprintf(text + used, size - used, "v %d %d 0\n", v, v * v);
    for (int f = 0; f < sketch->n_faces; f++) {
        used += (size_t)snprintf(text + used, size - used, "f");
        for (int c = 0; c < sketch->n_corners[f]; c++)
            used += (size_t)snprintf(text + used, size - used, " %d", sketch->vertex[f][c] + 1);
        used += (size_t)snprintf(text + used, size - used, "\n");
    }
    for (int t = 0; t < sketch->n_tags; t++) {
        const int *tag = sketch->tag[t];
        if (tag[0] == 0)
            used += (size_t)snprintf(text + used, size - used, "t crease 2/1/0 %d %d 1\n", tag[1],
                                     tag[2]);
        else if (tag[0] == 1)
            used += (size_t)snprintf(text + used, size - used, "t corner 1/1/0 %d 1\n", tag[1]);
        else
            used += (size_t)snprintf(text + used, size - used, "t hole 1/0/0 %d\n", tag[1]);
    }
}

/* Writes the repaired face: without corners that equal the one before them, where the last corner
 * is before the first. */
static int expected_face(const struct sketch *sketch, int f, uint32_t *vertex,
                         enum cage_finding_kind *kind)
{
    int n = sketch->n_corners[f], kept = 0;
    bool twice = false;
    for (int c = 0; c < n; c++)
        if (sketch->vertex[f][c] != sketch->vertex[f][(c + n - 1) % n])
            vertex[kept++] = (uint32_t)sketch->vertex[f][c];
    for (int a = 0; a < kept; a++)
        for (int b = 0; b < a; b++)
            twice |= vertex[a] == vertex[b];
    *kind = kept < 3   ? CAGE_FOUND_FEW_CORNERS
            : twice    ? CAGE_FOUND_KEYHOLE
            : kept < n ? CAGE_FOUND_REPEATED_CORNER
                       : N_CAGE_FINDINGS;
    return kept < 3 || twice ? 0 : kept;
}

/* Returns whether the vertices are neighbours in some face that is kept. */
static bool is_edge(const struct sketch *sketch, int a, int b)
{
    for (int f = 0; f < sketch->n_faces; f++) {
        uint32_t vertex[MOST_CORNERS];
        enum cage_finding_kind kind;
        int n = expected_face(sketch, f, vertex, &kind);
        for (int c = 0; c < n; c++) {
            int p = (int)vertex[c], q = (int)vertex[(c + 1) % n];
            if ((p == a && q == b) || (p == b && q == a))
                return true;
        }
    }
    return false;
}

static void expect_ring(const uint32_t *rotated, const uint32_t *vertex, int n)
{
    int turn = 0;
    while (turn < n && rotated[turn] != vertex[0])
        turn++;
    for (int c = 0; c < n; c++)
        assert_int_equal(rotated[(turn + c) % n], vertex[c]);
}

/* Returns how many faces are kept, and counts the findings of each kind in count[]. */
static int check_faces(const struct sketch *sketch, const struct cage *cage, int *face_map,
                       uint32_t *count)
{
    int kept = 0;
    for (int f = 0; f < sketch->n_faces; f++) {
        uint32_t vertex[MOST_CORNERS];
        enum cage_finding_kind kind;
        int n = expected_face(sketch, f, vertex, &kind);
        if (kind < N_CAGE_FINDINGS)
            count[kind]++;
        face_map[f] = n ? kept : -1;
        if (n == 0)
            continue;
        if (cage) {
            assert_int_equal(cage->face_start[kept + 1] - cage->face_start[kept], n);
            expect_ring(&cage->face_vertex[cage->face_start[kept]], vertex, n);
        }
        kept++;
    }
    return kept;
}

static void check_tags(const struct sketch *sketch, const struct cage *cage, const int *face_map,
                       uint32_t *count)
{
    size_t creases = 0, corners = 0, holes = 0;
    for (int t = 0; t < sketch->n_tags; t++) {
        const int *tag = sketch->tag[t];
        if (tag[0] == 0 && is_edge(sketch, tag[1], tag[2])) {
            assert_int_equal(cage->crease[creases].vertex[0], tag[1]);
            assert_int_equal(cage->crease[creases++].vertex[1], tag[2]);
        } else if (tag[0] == 0) {
            count[CAGE_FOUND_CREASE]++;
        } else if (tag[0] == 1 && tag[1] < VERTICES) {
            assert_int_equal(cage->corner[corners++].vertex, tag[1]);
        } else if (tag[0] == 1) {
            count[CAGE_FOUND_CORNER]++;
        } else if (tag[1] >= sketch->n_faces) {
            count[CAGE_FOUND_HOLE]++;
        } else if (face_map[tag[1]] >= 0) {
            assert_int_equal(cage->hole[holes++], face_map[tag[1]]);
        }
    }
    assert_int_equal(cage->n_creases, creases);
    assert_int_equal(cage->n_corners, corners);
    assert_int_equal(cage->n_holes, holes);
}

static void test_random(void **state)
{
    (void)state;
    uint32_t random = 1;
    size_t n_read = 0, n_refused = 0;
    for (int round = 0; round < 20000; round++) {
        struct sketch sketch;
        char text[2000];
        struct cage cage;
        struct error error = {0};
        int face_map[MOST_FACES];
        uint32_t count[N_CAGE_FINDINGS] = {0};
        sketch_init(&sketch, &random);
        write_text(&sketch, text, sizeof text);
        if (!cage_read(&cage, text, strlen(text), "part.obj", &error)) {
            assert_int_equal(check_faces(&sketch, NULL, face_map, count), 0);
            assert_non_null(strstr(error.text, "can be drawn; this is a face with"));
            n_refused++;
            continue;
        }
        assert_int_equal(check_faces(&sketch, &cage, face_map, count), cage.n_faces);
        check_tags(&sketch, &cage, face_map, count);
        uint32_t found[N_CAGE_FINDINGS] = {0};
        for (size_t i = 0; i < cage.n_findings; i++)
            found[cage.finding[i].kind] = cage.finding[i].count;
        for (int kind = 0; kind <= CAGE_FOUND_HOLE; kind++)
            assert_int_equal(found[kind], count[kind]);
        n_read++;
        cage_finish(&cage);
    }
    print_message("%zu read, %zu refused\n", n_read, n_refused);
    assert_true(n_read > 10000 && n_refused > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repeated_corners),
        cmocka_unit_test(test_faces_passed_over),
        cmocka_unit_test(test_tags_after_faces_passed_over),
        cmocka_unit_test(test_tags_without_element),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_weld_of_damage),
        cmocka_unit_test(test_random),
    };
    return cmocka_run_group_tests_name("cage/repair", tests, NULL, NULL);
}
