/* Tangents of rings have one defining property: a step of subdivision multiplies them by an
 * eigenvalue, whatever the ring's points are. Also tests where the surface has a unique normal. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/cage/cage.h"
#include "server/surface/subdivision/refine.h"
#include "server/surface/subdivision/ring_limit.h"

static double noise(void)
{
    return 2 * (rand() / (double)RAND_MAX) - 1;
}

static struct vec rough_point(void)
{
    return (struct vec){noise(), noise(), noise()};
}

static struct ring rough_ring(struct arena *arena, uint32_t n_faces, bool closed)
{
    struct ring ring = ring_take(arena, n_faces, closed, false);
    ring.centre = rough_point();
    for (uint32_t k = 0; k < ring_edges(&ring); k++)
        ring.edge[k] = rough_point();
    for (uint32_t k = 0; k < n_faces; k++)
        ring.face[k] = rough_point();
    return ring;
}

static void assert_scaled(struct vec fine, double factor, struct vec coarse, uint32_t n_faces)
{
    double off = vec_length(vec_mad(fine, -factor, coarse));
    if (!(off < 1e-12 * (1 + vec_length(coarse))))
        fail_msg("%u faces: %g off", n_faces, off);
}

/* One step on random rings: the factors by which both tangents shrink. */
static void check_step(uint32_t n_faces, bool closed, double first, double second)
{
    struct arena arena;
    struct vec coarse[2], fine[2];
    assert_true(arena_init(&arena, 2 * ring_bytes(n_faces, false)));
    struct ring ring = rough_ring(&arena, n_faces, closed);
    struct ring out = ring_take(&arena, n_faces, closed, false);
    ring_refine(&ring, &out);
    ring_tangents(&ring, &coarse[0], &coarse[1]);
    ring_tangents(&out, &fine[0], &fine[1]);
    assert_scaled(fine[0], first, coarse[0], n_faces);
    assert_scaled(fine[1], second, coarse[1], n_faces);
    arena_finish(&arena);
}

static void test_tangents_are_eigenvectors(void **state)
{
    (void)state;
    const double pi = 3.14159265358979323846;
    srand(1);
    for (uint32_t n = 3; n <= 40; n++) {
        double l = ring_eigenvalue(2 * pi / n);
        check_step(n, true, l, l);
    }
    for (uint32_t n = 2; n <= 40; n++)
        check_step(n, false, ring_eigenvalue(pi / n), 0.5);
}

/* On a flat fan the tangents span the fan's plane, oriented by the winding. */
static void test_winding(void **state)
{
    (void)state;
    for (int closed = 0; closed < 2; closed++) {
        for (uint32_t n = closed ? 3 : 2; n <= 12; n++) {
            struct arena arena;
            struct vec t1, t2;
            assert_true(arena_init(&arena, ring_bytes(n, false)));
            struct ring ring = ring_take(&arena, n, closed, false);
            double step = (closed ? 6.283185307179586 : 3) / n;
            ring.centre = (struct vec){0, 0, 0};
            for (uint32_t k = 0; k < ring_edges(&ring); k++)
                ring.edge[k] = (struct vec){cos(k * step), sin(k * step), 0};
            for (uint32_t k = 0; k < n; k++)
                ring.face[k] =
                    vec_scale((struct vec){cos((k + 0.5) * step), sin((k + 0.5) * step), 0}, 1.5);
            ring_tangents(&ring, &t1, &t2);
            assert_true(vec_cross(t1, t2).z > 0);
            arena_finish(&arena);
        }
    }
}

static void test_one_normal(void **state)
{
    (void)state;
    for (uint32_t n = 1; n <= 12; n++) {
        struct ring ring = {.n_faces = n, .closed = false};
        assert_int_equal(ring_has_one_normal(&ring), n <= 3);
        ring.sharpness = CAGE_SHARPNESS_INFINITE;
        assert_int_equal(ring_has_one_normal(&ring), n == 1);
        ring.closed = true;
        assert_false(ring_has_one_normal(&ring));
        ring.sharpness = 0;
        assert_true(ring_has_one_normal(&ring));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tangents_are_eigenvectors),
        cmocka_unit_test(test_winding),
        cmocka_unit_test(test_one_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
