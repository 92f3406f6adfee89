/* How many losses of the GPU within ten minutes are too many. */
#include "server/ops/gpu_loss_log.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#define MINUTE_US 60000000u

static void the_third_in_ten_minutes_is_too_many(void **state)
{
    (void)state;
    struct gpu_loss_log losses = {0};
    assert_false(gpu_loss_log_add(&losses, 1 * MINUTE_US, 3));
    assert_false(gpu_loss_log_add(&losses, 2 * MINUTE_US, 3));
    assert_false(gpu_loss_log_add(&losses, 12 * MINUTE_US, 3)); /* the first loss is eleven minutes
                                                                * old */
    /* the second loss is ten minutes old */
    assert_true(gpu_loss_log_add(&losses, 12 * MINUTE_US, 3));
    assert_int_equal(losses.n, 4);
}

static void one_may_be_too_many_and_none_ever(void **state)
{
    (void)state;
    struct gpu_loss_log losses = {0};
    assert_true(gpu_loss_log_add(&losses, 5, 1));
    for (unsigned i = 0; i < 3 * GPU_LOSSES_MAX; i++)
        assert_false(gpu_loss_log_add(&losses, 5, 0));
    assert_true(gpu_loss_log_add(&losses, 5, GPU_LOSSES_MAX));
    assert_false(gpu_loss_log_add(&losses, 6 + GPU_LOSSES_WINDOW_US, 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_third_in_ten_minutes_is_too_many),
        cmocka_unit_test(one_may_be_too_many_and_none_ever),
    };
    return cmocka_run_group_tests_name("losses", tests, NULL, NULL);
}
