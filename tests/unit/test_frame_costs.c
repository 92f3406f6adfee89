/* The estimated costs of frames, learned from the costs of earlier frames. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/frame/costs.h"

static void test_costs(void **state)
{
    (void)state;
    static struct costs costs;
    uint64_t a = costs_key(costs_key(0, 1), 2), b = costs_key(costs_key(0, 2), 1);
    assert_true(a != b);
    assert_int_equal(costs_estimate(&costs, a, 1000), COSTS_UNKNOWN_US);
    costs_learn(&costs, a, 1000, 2000);
    assert_in_range(costs_estimate(&costs, a, 500), 999, 1000);
    /* the mean of all models, until this one has been drawn */
    assert_in_range(costs_estimate(&costs, b, 500), 999, 1000);
    for (int i = 0; i < 40; i++)
        costs_learn(&costs, a, 1000, 4000);
    assert_in_range(costs_estimate(&costs, a, 1000), 3990, 4000);
    costs_learn(&costs, b, 1000, 0);
    assert_true(costs_estimate(&costs, b, 1000) <= 1);
    assert_in_range(costs_estimate(&costs, a, 1000), 3990, 4000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_costs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
