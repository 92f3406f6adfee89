/* The scheduler's order: newer requests of a view replace older ones, few tiles wait on the device,
 * queues are bounded, and sessions may leave at any time. */
#include "tests/unit/schedule_entries.h"

static void test_empty(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    assert_null(scheduler_next(&scheduler));
    struct schedule_queue queue;
    struct schedule_entry entry = entry_of(CLASS_STILL, 1);
    add_queue(&queue);
    assert_null(scheduler_enter(&scheduler, &queue, &entry));
    assert_null(scheduler_next(&scheduler)); /* none is ready: the entry waits for its model */
    assert_int_equal(scheduler.waiting, 1);
    scheduler_leave(&scheduler, &entry);
    scheduler_leave(&scheduler, &entry); /* a second call does nothing */
    assert_is_empty(&scheduler);
}

static void test_order_and_two_begun(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue;
    struct schedule_entry e[4];
    add_queue(&queue);
    for (int i = 0; i < 4; i++) {
        e[i] = entry_of(CLASS_STILL, 1000);
        ask(&scheduler, &queue, &e[i]);
    }
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    assert_null(scheduler_next(&scheduler)); /* one tile of a frame at a time */
    scheduler_stepped(&scheduler, &e[0], 1000, false);
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    scheduler_stepped(&scheduler, &e[1], 1000, false);
    assert_null(scheduler_next(&scheduler)); /* none: both drawn frames are being encoded */
    scheduler_finished(&scheduler, &e[1]);   /* the second may finish before the first */
    assert_ptr_equal(scheduler_next(&scheduler), &e[2]);
    scheduler_stepped(&scheduler, &e[2], 1000, false);
    scheduler_finished(&scheduler, &e[0]);
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[3]);
    draw_whole(&scheduler, &e[3], 1000);
    assert_is_empty(&scheduler);
}

/* A second tile goes to the device only where no more urgent request can arrive meanwhile. */
static void test_two_tiles_on_the_device(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue[3];
    struct schedule_entry batch = entry_of(CLASS_BATCH, 1000), still = entry_of(CLASS_STILL, 1000);
    struct schedule_entry interactive[2] = {entry_of(CLASS_INTERACTIVE, 1000),
                                            entry_of(CLASS_INTERACTIVE, 1000)};
    for (int q = 0; q < 3; q++)
        add_queue(&queue[q]);
    ask(&scheduler, &queue[0], &batch);
    assert_ptr_equal(scheduler_next(&scheduler), &batch);
    ask(&scheduler, &queue[0], &still);
    /* a still's tile does not wait on the device behind a batch's */
    assert_null(scheduler_next(&scheduler));
    ask(&scheduler, &queue[1], &interactive[0]);
    ask(&scheduler, &queue[2], &interactive[1]);
    struct schedule_entry next_frame = view_of(CLASS_INTERACTIVE, 1);
    ask(&scheduler, &queue[1], &next_frame);
    assert_ptr_equal(scheduler_next(&scheduler), &interactive[0]);
    assert_null(scheduler_next(&scheduler)); /* at most two tiles are on the device */
    scheduler_stepped(&scheduler, &batch, 1000, true);
    scheduler_leave(&scheduler, &batch);
    scheduler_leave(&scheduler, &still);
    assert_ptr_equal(scheduler_next(&scheduler), &interactive[1]);
    scheduler_stepped(&scheduler, &interactive[1], 1000, false);
    /* A session's next frame begins when its previous one has been drawn, and can no longer be
     * replaced then. */
    assert_null(scheduler_next(&scheduler));
    scheduler_stepped(&scheduler, &interactive[0], 1000, false);
    assert_ptr_equal(scheduler_next(&scheduler), &next_frame);
}

/* A second tile waits behind an interactive one only if both are short, so that a request that
 * arrives meanwhile does not wait long. */
static void test_long_tiles_do_not_queue_up(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue[4];
    struct schedule_entry e[3] = {entry_of(CLASS_INTERACTIVE, SCHEDULER_AHEAD_US / 2),
                                  entry_of(CLASS_INTERACTIVE, SCHEDULER_AHEAD_US / 2 + 1),
                                  entry_of(CLASS_INTERACTIVE, SCHEDULER_AHEAD_US / 2 + 1)};
    struct schedule_entry late = entry_of(CLASS_INTERACTIVE, SCHEDULER_AHEAD_US);
    for (int q = 0; q < 4; q++)
        add_queue(&queue[q]);
    for (int q = 0; q < 3; q++)
        ask(&scheduler, &queue[q], &e[q]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    assert_null(scheduler_next(&scheduler));
    assert_int_equal(e[1].state, SCHEDULE_READY);
    draw_whole(&scheduler, &e[0], 9000);
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    /* tiles that were put back do not count as waiting on the device */
    scheduler_put_back(&scheduler, &e[1]);
    scheduler_leave(&scheduler, &e[1]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[2]);
    ask(&scheduler, &queue[3], &late);
    assert_null(scheduler_next(&scheduler));
    draw_whole(&scheduler, &e[2], 9000);
    /* a long tile is drawn when the device is idle */
    assert_ptr_equal(scheduler_next(&scheduler), &late);
    draw_whole(&scheduler, &late, 9000);
    assert_is_empty(&scheduler);
    assert_int_equal(scheduler.ahead_us, 0);
}

/* While stills wait without an end, an interactive frame of four tiles is drawn without a break. A tile of a still comes
 * when a whole one is owed. */
static void test_tiles_of_a_frame_stay_together(void **state)
{
    (void)state;
    enum { FRAMES = 50, TILES = 4, TILE_US = 3000, STILL_US = 8000 };
    struct scheduler scheduler = {0};
    struct schedule_queue stills, person;
    static struct schedule_entry still[FRAMES * 4];
    int n_stills = 0, n_within = 0;
    add_queue(&stills);
    add_queue(&person);
    for (int frame = 0; frame < FRAMES; frame++) {
        struct schedule_entry entry = entry_of(CLASS_INTERACTIVE, TILE_US);
        for (int i = 0; i < 2; i++) { /* stills alone, and one more that waits */
            still[n_stills] = entry_of(CLASS_STILL, STILL_US);
            ask(&scheduler, &stills, &still[n_stills]);
            if (i == 0) {
                assert_ptr_equal(scheduler_next(&scheduler), &still[n_stills]);
                draw_whole(&scheduler, &still[n_stills], STILL_US);
            }
            n_stills++;
        }
        ask(&scheduler, &person, &entry);
        for (int tile = 0; tile < TILES;) {
            struct schedule_entry *next = scheduler_next(&scheduler);
            if (next == &entry) {
                tile++;
                scheduler_stepped(&scheduler, next, TILE_US, tile < TILES);
                continue;
            }
            n_within++;
            draw_whole(&scheduler, next, STILL_US);
        }
        scheduler_finished(&scheduler, &entry);
        if (still[n_stills - 1].queue) {
            assert_ptr_equal(scheduler_next(&scheduler), &still[n_stills - 1]);
            draw_whole(&scheduler, &still[n_stills - 1], STILL_US);
        }
    }
    assert_int_equal(n_within, 0);
    assert_is_empty(&scheduler);
}

/* --- a newer request of a view replaces the older one */

static void test_newer_request_of_a_view_replaces(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue, other;
    struct schedule_entry e[6];
    add_queue(&queue);
    add_queue(&other);
    for (int i = 0; i < 6; i++)
        e[i] = view_of(CLASS_INTERACTIVE, 7);
    e[0].estimate_us = 10;
    ask(&scheduler, &queue, &e[0]);
    ask(&scheduler, &other, &e[5]); /* the same number in another session is another view */
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    /* none is replaced, because e[0] has begun */
    assert_null(scheduler_enter(&scheduler, &queue, &e[1]));
    assert_ptr_equal(scheduler_enter(&scheduler, &queue, &e[2]), &e[1]);
    assert_int_equal(e[1].state, SCHEDULE_OUT);
    e[3].view = 8;
    assert_null(scheduler_enter(&scheduler, &queue, &e[3])); /* another view */
    e[4].request_class = CLASS_STILL; /* a still of the same view replaces it, too */
    assert_ptr_equal(scheduler_enter(&scheduler, &queue, &e[4]), &e[2]);
    assert_int_equal(scheduler.waiting, 3);
    scheduler_stepped(&scheduler, &e[0], 10, false);
    scheduler_finished(&scheduler, &e[0]);
    scheduler_ready(&e[3]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[3]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[5]);
    draw_whole(&scheduler, &e[5], 10);
    draw_whole(&scheduler, &e[3], 10);
    scheduler_ready(&e[4]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[4]);
    draw_whole(&scheduler, &e[4], 10);
    assert_is_empty(&scheduler);
}

static void test_batches_and_stills_without_a_view_stay(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue;
    struct schedule_entry batch[2] = {view_of(CLASS_BATCH, 7), view_of(CLASS_BATCH, 7)};
    struct schedule_entry still[2] = {entry_of(CLASS_STILL, 1), entry_of(CLASS_STILL, 1)};
    struct schedule_entry interactive = view_of(CLASS_INTERACTIVE, 7);
    struct schedule_entry zero = view_of(CLASS_INTERACTIVE, 0);
    add_queue(&queue);
    for (int i = 0; i < 2; i++) {
        ask(&scheduler, &queue, &batch[i]);
        ask(&scheduler, &queue, &still[i]);
    }
    ask(&scheduler, &queue, &interactive);
    ask(&scheduler, &queue, &zero); /* a still without a view is not a still of view 0 */
    assert_int_equal(scheduler.waiting, 6);
}

/* Requests that arrive faster than they are drawn: a frame that has begun is finished, and of the
 * others only the newest is kept. Every request ends exactly once. */
static void test_faster_than_drawn(void **state)
{
    (void)state;
    enum { N = 1000, PER_FRAME = 7 };
    struct scheduler scheduler = {0};
    struct schedule_queue queue;
    static struct schedule_entry e[N];
    unsigned n_drawn = 0, n_replaced = 0;
    add_queue(&queue);
    struct schedule_entry *drawing = NULL;
    for (int i = 0; i < N; i++) {
        e[i] = view_of(CLASS_INTERACTIVE, 1);
        struct schedule_entry *replaced = scheduler_enter(&scheduler, &queue, &e[i]);
        n_replaced += replaced != NULL;
        assert_true(!replaced || replaced == &e[i - 1]);
        scheduler_ready(&e[i]);
        if (i % PER_FRAME == 0) {
            if (drawing)
                draw_whole(&scheduler, drawing, 1000);
            n_drawn += drawing != NULL;
            drawing = scheduler_next(&scheduler);
            assert_ptr_equal(drawing, &e[i]); /* the newest is always drawn */
        }
    }
    assert_int_equal(n_drawn, N / PER_FRAME);
    assert_int_equal(n_drawn + n_replaced + scheduler.waiting + 1, N);
}

static void test_encoded_frames_are_replaced_while_held(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue;
    struct schedule_entry e[3];
    add_queue(&queue);
    for (int i = 0; i < 3; i++)
        e[i] = view_of(CLASS_INTERACTIVE, 1);
    ask(&scheduler, &queue, &e[0]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    scheduler_stepped(&scheduler, &e[0], 1000, false);
    assert_null(scheduler_hold(&e[0])); /* no newer request: the frame is kept */
    queue.flow[CLASS_INTERACTIVE].held = true;
    assert_ptr_equal(scheduler_enter(&scheduler, &queue, &e[1]), &e[0]);
    scheduler_ready(&e[1]);
    assert_null(scheduler_next(&scheduler)); /* the client's socket is full */
    queue.flow[CLASS_INTERACTIVE].held = false;
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    scheduler_stepped(&scheduler, &e[1], 1000, false);
    ask(&scheduler, &queue, &e[2]);
    assert_ptr_equal(scheduler_hold(&e[1]), &e[2]); /* it has been replaced by a newer one */
    scheduler_finished(&scheduler, &e[1]);
    scheduler_leave(&scheduler, &e[2]);
    assert_is_empty(&scheduler);
}

/* --- bounds */

static void test_bound_of_a_class(void **state)
{
    (void)state;
    enum { N = SCHEDULER_PER_CLASS + 1 };
    struct scheduler scheduler = {0};
    struct schedule_party party;
    struct schedule_queue queue[N];
    struct schedule_entry e[N], other = entry_of(CLASS_INTERACTIVE, 1000);
    scheduler_add_party(&party);
    for (unsigned q = 0; q < N; q++) {
        scheduler_add_queue(&queue[q], &party);
        e[q] = entry_of(CLASS_BATCH, 1000);
        ask(&scheduler, &queue[q], &e[q]);
    }
    for (unsigned q = 0; q < SCHEDULER_PER_CLASS; q++) {
        assert_ptr_equal(scheduler_next(&scheduler), &e[q]);
        scheduler_stepped(&scheduler, &e[q], 1000, false);
    }
    assert_null(scheduler_next(&scheduler));
    /* batches that are being encoded do not delay other classes */
    ask(&scheduler, &queue[0], &other);
    assert_ptr_equal(scheduler_next(&scheduler), &other);
    draw_whole(&scheduler, &other, 1000);
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[SCHEDULER_PER_CLASS]);
}

/* Frames of one party that wait because nobody reads its sockets do not delay other parties. */
static void test_a_full_class_admits_others(void **state)
{
    (void)state;
    enum { N = SCHEDULER_PER_CLASS };
    struct scheduler scheduler = {0};
    struct schedule_party party;
    struct schedule_queue queue[N], other;
    struct schedule_entry e[N], more = entry_of(CLASS_INTERACTIVE, 1000), theirs[3];
    scheduler_add_party(&party);
    add_queue(&other);
    for (unsigned q = 0; q < N; q++) {
        scheduler_add_queue(&queue[q], &party);
        e[q] = view_of(CLASS_INTERACTIVE, 1);
        ask(&scheduler, &queue[q], &e[q]);
        assert_ptr_equal(scheduler_next(&scheduler), &e[q]);
        scheduler_stepped(&scheduler, &e[q], 1000, false);
        assert_null(scheduler_hold(&e[q]));
    }
    ask(&scheduler, &queue[0], &more);
    assert_null(scheduler_next(&scheduler));
    for (unsigned i = 0; i < 3; i++) {
        theirs[i] = entry_of(CLASS_INTERACTIVE, 1000);
        ask(&scheduler, &other, &theirs[i]);
    }
    for (unsigned i = 0; i < SCHEDULER_PER_PARTY; i++) {
        assert_ptr_equal(scheduler_next(&scheduler), &theirs[i]);
        scheduler_stepped(&scheduler, &theirs[i], 1000, false);
    }
    assert_null(scheduler_next(&scheduler));
    scheduler_finished(&scheduler, &theirs[0]);
    assert_ptr_equal(scheduler_next(&scheduler), &theirs[2]);
    draw_whole(&scheduler, &theirs[2], 1000);
    scheduler_finished(&scheduler, &theirs[1]);
    for (unsigned q = 0; q < N; q++)
        scheduler_finished(&scheduler, &e[q]);
    assert_ptr_equal(scheduler_next(&scheduler), &more);
    draw_whole(&scheduler, &more, 1000);
    assert_is_empty(&scheduler);
}

static void test_held_session_is_passed_over(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue a, b;
    struct schedule_entry ea = entry_of(CLASS_STILL, 1), eb = entry_of(CLASS_STILL, 1);
    add_queue(&a);
    add_queue(&b);
    ask(&scheduler, &a, &ea);
    ask(&scheduler, &b, &eb);
    a.flow[CLASS_STILL].held = true;
    assert_ptr_equal(scheduler_next(&scheduler), &eb);
    draw_whole(&scheduler, &eb, 1);
    assert_null(scheduler_next(&scheduler));
    a.flow[CLASS_STILL].held = false;
    assert_ptr_equal(scheduler_next(&scheduler), &ea);
    a.flow[CLASS_STILL].held = true; /* frames that have begun are finished */
    scheduler_stepped(&scheduler, &ea, 1, true);
    assert_ptr_equal(scheduler_next(&scheduler), &ea);
}

static void test_session_that_goes(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue a, b;
    struct schedule_entry ea[3], eb = entry_of(CLASS_STILL, 1);
    add_queue(&a);
    add_queue(&b);
    for (int i = 0; i < 3; i++) {
        ea[i] = entry_of(CLASS_STILL, 1);
        ask(&scheduler, &a, &ea[i]);
    }
    ask(&scheduler, &b, &eb);
    assert_ptr_equal(scheduler_next(&scheduler), &ea[0]);
    for (int i = 2; i >= 0; i--)
        scheduler_leave(&scheduler, &ea[i]);
    assert_int_equal(scheduler.waiting, 1);
    assert_int_equal(scheduler.classes[CLASS_STILL].begun, 1); /* its tile is on the device */
    scheduler_stepped(&scheduler, &ea[0], 1, true);
    scheduler_finished(&scheduler, &ea[0]);
    assert_ptr_equal(scheduler_next(&scheduler), &eb);
    draw_whole(&scheduler, &eb, 1);
    assert_is_empty(&scheduler);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_order_and_two_begun),
        cmocka_unit_test(test_two_tiles_on_the_device),
        cmocka_unit_test(test_long_tiles_do_not_queue_up),
        cmocka_unit_test(test_tiles_of_a_frame_stay_together),
        cmocka_unit_test(test_newer_request_of_a_view_replaces),
        cmocka_unit_test(test_batches_and_stills_without_a_view_stay),
        cmocka_unit_test(test_faster_than_drawn),
        cmocka_unit_test(test_encoded_frames_are_replaced_while_held),
        cmocka_unit_test(test_bound_of_a_class),
        cmocka_unit_test(test_a_full_class_admits_others),
        cmocka_unit_test(test_held_session_is_passed_over),
        cmocka_unit_test(test_session_that_goes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
