/* The plan of a surface's tables is given up as soon as the measured part cannot be kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/surface/subdivision/build.h"
#include "server/surface/watch.h"

/* Allows this many texels, and counts how often permission is asked for. */
struct gauge {
    size_t most_texels;
    size_t asked, last_texels, least_texels;
};

static bool may_need(void *owner, const struct limit_size *size, struct error *error)
{
    struct gauge *gauge = owner;
    if (gauge->asked++ == 0)
        gauge->least_texels = size->n_texels;
    else
        assert_true(size->n_texels >= gauge->last_texels || gauge->asked == 2);
    gauge->last_texels = size->n_texels;
    return size->n_texels <= gauge->most_texels || error_set(error, ERROR_MODEL, "too many");
}

static bool goes_on(void *owner, struct error *error)
{
    (void)owner;
    (void)error;
    return true;
}

static void read_model(const char *name, struct cage *cage)
{
    static char bytes[1 << 20];
    char path[200];
    struct error error = {0};
    snprintf(path, sizeof path, "tests/models/%s", name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    if (!cage_read(cage, bytes, size, name, &error))
        fail_msg("%s", error.text);
}

static struct limit_plan *plan_within(const struct cage *cage, size_t most_texels,
                                      struct gauge *gauge, struct error *error)
{
    *gauge = (struct gauge){.most_texels = most_texels};
    const struct limit_watch watch = {goes_on, may_need, gauge};
    return limit_plan_create(cage, &watch, error);
}

/* The first question gives a lower bound, and the last one the size of the whole tables. */
static void test_the_sum_is_asked_at_every_face(void **state)
{
    (void)state;
    static const char *const names[] = {"body.obj",  "chaikin.obj",         "creases.obj",
                                        "ngons.obj", "nonmanifold.obj",     "pole.obj",
                                        "sheet.obj", "smoothtriangles.obj", "tetra.obj"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        struct cage cage;
        struct gauge gauge;
        struct error error = {0};
        read_model(names[i], &cage);
        struct limit_plan *plan = plan_within(&cage, SIZE_MAX, &gauge, &error);
        assert_non_null(plan);
        const struct limit_size *size = limit_plan_size(plan);
        assert_int_equal(gauge.asked, 1 + size->n_faces);
        assert_int_equal(gauge.last_texels, size->n_texels);
        assert_true(gauge.least_texels <= size->n_texels);
        limit_plan_destroy(plan);
        cage_finish(&cage);
    }
}

static void test_it_ends_where_the_sum_passes_the_limit(void **state)
{
    (void)state;
    struct cage cage;
    struct gauge gauge;
    struct error error = {0};
    read_model("pole.obj", &cage);
    struct limit_plan *plan = plan_within(&cage, SIZE_MAX, &gauge, &error);
    assert_non_null(plan);
    const size_t all = gauge.last_texels, asked = gauge.asked, least = gauge.least_texels;
    limit_plan_destroy(plan);
    assert_true(0 < least && least < all);

    assert_null(plan_within(&cage, least - 1, &gauge, &error));
    assert_int_equal(gauge.asked, 1); /* asked before any face was measured */
    assert_int_equal(error.kind, ERROR_MODEL);
    for (size_t most = least; most < all; most += (all - least) / 7 + 1) {
        assert_null(plan_within(&cage, most, &gauge, &error));
        assert_true(gauge.last_texels > most);
        assert_true(gauge.asked > 1 && gauge.asked <= asked);
    }
    assert_null(plan_within(&cage, all / 2 > least ? all / 2 : least, &gauge, &error));
    assert_true(gauge.asked < asked); /* the faces behind were not measured */
    plan = plan_within(&cage, all, &gauge, &error);
    assert_non_null(plan);
    limit_plan_destroy(plan);
    cage_finish(&cage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_sum_is_asked_at_every_face),
        cmocka_unit_test(test_it_ends_where_the_sum_passes_the_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
