/* Vertices at which several sheets meet. One rule moves all of them, by the sharp edges of all
 * sheets. The model is a book: pages that meet at a spine, whose middle vertex is the end of
 * creases of one page or of several. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "server/surface/evaluate.h"
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/topology.h"
#include "tests/unit/cage_tables.h"

enum { PAGES = 3, SPINE_Z = 3, MAX_CREASES = 4 };

/* x of the spine's middle vertex; the ends of the spine are at x = 0 */
static const double middle_x = 0.4;

/* The spine runs along z through vertices 0 (its middle), 1 and 2; page k's outer vertices are
 * 3 + 3 k (beside the middle) and the two after it. Its faces 2 k and 2 k + 1 hold the middle. */
static size_t book(char *text, size_t room, const char *more)
{
    int used = snprintf(text, room, "v %g 0 0\nv 0 0 -%d\nv 0 0 %d\n", middle_x, SPINE_Z, SPINE_Z);
    for (int k = 0; k < PAGES; k++)
        for (int z = 0; z < 3; z++)
            used += snprintf(text + used, room - (size_t)used, "v %.9f %.9f %d\n", cos(2 * k),
                             sin(2 * k),
                             z == 0   ? 0
                             : z == 1 ? -SPINE_Z
                                      : SPINE_Z);
    for (int k = 0; k < PAGES; k++)
        used += snprintf(text + used, room - (size_t)used, "f 2 1 %d %d\nf 1 3 %d %d\n", 4 + 3 * k,
                         5 + 3 * k, 6 + 3 * k, 4 + 3 * k);
    used += snprintf(text + used, room - (size_t)used, "%s", more);
    assert_true(used > 0 && (size_t)used < room);
    return (size_t)used;
}

/* x of the middle's limit if edges of these sharpnesses end there: the vertex's own rule, applied
 * step by step. */
static double limit_of_middle(const double *sharpness, int n, bool chaikin)
{
    double x = middle_x, end = 0, sharp[MAX_CREASES] = {0}; /* end: the mean of both neighbours */
    for (int k = 0; k < n; k++)
        sharp[k] = sharpness[k];
    for (int step = 0; step < 60; step++) {
        double sum = 0, ending = 0, child[MAX_CREASES] = {0};
        int n_sharp = 0, n_left = 0, n_ending = 0;
        for (int k = 0; k < n; k++) {
            sum += sharp[k];
            n_sharp += sharp[k] > 0;
        }
        for (int k = 0; k < n; k++) {
            double others = n_sharp > 1 ? (sum - sharp[k]) / (n_sharp - 1) : sharp[k];
            double mean = chaikin ? 0.75 * sharp[k] + 0.25 * others : sharp[k];
            child[k] = sharp[k] > 0 ? fmax(mean - 1, 0) : 0;
            n_left += child[k] > 0;
            n_ending += sharp[k] > 0 && child[k] <= 0;
            ending += child[k] <= 0 ? sharp[k] : 0;
        }
        double crease = 0.75 * x + 0.25 * end;
        double weight = n_ending ? fmin(ending / n_ending, 1) : 0;
        double next = n_left ? x : n_sharp ? weight * x + (1 - weight) * crease : crease;
        end = (x + end) / 2;
        x = next;
        memcpy(sharp, child, sizeof sharp);
    }
    return x;
}

/* Expects that the middle, evaluated from all six faces, lies at x. */
static void assert_middle(const char *more, double x)
{
    char text[4096];
    struct limit_tables tables;
    struct limit_point p;
    build(text, book(text, sizeof text, more), &tables);
    for (uint32_t face = 0; face < 2 * PAGES; face++) {
        double u = face % 2 ? 0 : 1;
        assert_true(limit_evaluate(&tables, face, u, 0, &p));
        if (!(fabs(p.s.x - x) < 1e-6))
            fail_msg("%s face %u: x = %.7f, not %.7f", more, face, p.s.x, x);
        assert_true(fabs(p.s.y) < 1e-6 && fabs(p.s.z) < 1e-6);
    }
    limit_tables_finish(&tables);
}

/* A crease of one page, fractional or not, holds the vertex of all three. */
static void test_crease_of_one_page(void **state)
{
    (void)state;
    static const double sharpness[] = {0.4, 1, 2.5, 3, 6.75};
    assert_middle("", limit_of_middle(NULL, 0, false));
    for (size_t i = 0; i < sizeof sharpness / sizeof sharpness[0]; i++) {
        char tag[64];
        for (int page = 0; page < PAGES; page++) {
            snprintf(tag, sizeof tag, "t crease 2/1/0 0 %d %g\n", 3 + 3 * page, sharpness[i]);
            assert_middle(tag, limit_of_middle(&sharpness[i], 1, false));
        }
    }
    /* By hand: a sharpness of 2.5 holds the middle for two steps and half of the third, so that the
     * middle moves 1/16 of the way to the mean of its neighbours. */
    assert_float_equal(limit_of_middle(&sharpness[2], 1, false), middle_x * 15 / 16, 1e-12);
    assert_middle("t crease 2/1/0 3 0 10\n", middle_x);
    assert_middle("t crease 2/1/0 3 0 10\nt crease 2/1/0 6 0 1.5\n", middle_x);
}

/* Creases of different pages lose their sharpness at different steps; the mean of their sharpnesses
 * counts. */
static void test_creases_of_two_pages(void **state)
{
    (void)state;
    static const double two[2] = {1.4, 0.7}, together[2] = {1.4, 1.8};
    assert_middle("t crease 2/1/0 0 3 1.4\nt crease 2/1/0 0 6 0.7\n",
                  limit_of_middle(two, 2, false));
    assert_middle("t crease 2/1/0 0 3 1.4\nt crease 2/1/0 0 9 1.8\n",
                  limit_of_middle(together, 2, false));
}

/* With Chaikin's rule, too, a crease takes account of those in other pages. */
static void test_chaikin(void **state)
{
    (void)state;
    static const double sharpness[3] = {3.2, 0.6, 1.9};
    char tags[256];
    snprintf(tags, sizeof tags,
             "t creasemethod 0/0/1 chaikin\nt crease 2/1/0 0 3 %g\nt crease 2/1/0 0 6 %g\n"
             "t crease 2/1/0 0 9 %g\n",
             sharpness[0], sharpness[1], sharpness[2]);
    double x = limit_of_middle(sharpness, 3, true);
    assert_true(fabs(x - limit_of_middle(sharpness, 3, false)) > 1e-3);
    assert_middle(tags, x);
}

/* The vertex's own sharpness counts like that of an edge. */
static void test_sharp_vertex(void **state)
{
    (void)state;
    static const double both[2] = {0.8, 0.5};
    assert_middle("t corner 1/1/0 0 0.8\n", limit_of_middle(both, 1, false));
    assert_middle("t corner 1/1/0 0 0.8\nt crease 2/1/0 0 6 0.5\n",
                  limit_of_middle(both, 2, false));
}

/* A tent whose tip is the middle vertex is a closed fan. The crease of the spine holds the tip,
 * though it does not end there. Tested with a crease on one of the tent's edges, and with one
 * across the tent. */
static void test_closed_sheet(void **state)
{
    (void)state;
    static const char tent[] = "v 2 0 1\nv 2 1 1\nv 2 1 0\nv 2 1 -1\nv 2 0 -1\nv 2 -1 -1\n"
                               "v 2 -1 0\nv 2 -1 1\n"
                               "f 1 13 14 15\nf 1 15 16 17\nf 1 17 18 19\nf 1 19 20 13\n";
    static const char *const crease[] = {"", "t crease 2/1/0 0 14 2.5\n",
                                         "t crease 2/1/0 14 0 2.5\nt crease 2/1/0 0 18 2.5\n"};
    static const double sharpness[] = {2.5, 2.5};
    for (int creases = 0; creases <= 2; creases++) {
        char text[4096], more[1024];
        struct limit_tables tables;
        struct limit_point p;
        snprintf(more, sizeof more, "%s%s", tent, crease[creases]);
        double x = limit_of_middle(sharpness, creases, false);
        build(text, book(text, sizeof text, more), &tables);
        for (uint32_t face = 2 * PAGES; face < 2 * PAGES + 4; face++) {
            assert_true(limit_evaluate(&tables, face, 0, 0, &p));
            assert_float_equal(p.s.x, x, 1e-6);
            assert_false(p.has_normal); /* a tip has no normal */
            assert_true(limit_evaluate(&tables, face, 0x1p-20, 0x1p-21, &p));
            assert_float_equal(p.s.x, x, 1e-3); /* rings around a tip shrink slowly */
            assert_true(p.has_normal);
        }
        assert_middle(more, x);
        limit_tables_finish(&tables);
    }
}

static const struct vertex_creases *levels_of(const struct topology *t)
{
    const struct nonmanifold_vertex *sheets = nonmanifold_at(t, 1); /* the middle at face 0 */
    assert_non_null(sheets);
    assert_int_equal(sheets->vertex, 0);
    assert_int_equal(sheets->end[0] + sheets->end[1], 3);
    return &t->vertex_creases[sheets->first_step];
}

/* The list of vertex creases against these sharpnesses, level by level. */
static void test_levels(void **state)
{
    (void)state;
    char text[4096];
    struct cage cage;
    struct topology t;
    struct error error = {0};
    size_t size = book(text, sizeof text,
                       "t crease 2/1/0 0 3 1.5\nt crease 2/1/0 0 6 10\nt crease 2/1/0 0 9 0.25\n");
    assert_true(cage_read(&cage, text, size, "book.obj", &error));
    assert_true(topology_init(&t, &cage, &error));
    assert_int_equal(t.n_nonmanifold, 1); /* the ends of the spine are sharp anyway */
    const struct vertex_creases *level = levels_of(&t);
    assert_int_equal(level[0].n_sharp, 5);
    assert_float_equal(level[0].semisharp.sum, 1.75, 0);
    assert_int_equal(level[0].semisharp.n, 2);
    assert_int_equal(level[1].n_sharp, 4);
    assert_float_equal(level[1].semisharp.sum, 0.5, 0);
    assert_int_equal(level[2].n_sharp, 3);
    assert_int_equal(level[2].semisharp.n, 0);
    assert_int_equal(level[1].semisharp.n, 1);
    assert_int_equal(t.n_vertex_creases, 3);
    assert_null(nonmanifold_at(&t, 0)); /* an end of the spine */
    topology_finish(&t);
    cage_finish(&cage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crease_of_one_page),
        cmocka_unit_test(test_creases_of_two_pages),
        cmocka_unit_test(test_chaikin),
        cmocka_unit_test(test_sharp_vertex),
        cmocka_unit_test(test_closed_sheet),
        cmocka_unit_test(test_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
