/* Counts of cages whose numbers are known by hand. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/cage/statistics.h"

static struct cage_statistics statistics_of(const char *obj)
{
    struct cage cage;
    struct cage_statistics statistics;
    struct error error = {0};
    if (!cage_read(&cage, obj, strlen(obj), "test.obj", &error) ||
        !cage_statistics(&cage, &statistics, &error))
        fail_msg("%s", error.text);
    cage_finish(&cage);
    return statistics;
}

static void test_cube(void **state)
{
    (void)state;
    struct cage_statistics s =
        statistics_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    assert_int_equal(s.n_quads, 6);
    assert_int_equal(s.n_triangles + s.n_ngons, 0);
    assert_int_equal(s.n_boundary_edges, 0);
    assert_int_equal(s.n_boundary_extraordinary, 0);
    assert_int_equal(s.n_valences, 1);
    assert_int_equal(s.extraordinary[0].valence, 3);
    assert_int_equal(s.extraordinary[0].count, 8);
}

static void test_sheet(void **state)
{
    (void)state;
    /* 2 by 2 quads and a triangle and a pentagon on its right; vertex 10 belongs to no face. */
    struct cage_statistics s = statistics_of(
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2 0\nv 2 2 0\n"
        "v 9 9 9\nv 3 0 0\nv 3 1 0\nv 3 2 0\nv 4 1 0\n"
        "f 1 2 5 4\nf 2 3 6 5\nf 4 5 8 7\nf 5 6 9 8\nf 3 11 6\nf 6 11 14 13 9\n");
    assert_int_equal(s.n_quads, 4);
    assert_int_equal(s.n_triangles, 1);
    assert_int_equal(s.n_ngons, 1);
    /* eight edges of the sheet, less two at its right side, and 3-11, 11-14, 14-13 and 13-9 */
    assert_int_equal(s.n_boundary_edges, 10);
    /* corners 1, 7, 13 and 14; 3, 9 and 11 have two faces and are regular */
    assert_int_equal(s.n_boundary_extraordinary, 4);
    assert_int_equal(s.n_valences, 0); /* vertices 5 and 6 have valence 4 */
}

/* A fan of n triangles around one vertex, for n = 3 .. 3 + count - 1, side by side. */
static void test_more_valences_than_entries(void **state)
{
    (void)state;
    enum { LAST = CAGE_MAX_VALENCES + 10 };
    size_t capacity = 1 << 20, used = 0;
    char *obj = malloc(capacity);
    assert_non_null(obj);
    for (int n = 3, vertex = 1; n <= LAST; vertex += n + 1, n++) {
        for (int i = 0; i <= n; i++)
            used += (size_t)snprintf(obj + used, capacity - used, "v %d %d 0\n", n, i);
        for (int i = 0; i < n; i++)
            used += (size_t)snprintf(obj + used, capacity - used, "f %d %d %d\n", vertex,
                                     vertex + 1 + i, vertex + 1 + (i + 1) % n);
    }
    struct cage_statistics s = statistics_of(obj);
    free(obj);
    assert_int_equal(s.n_valences, CAGE_MAX_VALENCES);
    assert_int_equal(s.extraordinary[0].valence, 3);
    assert_int_equal(s.extraordinary[1].valence, 5);
    assert_int_equal(s.extraordinary[1].count, 1);
    unsigned sum = 0;
    for (uint32_t i = 0; i < s.n_valences; i++)
        sum += s.extraordinary[i].count;
    assert_int_equal(sum, LAST - 3); /* 3 to LAST without 4 */
    assert_int_equal(s.extraordinary[CAGE_MAX_VALENCES - 1].count, 10 - 3 + 1);
}

#define CUBE                                                                                       \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"                     \
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"

static void test_tags(void **state)
{
    (void)state;
    /* The edge 1-2 is tagged twice, in opposite directions: the later tag counts. The edges 5-6 and
     * 6-7 are semi-sharp. */
    struct cage_statistics s = statistics_of(CUBE "t crease 2/1/0 0 1 10\n"
                                                  "t crease 2/1/0 1 0 2.5\n"
                                                  "t crease 2/1/0 4 5 1\n"
                                                  "t crease 2/1/0 5 6 0.5\n"
                                                  "t crease 2/1/0 2 3 10\n"
                                                  "t crease 2/1/0 6 7 0\n"
                                                  "t corner 1/1/0 7 10\n"
                                                  "t corner 1/1/0 7 3\n"
                                                  "t corner 1/1/0 6 1.5\n"
                                                  "t corner 1/1/0 5 0\n"
                                                  "t hole 1/0/0 2\n"
                                                  "t hole 1/0/0 2\n");
    assert_int_equal(s.n_sharp_edges, 1);
    assert_int_equal(s.n_semisharp_edges, 3);
    assert_int_equal(s.n_sharp_vertices, 2);
    assert_int_equal(s.n_holes, 1);
    assert_int_equal(s.n_nonmanifold_edges, 0);
    assert_int_equal(s.n_nonmanifold_vertices, 0);
}

static void test_non_manifold(void **state)
{
    (void)state;
    /* A fin on the edge 1-2 of a cube. */
    struct cage_statistics s = statistics_of(CUBE "v 0 -1 -1\nv 1 -1 -1\nf 1 2 10 9\n");
    assert_int_equal(s.n_nonmanifold_edges, 1);
    assert_int_equal(s.n_nonmanifold_vertices, 2);
    assert_int_equal(s.n_boundary_edges, 3);
    /* Two sheets that touch in a vertex: every edge is manifold, the vertex is not. */
    s = statistics_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0 0\nv -1 -1 0\nv 0 -1 0\n"
                      "f 1 2 3 4\nf 1 5 6 7\n");
    assert_int_equal(s.n_nonmanifold_edges, 0);
    assert_int_equal(s.n_nonmanifold_vertices, 1);
    /* Two closed tetrahedra that touch in vertex 1. */
    s = statistics_of("v 0 0 0\nv 1 0 1\nv 0 1 1\nv -1 -1 1\nv 1 0 -1\nv 0 1 -1\nv -1 -1 -1\n"
                      "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 4 3 2\nf 1 6 5\nf 1 7 6\nf 1 5 7\nf 5 6 7\n");
    assert_int_equal(s.n_nonmanifold_edges, 0);
    assert_int_equal(s.n_boundary_edges, 0);
    assert_int_equal(s.n_nonmanifold_vertices, 1);
    /* Two faces that have the edge 1-2 in the same direction. */
    s = statistics_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 -1 0\nv 0 -1 0\n"
                      "f 1 2 3 4\nf 1 2 5 6\n");
    assert_int_equal(s.n_nonmanifold_edges, 1);
    assert_int_equal(s.n_nonmanifold_vertices, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_sheet),
        cmocka_unit_test(test_more_valences_than_entries),
        cmocka_unit_test(test_tags),
        cmocka_unit_test(test_non_manifold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
