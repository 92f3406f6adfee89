/* Where lines break, against closed forms: folds of known angle, darts, semi-sharp creases, vertices; and the work as a
 * whole, its order, memory and end. Joints and lines are judged by test_curves_joints.c, random cages by
 * tests/oracle/test_breaks.cpp. */
#include <malloc.h>
#include <string.h>

#include "server/surface/evaluate.h"
#include "tests/unit/break_cages.h"

/* --- creases */

static void a_fold_has_its_angle(void **state)
{
    (void)state;
    const double angles[] = {1e-3, 0.02, 0.5, 1.5, 2.9};
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
        struct limit_tables tables;
        build_fold(angles[i], 3, 3, 10, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 3);
        assert_int_equal(result.counts.creases, 3);
        for (size_t k = 0; k < 3; k++) {
            double degrees = angles[i] * 180 / 3.14159265358979323846;
            double relative =
                i == 0 ? 2e-4 : 1e-6; /* single precision of the points: 1e-5 degrees */
            assert_true(fabs(worst(&result, k, BREAK_ANGLE)->value / degrees - 1) < relative);
            assert_true(worst(&result, k, BREAK_GAP)->value < 1e-7);
            assert_true(worst(&result, k, BREAK_PERCENT)->value < 0.2);
            bool is_over = degrees > LIMITS.angle_deg;
            assert_int_equal(result.edges[k].over, is_over << BREAK_ANGLE);
            assert_true(fabs(result.edges[k].out_length - is_over * result.edges[k].length) < 1e-9);
        }
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* Without a crease a sheet is smooth, and nothing is measured. */
static void a_smooth_sheet_has_no_edges(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.5, 3, 0, 0, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 0);
    assert_int_equal(result.counts.borders, 14);
    assert_int_equal(result.n_vertices, 4); /* its corners, where the border is round */
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* At the end of a crease the angle falls to 0; the crease's other edges do not end there. */
static void a_dart_ends_a_crease(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.5, 4, 2, 10, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 2);
    size_t dart = result.edges[0].has_dart ? 0 : 1, other = 1 - dart;
    assert_true(result.edges[dart].has_dart && !result.edges[other].has_dart);
    assert_true(fabs(worst(&result, other, BREAK_ANGLE)->value - 0.5 * 180 / M_PI) < 1e-4);
    assert_true(fabs(result.edges[other].out_length - result.edges[other].length) < 1e-9);
    /* The worst place is at the end that is no dart: y = 1, where the other edge is. */
    assert_true(fabs(worst(&result, dart, BREAK_ANGLE)->point[1] - 1) < 0.01);
    assert_true(result.edges[dart].out_length < 0.999 * result.edges[dart].length);
    assert_true(result.edges[dart].out_length > 0.9 * result.edges[dart].length);
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* All derivatives up to the second are the same on both sides of an edge. */
static void assert_smooth(const struct limit_tables *tables, const struct break_edge *edge)
{
    for (int k = 1; k < 20; k++) {
        struct limit_point side[2];
        for (int i = 0; i < 2; i++) {
            const struct limit_place place = {edge->face[i], edge->edge[i],
                                              i ? 1 - k / 20.0 : k / 20.0, 0};
            assert_true(limit_evaluate_at(tables, &place, &side[i]));
        }
        /* Across the edge the second face's parameters run against those of the first. */
        const struct vec differences[] = {
            vec_sub(side[0].s, side[1].s), vec_add(side[0].sv, side[1].sv),
            vec_sub(side[0].suv, side[1].suv), vec_sub(side[0].svv, side[1].svv)};
        for (int i = 0; i < 4; i++)
            assert_true(vec_length(differences[i]) < 1e-5 * (1 + vec_length(side[0].svv)));
    }
}

/* The surface along a crease of finite sharpness is smooth. It turns by the fold's angle within a strip that is as
 * narrow as the sharpness is high. */
static void a_semisharp_crease_is_no_break(void **state)
{
    (void)state;
    struct limit_tables tables;
    double last = 0;
    for (int sharpness = 1; sharpness <= 6; sharpness++) {
        build_fold(0.5, 3, 3, sharpness, &tables);
        struct computation *computation = find(&tables);
        const struct breaks_found result = breaks_result(computation);
        assert_int_equal(result.n_edges, 3);
        assert_int_equal(result.counts.semisharp, 3);
        for (size_t k = 0; k < 3; k++) {
            const struct break_edge *edge = &result.edges[k];
            assert_int_equal(edge->kind, BREAK_SEMISHARP);
            assert_smooth(&tables, edge);
            assert_int_equal(edge->over, 0);
            assert_true(edge->out_length == 0);
            assert_true(isnan(edge->worst[BREAK_GAP].value) &&
                        isnan(edge->worst[BREAK_KINK].value));
            assert_true(edge->worst[BREAK_ANGLE].value > 10);
            assert_true(edge->worst[BREAK_ANGLE].value < 0.5 * 180 / M_PI + 1e-4);
        }
        /* The same turn in half the width: twice the curvature. */
        double bend = worst(&result, 1, BREAK_CURVATURE)->value;
        assert_true(sharpness < 3 || fabs(bend / last - 2) < 0.05);
        last = bend;
        computation_destroy(computation);
        limit_tables_finish(&tables);
    }
}

/* --- vertices, and the work as a whole */

static const char CUBE[] =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

static void vertices_of_a_cube(void **state)
{
    (void)state;
    struct limit_tables tables;
    build(CUBE, sizeof CUBE - 1, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_vertices, 8);
    for (size_t i = 0; i < 8; i++) {
        const struct break_vertex *vertex = &result.vertices[i];
        assert_true(vertex->is_inside);
        assert_int_equal(vertex->n_faces, 3);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(fabs(vertex->point[k]) - fabs(vertex->point[0])) < 1e-6);
        /* A convex body seen from outside, and all its corners are alike. */
        assert_true(vertex->k_least <= vertex->k_greatest && vertex->k_greatest < 0);
        assert_true(fabs(vertex->k_least - result.vertices[0].k_least) < 1e-4);
        assert_true(vertex->radius > 0 && vertex->radius < 0.1);
    }
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

/* Runs the slices of each phase from the last to the first. */
static void run_backwards(struct computation *computation)
{
    struct error error = {0};
    for (unsigned phase = 0; computation->kind->stages[phase]; phase++) {
        size_t n = 0;
        assert_true(computation->kind->begin(computation, phase, &n, &error));
        while (n > 0)
            computation->kind->slice(computation, --n);
    }
}

static void the_order_of_slices_changes_nothing(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.3, 20, 20, 10, &tables);
    struct computation *forwards = find(&tables), *backwards = start(&tables, &LIMITS);
    run_backwards(backwards);
    const struct breaks_found a = breaks_result(forwards), b = breaks_result(backwards);
    assert_int_equal(a.n_edges, 20);
    assert_int_equal(b.n_edges, 20);
    for (size_t i = 0; i < 20; i++) {
        uint8_t bytes[2][BREAK_EDGE_BYTES];
        break_edge_pack(&a.edges[i], bytes[0]);
        break_edge_pack(&b.edges[i], bytes[1]);
        assert_memory_equal(bytes[0], bytes[1], BREAK_EDGE_BYTES);
    }
    assert_memory_equal(&a.counts, &b.counts, sizeof a.counts);
    computation_destroy(forwards);
    computation_destroy(backwards);
    limit_tables_finish(&tables);
}

static size_t heap_bytes(void)
{
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

/* A computation takes at most the memory that it says, so that its client can be charged before it begins. (Sanitizers
 * have another heap, of which the C library knows nothing.) */
static void memory_is_bounded(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct error error = {0};
    build_fold(0.3, 60, 60, 10, &tables);
    const size_t before = heap_bytes();
    size_t most = 0;
    struct computation *computation = start(&tables, &LIMITS);
    for (unsigned phase = 0; computation->kind->stages[phase]; phase++) {
        size_t n = 0;
        assert_true(computation->kind->begin(computation, phase, &n, &error));
        most = heap_bytes() - before > most ? heap_bytes() - before : most;
        for (size_t i = 0; i < n; i++)
            computation->kind->slice(computation, i);
    }
    assert_int_equal(breaks_result(computation).n_edges, 60);
    assert_true(most + 60 * BREAK_EDGE_BYTES <= breaks_bytes(&tables));
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

static void a_cancelled_computation_ends(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct error error = {0};
    build_fold(0.3, 3, 3, 10, &tables);
    struct computation *computation = start(&tables, &LIMITS);
    atomic_store(&computation->cancelled, true);
    assert_false(computation_run(computation, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    computation_destroy(computation);
    computation_destroy(NULL);
    limit_tables_finish(&tables);
}

/* The worst edge comes first, and those over a limit before all others. */
static void edges_are_sorted(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_fold(0.4, 6, 4, 10, &tables);
    struct computation *computation = find(&tables);
    const struct breaks_found result = breaks_result(computation);
    assert_int_equal(result.n_edges, 4);
    assert_int_equal(result.counts.edges_out, 4);
    double length = 0;
    for (size_t i = 0; i < 4; i++) {
        length += result.edges[i].length;
        assert_true(i == 0 || worst(&result, i, BREAK_ANGLE)->value <=
                                  worst(&result, i - 1, BREAK_ANGLE)->value + 1e-9);
    }
    assert_true(fabs(length - result.counts.creases_length) < 1e-9);
    computation_destroy(computation);
    limit_tables_finish(&tables);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fold_has_its_angle),
        cmocka_unit_test(a_smooth_sheet_has_no_edges),
        cmocka_unit_test(a_dart_ends_a_crease),
        cmocka_unit_test(a_semisharp_crease_is_no_break),
        cmocka_unit_test(vertices_of_a_cube),
        cmocka_unit_test(the_order_of_slices_changes_nothing),
        cmocka_unit_test(memory_is_bounded),
        cmocka_unit_test(a_cancelled_computation_ends),
        cmocka_unit_test(edges_are_sorted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
