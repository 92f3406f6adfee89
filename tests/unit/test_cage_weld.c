/* cage_weld() alone: which coordinates count as the same position. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>

#include "server/cage/build/weld.h"

/* No reader returns NaN. NaN equals NaN here all the same: otherwise each NaN would be compared
 * with every earlier one. */
static void test_places(void **state)
{
    (void)state;
    static const double positions[][3] = {
        {0, 0, 0},   {-0.0, 0, -0.0}, {NAN, 0, 0},      {-NAN, 0, 0},      {0, NAN, 0},
        {NAN, 0, 0}, {0, 0, NAN},     {INFINITY, 0, 0}, {-INFINITY, 0, 0}, {INFINITY, -0.0, 0},
    };
    static const uint32_t welded[] = {0, 0, 1, 1, 2, 1, 3, 4, 5, 4};
    enum { N = sizeof positions / sizeof *positions };
    struct cage_builder builder = {0};
    struct error error = {0};
    struct weld_start start = weld_begin(&builder);
    for (uint32_t v = 0; v < N; v++) {
        assert_true(cage_builder_vertex(&builder, positions[v], &error));
        assert_true(cage_builder_face_vertex(&builder, v, &error));
    }
    assert_true(cage_weld(&builder, &start, "part.obj", &error));
    assert_int_equal(builder.cage.n_vertices, 6);
    assert_memory_equal(builder.cage.face_vertex, welded, sizeof welded);
    cage_builder_finish(&builder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places)};
    return cmocka_run_group_tests_name("cage/weld", tests, NULL, NULL);
}
