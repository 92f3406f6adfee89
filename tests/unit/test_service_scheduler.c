/* The scheduler alone: order within a session, turns among sessions, what may be in flight. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "server/service/scheduler.h"

static unsigned n_dropped;

static void drop(struct schedule_entry *entry)
{
    assert_null(entry->queue);
    n_dropped++;
}

static void test_empty(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    assert_null(scheduler_next(&scheduler));
    struct schedule_queue queue;
    scheduler_add_queue(&scheduler, &queue);
    assert_null(scheduler_next(&scheduler));
    scheduler_remove_queue(&scheduler, &queue, drop);
    assert_null(scheduler.turn);
}

static void test_order_and_two_in_flight(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue;
    struct schedule_entry e[4];
    scheduler_add_queue(&scheduler, &queue);
    for (int i = 0; i < 4; i++)
        scheduler_push(&scheduler, &queue, &e[i]);
    assert_int_equal(scheduler.waiting, 4);
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    assert_null(scheduler_next(&scheduler));
    scheduler_finished(&scheduler, &e[1]); /* the second may end first */
    assert_ptr_equal(scheduler_next(&scheduler), &e[2]);
    assert_null(scheduler_next(&scheduler));
    scheduler_finished(&scheduler, &e[0]);
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[3]);
    scheduler_finished(&scheduler, &e[3]);
    assert_int_equal(scheduler.waiting + scheduler.in_flight + queue.in_flight, 0);
}

static void test_sessions_take_turns(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue[3];
    struct schedule_entry e[3][4];
    for (int q = 0; q < 3; q++) {
        scheduler_add_queue(&scheduler, &queue[q]);
        for (int i = 0; i < 4; i++)
            scheduler_push(&scheduler, &queue[q], &e[q][i]);
    }
    for (int i = 0; i < 4; i++)
        for (int q = 0; q < 3; q++) {
            struct schedule_entry *next = scheduler_next(&scheduler);
            assert_ptr_equal(next, &e[q][i]);
            scheduler_finished(&scheduler, next);
        }
    assert_null(scheduler_next(&scheduler));
}

static void test_bound_for_all(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue[SCHEDULER_IN_ALL + 1];
    struct schedule_entry e[SCHEDULER_IN_ALL + 1];
    for (unsigned q = 0; q <= SCHEDULER_IN_ALL; q++) {
        scheduler_add_queue(&scheduler, &queue[q]);
        scheduler_push(&scheduler, &queue[q], &e[q]);
    }
    for (unsigned q = 0; q < SCHEDULER_IN_ALL; q++)
        assert_ptr_equal(scheduler_next(&scheduler), &e[q]);
    assert_null(scheduler_next(&scheduler));
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[SCHEDULER_IN_ALL]);
}

static void test_held_session_is_passed_over(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue a, b;
    struct schedule_entry ea, eb;
    scheduler_add_queue(&scheduler, &a);
    scheduler_add_queue(&scheduler, &b);
    scheduler_push(&scheduler, &a, &ea);
    scheduler_push(&scheduler, &b, &eb);
    a.held = true;
    assert_ptr_equal(scheduler_next(&scheduler), &eb);
    assert_null(scheduler_next(&scheduler));
    a.held = false;
    assert_ptr_equal(scheduler_next(&scheduler), &ea);
}

static void test_session_that_goes(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue a, b;
    struct schedule_entry ea[3], eb;
    scheduler_add_queue(&scheduler, &a);
    scheduler_add_queue(&scheduler, &b);
    for (int i = 0; i < 3; i++)
        scheduler_push(&scheduler, &a, &ea[i]);
    scheduler_push(&scheduler, &b, &eb);
    assert_ptr_equal(scheduler_next(&scheduler), &ea[0]);
    n_dropped = 0;
    scheduler_remove_queue(&scheduler, &a, drop);
    assert_int_equal(n_dropped, 2);
    assert_int_equal(scheduler.waiting, 1);
    ea[0].queue = NULL; /* as its owner must */
    scheduler_finished(&scheduler, &ea[0]);
    assert_int_equal(scheduler.in_flight, 0);
    assert_ptr_equal(scheduler_next(&scheduler), &eb);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_order_and_two_in_flight),
        cmocka_unit_test(test_sessions_take_turns),
        cmocka_unit_test(test_bound_for_all),
        cmocka_unit_test(test_held_session_is_passed_over),
        cmocka_unit_test(test_session_that_goes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
