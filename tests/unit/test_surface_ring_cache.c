/* Rings of vertices with many faces. Each ring is made once for all quads around the vertex, and so
 * is what is computed from it. The tables' windows onto a ring give the same surface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/surface/subdivision/build.h"
#include "server/surface/subdivision/crease.h"
#include "server/surface/subdivision/ring_limit.h"
#include "server/surface/subdivision/settle.h"
#include "server/surface/evaluate.h"
#include "server/surface/subdivision/extract.h"
#include "server/surface/subdivision/dart_mask_list.h"
#include "server/surface/subdivision/plan.h"

enum { N = 150 }; /* faces: more than a window of a table has */

struct fan {
    struct cage cage;
    struct limit_plan *plan;
    struct ring_cache rings;
    struct arena arena;
};

static void fan_read(struct fan *fan, const char *text, size_t size)
{
    struct error error = {0};
    if (!cage_read(&fan->cage, text, size, "fan.obj", &error))
        fail_msg("%s", error.text);
    fan->plan = limit_plan_create(&fan->cage, NULL, &error);
    if (!fan->plan)
        fail_msg("%s", error.text);
    ring_cache_init(&fan->rings, fan->cage.face_start[fan->cage.n_faces]);
    assert_true(arena_init(&fan->arena, fan->plan->arena_bytes));
}

/* Quads around vertex 0, closed or open, with random heights; tags are lines of an OBJ. */
static void fan_init_of(struct fan *fan, int n_faces, bool closed, const char *tags)
{
    static char text[1 << 16];
    const int n_rim = 2 * n_faces + !closed;
    int used = snprintf(text, sizeof text, "v 0 0 0.4\n");
    for (int k = 0; k < n_rim; k++) {
        double angle = 6.2 * k / n_rim, radius = k % 2 ? 1.3 : 1;
        used += snprintf(text + used, sizeof text - (size_t)used, "v %.9f %.9f %.9f\n",
                         radius * cos(angle), radius * sin(angle), 0.02 * (k * k % 7));
    }
    for (int k = 0; k < n_faces; k++)
        used += snprintf(text + used, sizeof text - (size_t)used, "f 1 %d %d %d\n", 2 + 2 * k,
                         3 + 2 * k, 2 + (2 * k + 2) % n_rim);
    used += snprintf(text + used, sizeof text - (size_t)used, "%s", tags);
    fan_read(fan, text, (size_t)used);
}

static void fan_init(struct fan *fan, bool closed, const char *tags)
{
    fan_init_of(fan, N, closed, tags);
}

static void fan_finish(struct fan *fan)
{
    arena_finish(&fan->arena);
    ring_cache_finish(&fan->rings);
    limit_plan_destroy(fan->plan);
    cage_finish(&fan->cage);
}

/* Expects that all quads around the vertex, and their refinements, hold the same ring and no
 * copies. */
static void assert_made_once(bool closed, const char *tags, int n_sectors)
{
    enum { DEPTH = 3 };
    struct fan fan;
    fan_init(&fan, closed, tags);
    const struct vec *last[DEPTH] = {NULL};
    int n_changes = 0;
    for (uint32_t face = 0; face < N; face++) {
        fan.arena.used = 0;
        struct quad quad = extract_quad(&fan.plan->topology, 4 * face, &fan.rings, &fan.arena);
        for (int depth = 0; depth < DEPTH; depth++) {
            const struct ring *ring = &quad.corner[0];
            assert_true(ring->n_faces >= RING_CACHE_MIN_FACES);
            n_changes += depth == 0 && ring->edge != last[0];
            if (n_sectors == 1 && face > 0)
                assert_ptr_equal(ring->edge, last[depth]);
            last[depth] = ring->edge;
            struct vec next = ring_edge(ring, 0);
            assert_memory_equal(&next, &quad.corner[1].centre, sizeof next);
            struct quad child[4];
            quad_refine(&quad, &fan.arena, child);
            quad = child[0];
        }
    }
    assert_int_equal(n_changes, n_sectors);
    fan_finish(&fan);
}

static void test_made_once(void **state)
{
    (void)state;
    assert_made_once(true, "", 1);
    assert_made_once(false, "", 1);
    assert_made_once(true, "t corner 1/1/0 0 10\n", 1);
    assert_made_once(true, "t crease 2/1/0 0 1 3.5\n", 1);
    assert_made_once(true, "t crease 2/1/0 0 1 10\nt crease 2/1/0 0 61 10\n", 2);
    /* three sectors' rings: one sector is refined twice */
    assert_made_once(true, "t crease 2/1/0 0 21 10\nt crease 2/1/0 0 61 10\n", 3);
    assert_made_once(false, "t crease 2/1/0 0 61 10\n", 2);
}

/* The quads of a face with many corners share the face's ring, whichever corner they have. */
static void test_face(void **state)
{
    (void)state;
    enum { CORNERS = 12 };
    char text[2000];
    int used = 0;
    for (int k = 0; k < CORNERS; k++)
        used += sprintf(text + used, "v %.9f %.9f %d\n", cos(k * 0.5), sin(k * 0.5), k % 3);
    used += sprintf(text + used, "f");
    for (int k = 0; k < CORNERS; k++)
        used += sprintf(text + used, " %d", k + 1);
    struct fan fan;
    fan_read(&fan, text, (size_t)used);
    const struct vec *first = NULL;
    for (uint32_t c = 0; c < CORNERS; c++) {
        struct quad quad = extract_refined_quad(&fan.plan->topology, &fan.plan->refined, c,
                                                &fan.rings, &fan.arena);
        const struct ring *ring = &quad.corner[2];
        first = c ? first : ring->edge;
        assert_ptr_equal(ring->edge, first);
        const struct vec seen[3] = {ring_face(ring, 0), ring_edge(ring, 0), ring_edge(ring, 1)};
        assert_memory_equal(&seen[0], &quad.corner[0].centre, sizeof seen[0]);
        assert_memory_equal(&seen[1], &quad.corner[3].centre, sizeof seen[1]);
        assert_memory_equal(&seen[2], &quad.corner[1].centre, sizeof seen[2]);
        fan.arena.used = 0;
    }
    fan_finish(&fan);
}

/* Expects that the table's S(2^-k, 2^-k) equals that of the quarter at corner 0, refined k times
 * with whole rings. */
static void assert_table_right(struct fan *fan, const struct limit_tables *tables, uint32_t face)
{
    fan->arena.used = 0;
    struct quad quad = extract_quad(&fan->plan->topology, 4 * face, &fan->rings, &fan->arena);
    for (int k = 1; k <= 6; k++) {
        struct quad child[4];
        quad_refine(&quad, &fan->arena, child);
        quad = child[0];
        struct limit_point p;
        struct vec truth = ring_limit(&quad.corner[2]);
        assert_true(limit_evaluate(tables, face, ldexp(1, -k), ldexp(1, -k), &p));
        double off = vec_length(vec_sub(p.s, truth));
        if (!(off < 1e-6))
            fail_msg("face %u, step %d: %g off", face, k, off);
    }
}

static void test_windows(void **state)
{
    (void)state;
    static const char *const tags[] = {"", "t corner 1/1/0 0 10\n",
                                       "t crease 2/1/0 0 1 10\nt crease 2/1/0 0 201 10\n"};
    static const uint32_t faces[] = {0, 1, 20, 44, 70, 104, 105, 106, 107, 130, N - 2, N - 1};
    for (int closed = 0; closed < 2; closed++) {
        for (size_t i = 0; i < sizeof tags / sizeof tags[0]; i++) {
            struct fan fan;
            struct limit_tables tables;
            struct error error = {0};
            fan_init(&fan, closed, tags[i]);
            assert_true(limit_tables_init(&tables, limit_plan_size(fan.plan), &error));
            assert_true(limit_build_faces(&tables, fan.plan, 0, N, NULL, &error));
            for (size_t k = 0; k < sizeof faces / sizeof faces[0]; k++)
                assert_table_right(&fan, &tables, faces[k]);
            limit_tables_finish(&tables);
            fan_finish(&fan);
        }
    }
}

/* The modes of a dart depend on the number of faces only. They are computed once and rotated to the
 * dart's edge. */
static void test_masks(void **state)
{
    (void)state;
    enum { FACES = 12, POINTS = 2 * FACES + 1 };
    struct dart_masks own, found;
    struct dart_mask_list *known = NULL;
    struct arena arena;
    assert_true(arena_init(&arena, 1 << 16));
    for (uint32_t i = 0; i < 3; i++) {
        struct ring ring = ring_take(&arena, FACES, true, true);
        const struct dart_mask_list *newest = known;
        ring.creases.edge[i == 2 ? 7 : i] = CAGE_SHARPNESS_INFINITE;
        dart_mask_list_add(&known, &ring, &arena);
        assert_int_equal(known != newest, i == 0);
        dart_mask_list_find(known, &ring, &arena, &found);
        dart_masks_find(&own, &ring, &arena);
        for (int k = 0; k < POINTS; k++) {
            assert_float_equal(found.position[k], own.position[k], 1e-12);
            assert_float_equal(fabs(found.tangent[0][k]), fabs(own.tangent[0][k]), 1e-9);
            assert_float_equal(fabs(found.tangent[1][k]), fabs(own.tangent[1][k]), 1e-9);
        }
    }
    dart_mask_list_finish(&known);
    arena_finish(&arena);
}

/* The plan of a cage lists the masks of darts; sharp vertices need none. */
static void test_plan_lists_masks(void **state)
{
    (void)state;
    struct fan fan;
    fan_init_of(&fan, 20, true, "t crease 2/1/0 0 1 10\n");
    assert_non_null(fan.plan->darts);
    assert_int_equal(fan.plan->darts->n_faces, 20);
    assert_null(fan.plan->darts->older);
    fan_finish(&fan);
    fan_init_of(&fan, 20, true, "t crease 2/1/0 0 1 10\nt corner 1/1/0 0 10\n");
    assert_null(fan.plan->darts);
    fan_finish(&fan);
}

/* With Chaikin's rule every edge depends on all edges around the vertex. Their sum is computed once
 * for each vertex, and equals the sum over the ring. */
static void test_chaikin(void **state)
{
    (void)state;
    struct fan fan;
    fan_init(&fan, true,
             "t creasemethod 0/0/1 chaikin\nt crease 2/1/0 0 1 3.5\nt crease 2/1/0 0 41 2.25\n"
             "t crease 2/1/0 0 101 1.5\nt crease 2/1/0 101 102 4\n");
    const struct topology *t = &fan.plan->topology;
    const float mean = (2.25f + 1.5f) / 2;
    struct quad quad = extract_quad(t, 0, &fan.rings, &fan.arena);
    assert_float_equal(t->child_sharpness[0], 0.75f * 3.5f + 0.25f * mean - 1, 1e-6);
    for (uint32_t face = 0; face < N; face++) {
        assert_true(t->child_sharpness[4 * face] == crease_child(&quad.corner[0], face));
        assert_true(t->child_sharpness[4 * face + 1] >= 0);
    }
    /* the boundary of the fan */
    assert_true(t->child_sharpness[4 * 50 + 1] == CAGE_SHARPNESS_INFINITE);
    fan_finish(&fan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_made_once),        cmocka_unit_test(test_face),
        cmocka_unit_test(test_windows),          cmocka_unit_test(test_masks),
        cmocka_unit_test(test_plan_lists_masks), cmocka_unit_test(test_chaikin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
