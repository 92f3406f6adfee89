/* The evaluator on the CPU: closed forms at extraordinary vertices, derivatives against differences
 * of the surface on every kind of node, the same place seen from other corners, and holes.
 * tests/oracle judges whether the tables are right. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "server/surface/evaluate.h"
#include "tests/unit/cage_tables.h"

#define CUBE                                                                                       \
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"         \
    "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"

static void assert_near(struct vec a, struct vec b, double most)
{
    double off = vec_length(vec_sub(a, b));
    if (!(off <= most))
        fail_msg("(%g %g %g) is %g from (%g %g %g)", a.x, a.y, a.z, off, b.x, b.y, b.z);
}

/* Valence 3: 3/8 of the vertex, 1/6 of its edges' ends, 1/24 of its faces' far corners. */
static void test_extraordinary_vertex(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct limit_point p;
    build(CUBE, strlen(CUBE), &tables);
    double diagonal = -1 / sqrt(3);
    for (uint32_t face = 0; face < 3; face += 2) { /* each begins at vertex 1 */
        assert_true(limit_evaluate(&tables, face, 0, 0, &p));
        assert_near(p.s, (struct vec){-0.5, -0.5, -0.5}, 1e-12);
        assert_true(p.has_normal);
        assert_near(p.n, (struct vec){diagonal, diagonal, diagonal}, 1e-6);
    }
    assert_true(limit_evaluate(&tables, 1, 1, 1, &p)); /* vertex 7 */
    assert_near(p.s, (struct vec){0.5, 0.5, 0.5}, 1e-12);
    assert_near(p.n, (struct vec){-diagonal, -diagonal, -diagonal}, 1e-6);
    limit_tables_finish(&tables);
}

/* The surface is continuous at the vertex: the last ring before it has its position and normal. */
static void test_next_to_the_vertex(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct limit_point vertex, near;
    build(CUBE, strlen(CUBE), &tables);
    const struct limit_place at = {.node = 3, .corner = 2, .a = 0, .b = 0};
    const struct limit_place beside = {.node = 3, .corner = 2, .a = 0x1p-30, .b = 0x1p-31};
    assert_true(limit_evaluate_at(&tables, &at, &vertex));
    assert_true(limit_evaluate_at(&tables, &beside, &near));
    assert_near(near.s, vertex.s, 1e-8);
    assert_true(vec_length(vec_sub(near.s, vertex.s)) > 0);
    assert_near(near.n, vertex.n, 1e-6);
    assert_true(vec_length(near.su) > 0 && vec_length(vertex.su) == 0);
    limit_tables_finish(&tables);
}

static void test_no_normal_at_a_tip(void **state)
{
    (void)state;
    static const char text[] = CUBE "t corner 1/1/0 0 10\n";
    struct limit_tables tables;
    struct limit_point p;
    build(text, strlen(text), &tables);
    assert_true(limit_evaluate(&tables, 0, 0, 0, &p));
    assert_near(p.s, (struct vec){-1, -1, -1}, 1e-12);
    assert_false(p.has_normal);
    struct vec own = p.n; /* of this face's corner */
    const struct limit_place beside = {.node = 0, .a = 0x1p-31, .b = 0x1p-31};
    assert_true(limit_evaluate_at(&tables, &beside, &p) && p.has_normal);
    assert_near(p.n, own, 1e-4);
    assert_true(limit_evaluate(&tables, 2, 0, 0, &p) && !p.has_normal);
    assert_true(vec_length(vec_sub(p.n, own)) > 0.1);
    /* The part that the table leaves out is smaller than a pixel of 2^-24 of the face, which is two
     * units wide. */
    const struct limit_node *node = &tables.nodes[tables.nodes[0].first];
    assert_int_equal(node->kind, LIMIT_CORNER);
    double last = ldexp(1, -1 - (node->levels & ~(int)LIMIT_NO_NORMAL));
    assert_true(limit_evaluate(&tables, 0, last, last, &p));
    assert_near(p.s, (struct vec){-1, -1, -1}, 2 * 0x1p-24);
    limit_tables_finish(&tables);
}

static void assert_normal(const struct limit_tables *tables, double u, double v, struct vec n)
{
    struct limit_point p;
    assert_true(limit_evaluate(tables, BEZIER_FACE, u, v, &p) && p.has_normal);
    assert_near(p.n, n, 5e-6);
}

/* The normal is straight up along the whole pole, whichever derivative vanishes there. */
static void test_pole(void **state)
{
    (void)state;
    struct limit_tables tables;
    for (int turned = 0; turned < 2; turned++) {
        build_octant(turned, &tables);
        for (double along = 0; along <= 1; along += 0.125)
            assert_normal(&tables, turned ? 1 : along, turned ? along : 1, (struct vec){0, 0, 1});
        limit_tables_finish(&tables);
    }
}

/* At u = v = 0, su and sv are parallel. The normal of S = (u - v, (u^2 + v^2) / 2 + u v / 4, u v +
 * u^3 + v^3) is (1, 0, 0) x (0, 5, 4). */
static void test_parallel_derivatives(void **state)
{
    (void)state;
    static const double linear[4] = {0, 1 / 3.0, 2 / 3.0, 1}, square[4] = {0, 0, 1 / 3.0, 1};
    static const double cube[4] = {0, 0, 0, 1};
    struct vec bezier[4][4];
    struct limit_tables tables;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            double both = linear[i] * linear[j];
            bezier[j][i] =
                (struct vec){linear[i] - linear[j], (square[i] + square[j]) / 2 + both / 4,
                             both + cube[i] + cube[j]};
        }
    }
    build_bezier(bezier, &tables);
    assert_normal(&tables, 0, 0, vec_unit((struct vec){0, -4, 5}));
    limit_tables_finish(&tables);
}

/* At u = v = 0, both derivatives vanish. The normal of S = (u^2 + 2 u v, v^2 + u v, u^2 + v^2 +
 * u^3) towards the middle, along u = v, is (4, 1, 2) x (2, 3, 2). */
static void test_both_derivatives_vanish(void **state)
{
    (void)state;
    static const double linear[4] = {0, 1 / 3.0, 2 / 3.0, 1}, square[4] = {0, 0, 1 / 3.0, 1};
    static const double cube[4] = {0, 0, 0, 1};
    struct vec bezier[4][4];
    struct limit_tables tables;
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 4; i++) {
            double both = linear[i] * linear[j];
            bezier[j][i] = (struct vec){square[i] + 2 * both, square[j] + both,
                                        square[i] + square[j] + cube[i]};
        }
    }
    build_bezier(bezier, &tables);
    assert_normal(&tables, 0, 0, vec_unit((struct vec){-4, -4, 10}));
    limit_tables_finish(&tables);
}

/* A smooth corner of one quad: towards the corner the normal keeps turning, by 1/n at distance
 * 2^-n, and its limit must be the corner's own normal. */
static void test_corner_of_one_quad(void **state)
{
    (void)state;
    struct limit_tables tables;
    struct limit_point corner, near;
    double last = 1;
    build_file("tests/models/fender.obj", &tables);
    uint32_t face = 0;
    while (tables.adjacency[face].across[0] != LIMIT_NO_FACE ||
           tables.adjacency[face].across[3] != LIMIT_NO_FACE)
        face++;
    assert_true(limit_evaluate(&tables, face, 0, 0, &corner) && corner.has_normal);
    for (int n = 4; n < 32; n += 3) {
        assert_true(limit_evaluate(&tables, face, ldexp(1, -n), ldexp(0.6, -n), &near));
        double off = vec_length(vec_sub(near.n, corner.n));
        assert_true(off < last);
        last = off;
    }
    assert_true(last < 2e-4);
    limit_tables_finish(&tables);
}

static void test_hole(void **state)
{
    (void)state;
    static const char text[] = CUBE "t hole 1/0/0 2\n";
    struct limit_tables tables;
    struct limit_point p = {.s = {7, 7, 7}};
    build(text, strlen(text), &tables);
    assert_false(limit_evaluate(&tables, 2, 0.5, 0.5, &p));
    assert_near(p.s, (struct vec){7, 7, 7}, 0);
    assert_true(limit_evaluate(&tables, 1, 0.5, 0.5, &p));
    limit_tables_finish(&tables);
}

/* A place and those at small distances along a and b; false unless all of them lie on one
 * sub-patch. */
static bool neighbours(const struct limit_tables *tables, const struct limit_place *at, double h,
                       struct limit_point p[5])
{
    static const int along[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const float(*rows)[4] = NULL, (*column)[4] = NULL;
    for (int k = 0; k < 5; k++) {
        struct limit_place place = *at;
        struct limit_patch patch;
        place.a += h * along[k][0];
        place.b += h * along[k][1];
        if (!limit_patch_find(tables, &place, &patch) || patch.is_vertex ||
            (k > 0 && (patch.points.rows != rows || patch.points.column != column)))
            return false;
        rows = patch.points.rows;
        column = patch.points.column;
        limit_patch_evaluate(tables, &patch, &p[k]);
    }
    return true;
}

static struct vec difference(struct vec more, struct vec less, double h)
{
    return vec_scale(vec_sub(more, less), 0.5 / h);
}

static void check_derivatives(const struct limit_point p[5], double h)
{
    double size = vec_length(p->su) + vec_length(p->sv);
    double bend = size + vec_length(p->suu) + vec_length(p->suv) + vec_length(p->svv);
    assert_near(p->su, difference(p[1].s, p[2].s, h), 1e-5 * bend);
    assert_near(p->sv, difference(p[3].s, p[4].s, h), 1e-5 * bend);
    assert_near(p->suu, difference(p[1].su, p[2].su, h), 1e-3 * bend);
    assert_near(p->suv, difference(p[1].sv, p[2].sv, h), 1e-3 * bend);
    assert_near(p->suv, difference(p[3].su, p[4].su, h), 1e-3 * bend);
    assert_near(p->svv, difference(p[3].sv, p[4].sv, h), 1e-3 * bend);
    struct vec n = vec_unit(vec_cross(p->su, p->sv));
    assert_near(p->n, n, 1e-6);
    assert_true(fabs(p->luu - vec_dot(p->suu, n)) < 1e-6 * bend);
    assert_true(fabs(p->luv - vec_dot(p->suv, n)) < 1e-6 * bend);
    assert_true(fabs(p->lvv - vec_dot(p->svv, n)) < 1e-6 * bend);
}

/* At many places of a model's faces, from each corner. */
static void check_model(const char *path, unsigned kinds)
{
    const double h = 1e-5;
    struct limit_tables tables;
    unsigned met = 0, n = 0;
    build_file(path, &tables);
    for (uint32_t k = 0; k < 40 * tables.n_faces; k++) {
        struct limit_place at = {k % (uint32_t)tables.n_faces, k / 7 & 3, fmod(0.02 + k * 0.618, 1),
                                 fmod(0.01 + k * 0.7548, 1)};
        struct limit_point p[5];
        struct limit_patch patch;
        if (fmin(fmin(at.a, at.b), 1 - fmax(at.a, at.b)) < 0.02 || !neighbours(&tables, &at, h, p))
            continue;
        check_derivatives(p, h);
        assert_true(limit_patch_find(&tables, &at, &patch));
        met |= 1u << patch.node->kind;
        n++;
    }
    assert_int_equal(met & kinds, kinds);
    assert_true(n > 10 * tables.n_faces);
    limit_tables_finish(&tables);
}

static void test_derivatives(void **state)
{
    (void)state;
    check_model("tests/models/creases.obj",
                1u << LIMIT_REGULAR | 1u << LIMIT_CORNER | 1u << LIMIT_STRIP);
    check_model("tests/models/fender.obj", 1u << LIMIT_REGULAR | 1u << LIMIT_CORNER);
    check_model("tests/models/ngons.obj", 1u << LIMIT_CORNER);
}

/* The same place, seen from all four corners of its face. */
static void test_corners_of_a_face(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/creases.obj", &tables);
    for (uint32_t face = 0; face < tables.n_faces; face++) {
        const double u = 0.3125, v = 0.8125;
        const double a[4] = {u, v, 1 - u, 1 - v}, b[4] = {v, 1 - u, 1 - v, u};
        struct limit_point first, p;
        if (!limit_evaluate(&tables, face, u, v, &first))
            continue;
        for (unsigned corner = 1; corner < 4; corner++) {
            struct limit_place at = {face, corner, a[corner], b[corner]};
            assert_true(limit_evaluate_at(&tables, &at, &p));
            assert_near(p.s, first.s, 1e-12);
            assert_near(p.n, first.n, 1e-9);
        }
        /* From corner 1 on, a runs along v and b runs against u. */
        struct limit_place at = {face, 1, a[1], b[1]};
        assert_true(limit_evaluate_at(&tables, &at, &p));
        assert_near(p.su, first.sv, 1e-9 * vec_length(first.sv));
        assert_near(p.sv, vec_scale(first.su, -1), 1e-9 * vec_length(first.su));
    }
    limit_tables_finish(&tables);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_extraordinary_vertex), cmocka_unit_test(test_next_to_the_vertex),
        cmocka_unit_test(test_no_normal_at_a_tip),   cmocka_unit_test(test_hole),
        cmocka_unit_test(test_corner_of_one_quad),   cmocka_unit_test(test_derivatives),
        cmocka_unit_test(test_corners_of_a_face),    cmocka_unit_test(test_pole),
        cmocka_unit_test(test_parallel_derivatives), cmocka_unit_test(test_both_derivatives_vanish),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
