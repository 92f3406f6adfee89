/* When a client reconnects, by a clock that the test sets. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "client/cli/base/resume.h"

#define LOST_MS 5000000

/* The waits after a loss if every attempt fails at once. Returns how many attempts there were. */
static unsigned waits(uint32_t limit_ms, uint32_t *wait_ms, unsigned max)
{
    struct resume resume = {.limit_ms = limit_ms};
    int64_t now_ms = LOST_MS;
    unsigned n = 0;
    assert_true(resume_lost(&resume, now_ms));
    while (n < max && resume_wait(&resume, now_ms, &wait_ms[n]))
        now_ms += wait_ms[n++];
    assert_int_equal(now_ms - LOST_MS, limit_ms);
    return n;
}

static void waits_double_and_fill_the_time(void **state)
{
    (void)state;
    static const uint32_t expected[] = {200, 400, 800, 1600, 2000, 2000, 2000, 1000};
    uint32_t wait_ms[64];
    assert_int_equal(waits(10000, wait_ms, 64), 8);
    assert_memory_equal(wait_ms, expected, sizeof(expected));
    assert_int_equal(waits(1000, wait_ms, 64), 3);
    assert_int_equal(wait_ms[2], 400);
    assert_int_equal(waits(0, wait_ms, 64), 0);
}

static void slow_tries_count(void **state)
{
    (void)state;
    struct resume resume = {.limit_ms = 86400000};
    uint32_t wait_ms;
    assert_true(resume_lost(&resume, LOST_MS));
    assert_true(resume_wait(&resume, LOST_MS + 86399999, &wait_ms));
    assert_int_equal(wait_ms, 1);
    assert_false(resume_wait(&resume, LOST_MS + 86400000, &wait_ms));
    assert_int_equal(resume_try_ms(&resume, LOST_MS), 86400000);
    assert_int_equal(resume_try_ms(&resume, LOST_MS + 86398500), 1500);
    assert_int_equal(resume_try_ms(&resume, LOST_MS + 86400001), 1000);
}

static void losses_without_an_answer_end(void **state)
{
    (void)state;
    struct resume resume = {.limit_ms = 1000};
    uint32_t wait_ms;
    for (unsigned i = 0; i < 2; i++) {
        for (unsigned k = 0; k < RESUME_MAX_LOSSES; k++) {
            /* each loss has the whole time again */
            assert_true(resume_lost(&resume, LOST_MS + 900 * k));
            assert_true(resume_wait(&resume, LOST_MS + 900 * k + 500, &wait_ms));
            assert_int_equal(wait_ms, 200);
        }
        assert_int_equal(resume.is_answered, i > 0);
        resume_answered(&resume);
        assert_true(resume.is_answered);
    }
    for (unsigned k = 0; k < RESUME_MAX_LOSSES; k++)
        assert_true(resume_lost(&resume, LOST_MS));
    assert_false(resume_lost(&resume, LOST_MS));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waits_double_and_fill_the_time),
        cmocka_unit_test(slow_tries_count),
        cmocka_unit_test(losses_without_an_answer_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
