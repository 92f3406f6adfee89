/* The scheduler alone, on a device whose time is a number: latest wins, turns, shares, fairness by
 * time, and that nobody waits for ever. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/frame/costs.h"
#include "server/frame/scheduler.h"

static struct schedule_entry entry_of(enum request_class request_class, uint64_t estimate_us)
{
    return (struct schedule_entry){.request_class = request_class, .estimate_us = estimate_us};
}

static struct schedule_entry view_of(enum request_class request_class, uint32_t view)
{
    return (struct schedule_entry){
        .request_class = request_class, .has_view = true, .view = view, .estimate_us = 1000};
}

/* The session of a client that has no other. */
static void add_queue(struct schedule_queue *queue)
{
    static struct schedule_party parties[1024];
    static unsigned n;
    struct schedule_party *party = &parties[n++ % 1024];
    scheduler_add_party(party);
    scheduler_add_queue(queue, party);
}

static void ask(struct scheduler *scheduler, struct schedule_queue *queue,
                struct schedule_entry *entry)
{
    assert_null(scheduler_enter(scheduler, queue, entry));
    scheduler_ready(entry);
}

/* Draws one tile, the whole frame, and gives it back. */
static void draw_whole(struct scheduler *scheduler, struct schedule_entry *entry, uint64_t us)
{
    scheduler_stepped(scheduler, entry, us, false);
    scheduler_finished(scheduler, entry);
}

static void assert_is_empty(const struct scheduler *scheduler)
{
    assert_int_equal(scheduler->waiting + scheduler->on_device, 0);
    for (int c = 0; c < N_CLASSES; c++) {
        assert_null(scheduler->classes[c].parts.first);
        assert_int_equal(scheduler->classes[c].begun, 0);
    }
}

static void test_empty(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    assert_null(scheduler_next(&scheduler));
    struct schedule_queue queue;
    struct schedule_entry entry = entry_of(CLASS_STILL, 1);
    add_queue(&queue);
    assert_null(scheduler_enter(&scheduler, &queue, &entry));
    assert_null(scheduler_next(&scheduler)); /* it waits for its model */
    assert_int_equal(scheduler.waiting, 1);
    scheduler_leave(&scheduler, &entry);
    scheduler_leave(&scheduler, &entry); /* once is enough */
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
    assert_null(scheduler_next(&scheduler)); /* one tile at a time */
    scheduler_stepped(&scheduler, &e[0], 1000, false);
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    scheduler_stepped(&scheduler, &e[1], 1000, false);
    assert_null(scheduler_next(&scheduler)); /* both are being encoded */
    scheduler_finished(&scheduler, &e[1]);   /* the second may end first */
    assert_ptr_equal(scheduler_next(&scheduler), &e[2]);
    scheduler_stepped(&scheduler, &e[2], 1000, false);
    scheduler_finished(&scheduler, &e[0]);
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[3]);
    draw_whole(&scheduler, &e[3], 1000);
    assert_is_empty(&scheduler);
}

/* A second tile waits on the device only where nothing more urgent can come. */
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
    assert_null(scheduler_next(&scheduler)); /* a still does not queue up behind a batch's tile */
    ask(&scheduler, &queue[1], &interactive[0]);
    ask(&scheduler, &queue[2], &interactive[1]);
    struct schedule_entry next_frame = view_of(CLASS_INTERACTIVE, 1);
    ask(&scheduler, &queue[1], &next_frame);
    assert_ptr_equal(scheduler_next(&scheduler), &interactive[0]);
    assert_null(scheduler_next(&scheduler)); /* two are enough */
    scheduler_stepped(&scheduler, &batch, 1000, true);
    scheduler_leave(&scheduler, &batch);
    scheduler_leave(&scheduler, &still);
    assert_ptr_equal(scheduler_next(&scheduler), &interactive[1]);
    scheduler_stepped(&scheduler, &interactive[1], 1000, false);
    /* A session's next frame begins, and stops being replaceable, when the one before is drawn. */
    assert_null(scheduler_next(&scheduler));
    scheduler_stepped(&scheduler, &interactive[0], 1000, false);
    assert_ptr_equal(scheduler_next(&scheduler), &next_frame);
}

/* Beside an interactive tile a second one only where both are short: who comes meanwhile is next. */
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
    scheduler_put_back(&scheduler, &e[1]); /* has used nothing of what may be ahead */
    scheduler_leave(&scheduler, &e[1]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[2]);
    ask(&scheduler, &queue[3], &late);
    assert_null(scheduler_next(&scheduler));
    draw_whole(&scheduler, &e[2], 9000);
    assert_ptr_equal(scheduler_next(&scheduler), &late); /* a long one is drawn all the same */
    draw_whole(&scheduler, &late, 9000);
    assert_is_empty(&scheduler);
    assert_int_equal(scheduler.ahead_us, 0);
}

/* --- latest wins */

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
    ask(&scheduler, &other, &e[5]); /* the same number of another session is another view */
    assert_ptr_equal(scheduler_next(&scheduler), &e[0]);
    assert_null(scheduler_enter(&scheduler, &queue, &e[1])); /* e[0] has begun */
    assert_ptr_equal(scheduler_enter(&scheduler, &queue, &e[2]), &e[1]);
    assert_int_equal(e[1].state, SCHEDULE_OUT);
    e[3].view = 8;
    assert_null(scheduler_enter(&scheduler, &queue, &e[3])); /* another view */
    e[4].request_class = CLASS_STILL; /* of the same view: it is newer all the same */
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
    ask(&scheduler, &queue, &zero); /* a still without a view is not one of view 0 */
    assert_int_equal(scheduler.waiting, 6);
}

/* Requests that come faster than they are drawn: what has begun is finished, and of the others only
 * the newest is. Every one ends exactly once. */
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
            assert_ptr_equal(drawing, &e[i]); /* always the newest */
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
    assert_null(scheduler_hold(&e[0])); /* nothing newer: kept */
    queue.flow[CLASS_INTERACTIVE].held = true;
    assert_ptr_equal(scheduler_enter(&scheduler, &queue, &e[1]), &e[0]);
    scheduler_ready(&e[1]);
    assert_null(scheduler_next(&scheduler)); /* the socket is full */
    queue.flow[CLASS_INTERACTIVE].held = false;
    assert_ptr_equal(scheduler_next(&scheduler), &e[1]);
    scheduler_stepped(&scheduler, &e[1], 1000, false);
    ask(&scheduler, &queue, &e[2]);
    assert_ptr_equal(scheduler_hold(&e[1]), &e[2]); /* out of date already */
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
    ask(&scheduler, &queue[0], &other); /* batches that are being encoded hold no other class up */
    assert_ptr_equal(scheduler_next(&scheduler), &other);
    draw_whole(&scheduler, &other, 1000);
    scheduler_finished(&scheduler, &e[2]);
    assert_ptr_equal(scheduler_next(&scheduler), &e[SCHEDULER_PER_CLASS]);
}

/* Frames of one party that wait for sockets, which nobody reads, keep no other party out. */
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
    a.flow[CLASS_STILL].held = true; /* what has begun goes on */
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

/* --- shares and fairness: sessions that always have the next frame ready */

enum { MOST_SESSIONS = 72, PER_SESSION = 2 };

struct client {
    struct schedule_queue queue;
    struct schedule_entry entry[PER_SESSION];
    unsigned tiles[PER_SESSION]; /* left of the frame */
    enum request_class request_class;
    uint64_t tile_us;
    unsigned tiles_of_frame;
    uint64_t used_us, frames, longest_wait_us, asked_us[PER_SESSION];
};

struct device {
    struct scheduler scheduler;
    struct costs costs;
    struct client client[MOST_SESSIONS];
    int n_clients;
    uint64_t now_us;
};

static void client_asks(struct device *device, struct client *client, int i)
{
    struct schedule_entry *entry = &client->entry[i];
    *entry = entry_of(client->request_class, 0);
    entry->owner = client;
    entry->estimate_us = costs_estimate(&device->costs, (uint64_t)(uintptr_t)client, 1000);
    client->tiles[i] = client->tiles_of_frame;
    client->asked_us[i] = device->now_us;
    ask(&device->scheduler, &client->queue, entry);
}

/* `party` NULL: a client that is alone in its own. */
static struct client *add_client_of(struct device *device, struct schedule_party *party,
                                    enum request_class request_class, uint64_t tile_us,
                                    unsigned tiles_of_frame)
{
    struct client *client = &device->client[device->n_clients++];
    client->request_class = request_class;
    client->tile_us = tile_us;
    client->tiles_of_frame = tiles_of_frame;
    if (party)
        scheduler_add_queue(&client->queue, party);
    else
        add_queue(&client->queue);
    for (int i = 0; i < PER_SESSION; i++)
        client_asks(device, client, i);
    return client;
}

static struct client *add_client(struct device *device, enum request_class request_class,
                                 uint64_t tile_us, unsigned tiles_of_frame)
{
    return add_client_of(device, NULL, request_class, tile_us, tiles_of_frame);
}

static void run_device(struct device *device, uint64_t until_us)
{
    while (device->now_us < until_us) {
        struct schedule_entry *entry = scheduler_next(&device->scheduler);
        assert_non_null(entry);
        struct client *client = entry->owner;
        int i = (int)(entry - client->entry);
        if (client->tiles[i] == client->tiles_of_frame) {
            uint64_t waited = device->now_us - client->asked_us[i];
            if (waited > client->longest_wait_us)
                client->longest_wait_us = waited;
        }
        device->now_us += client->tile_us;
        client->used_us += client->tile_us;
        costs_learn(&device->costs, (uint64_t)(uintptr_t)client, 1000, client->tile_us);
        bool more = --client->tiles[i] > 0;
        scheduler_stepped(&device->scheduler, entry, client->tile_us, more);
        if (more)
            continue;
        client->frames++;
        scheduler_finished(&device->scheduler, entry);
        client_asks(device, client, i);
    }
}

static uint64_t class_us(const struct device *device, enum request_class request_class)
{
    uint64_t us = 0;
    for (int i = 0; i < device->n_clients; i++)
        us += device->client[i].request_class == request_class ? device->client[i].used_us : 0;
    assert_int_equal(us, device->scheduler.classes[request_class].spent_us);
    return us;
}

static void test_sessions_share_time_not_frames(void **state)
{
    (void)state;
    for (int c = 0; c < N_CLASSES; c++) {
        struct device *device = calloc(1, sizeof *device);
        static const uint64_t costs_us[] = {300, 1000, 5000, 20000, 120000};
        for (size_t i = 0; i < 5; i++)
            add_client(device, (enum request_class)c, costs_us[i], 1 + (unsigned)i % 3);
        run_device(device, 60000000);
        for (int i = 0; i < 5; i++)
            assert_in_range(device->client[i].used_us, 11500000, 12500000);
        free(device);
    }
}

/* Parties have equal shares, however many connections they have, and of a party's share each of its
 * connections has the same. */
static void test_parties_share_before_sessions(void **state)
{
    (void)state;
    for (int c = 0; c < N_CLASSES; c++) {
        struct device *device = calloc(1, sizeof *device);
        struct schedule_party many, few;
        scheduler_add_party(&many);
        scheduler_add_party(&few);
        for (int i = 0; i < 60; i++)
            add_client_of(device, &many, (enum request_class)c, 1000 + 100 * (uint64_t)i, 1);
        add_client_of(device, &few, (enum request_class)c, 7000, 1);
        add_client_of(device, &few, (enum request_class)c, 500, 3);
        struct client *one = add_client(device, (enum request_class)c, 4000, 1);
        run_device(device, 180000000);
        uint64_t of_many = 0;
        for (int i = 0; i < 60; i++) {
            of_many += device->client[i].used_us;
            assert_in_range(device->client[i].used_us, 950000, 1050000);
        }
        assert_in_range(of_many, 59500000, 60500000);
        assert_in_range(device->client[60].used_us, 29500000, 30500000);
        assert_in_range(device->client[61].used_us, 29500000, 30500000);
        assert_in_range(one->used_us, 59500000, 60500000);
        assert_true(one->longest_wait_us < 40000); /* a turn of each party, two frames ahead */
        free(device);
    }
}

/* 64 that drag and 8 that queue: the batches keep their fifth and no more, evenly. */
static void test_batches_keep_a_fifth(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    for (int i = 0; i < 64; i++)
        add_client(device, CLASS_INTERACTIVE, 2000, 1);
    for (int i = 0; i < 8; i++)
        add_client(device, CLASS_BATCH, 8000, 50);
    run_device(device, 60000000);
    assert_in_range(class_us(device, CLASS_BATCH), 11900000, 12200000);
    uint64_t longest = 0;
    for (int i = 0; i < 64; i++) {
        assert_in_range(device->client[i].used_us, 600000, 900000);
        if (device->client[i].longest_wait_us > longest)
            longest = device->client[i].longest_wait_us;
    }
    /* The turns of all others, two frames ahead, and the batches' fifth between. */
    assert_true(longest <= 64 * 2 * 2000 * 10 / 8 + 20000);
    for (int i = 64; i < 72; i++)
        assert_in_range(device->client[i].used_us, 1300000, 1700000);
    free(device);
}

static void test_three_classes(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    add_client(device, CLASS_INTERACTIVE, 5000, 1);
    add_client(device, CLASS_STILL, 8000, 12);
    add_client(device, CLASS_BATCH, 8000, 100);
    run_device(device, 10000000);
    assert_in_range(class_us(device, CLASS_STILL), 1950000, 2100000);
    assert_in_range(class_us(device, CLASS_BATCH), 1950000, 2100000);
    free(device);
}

/* Without interactive work stills go before batches, which keep their fifth; and a class alone has
 * everything, without that being held against it later. */
static void test_shares_of_what_is_wanted(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    struct client *batch = add_client(device, CLASS_BATCH, 8000, 10);
    run_device(device, 10000000);
    assert_int_equal(batch->used_us, 10000000);
    add_client(device, CLASS_STILL, 8000, 5);
    run_device(device, 20000000);
    assert_in_range(batch->used_us - 10000000, 1950000, 2100000);
    free(device);
}

/* An interactive request that comes alone into the batches' time waits for the tile on the device
 * and no other. */
static void test_interactive_waits_for_one_tile(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    for (int i = 0; i < 8; i++)
        add_client(device, CLASS_BATCH, 8000, 50);
    struct schedule_queue queue;
    add_queue(&queue);
    for (int i = 0; i < 100; i++) {
        run_device(device, device->now_us + 50000);
        struct schedule_entry *tile = scheduler_next(&device->scheduler);
        assert_int_equal(tile->request_class, CLASS_BATCH);
        struct schedule_entry interactive = entry_of(CLASS_INTERACTIVE, 2000);
        ask(&device->scheduler, &queue, &interactive);
        assert_ptr_equal(scheduler_next(&device->scheduler), &interactive);
        scheduler_stepped(&device->scheduler, tile, 8000, true);
        draw_whole(&device->scheduler, &interactive, 2000);
    }
    free(device);
}

/* One with one request at a time has its share too, and one that asks rarely does not wait behind
 * all that the busy ones have queued. */
static void test_rare_ones_are_served_at_once(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    for (unsigned i = 0; 2 * i + 2 < SCHEDULER_PER_CLASS; i++) /* two of each have begun */
        add_client(device, CLASS_STILL, 4000, 3);
    struct schedule_queue queue;
    add_queue(&queue);
    for (int i = 0; i < 50; i++) {
        run_device(device, device->now_us + 500000);
        struct schedule_entry rare = entry_of(CLASS_STILL, 1000), *next;
        ask(&device->scheduler, &queue, &rare);
        unsigned before = 0;
        while ((next = scheduler_next(&device->scheduler)) != &rare) {
            struct client *client = next->owner;
            int k = (int)(next - client->entry);
            scheduler_stepped(&device->scheduler, next, client->tile_us, --client->tiles[k] > 0);
            if (client->tiles[k] == 0) {
                scheduler_finished(&device->scheduler, next);
                client_asks(device, client, k);
            }
            before++;
        }
        assert_true(before <= SCHEDULER_PER_CLASS); /* a turn of each, not a frame */
        draw_whole(&device->scheduler, &rare, 1000);
    }
    free(device);
}

/* A frame of several tiles, of a client that asks rarely, is drawn without a break beside those that ask
 * all the time; one that is longer than what can be saved up shares the rest of its time. */
static void test_rare_frames_are_not_interrupted(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    for (int i = 0; i < 3; i++)
        add_client(device, CLASS_INTERACTIVE, 5000, 3);
    struct schedule_queue queue;
    add_queue(&queue);
    for (int tiles = 6; tiles <= 20; tiles += 14) {
        run_device(device, device->now_us + 1000000);
        struct schedule_entry rare = entry_of(CLASS_INTERACTIVE, 5000), *next;
        ask(&device->scheduler, &queue, &rare);
        int drawn = 0, others = 0;
        while (drawn < tiles) {
            next = scheduler_next(&device->scheduler);
            if (next == &rare) {
                assert_null(scheduler_next(&device->scheduler)); /* asked again while it is drawn */
                scheduler_stepped(&device->scheduler, next, 5000, ++drawn < tiles);
                continue;
            }
            struct client *client = next->owner;
            int k = (int)(next - client->entry);
            scheduler_stepped(&device->scheduler, next, client->tile_us, --client->tiles[k] > 0);
            if (client->tiles[k] == 0) {
                scheduler_finished(&device->scheduler, next);
                client_asks(device, client, k);
            }
            others++;
        }
        scheduler_finished(&device->scheduler, &rare);
        if (tiles == 6)
            assert_true(others <= 3); /* a tile that had its turn already */
        else
            assert_in_range(others, 3 * (20 - 8), 3 * (20 - 5)); /* a quarter of the time */
    }
    free(device);
}

/* A wrong estimate is put right by what was measured. */
static void test_lies_about_costs_do_not_pay(void **state)
{
    (void)state;
    struct scheduler scheduler = {0};
    struct schedule_queue queue[2];
    uint64_t used[2] = {0, 0}, took[2] = {10000, 1000};
    struct schedule_entry e[2];
    for (int q = 0; q < 2; q++) {
        add_queue(&queue[q]);
        e[q] = entry_of(CLASS_STILL, q == 0 ? 1 : 1000000);
        ask(&scheduler, &queue[q], &e[q]);
    }
    for (int i = 0; i < 10000; i++) {
        struct schedule_entry *next = scheduler_next(&scheduler);
        int q = next == &e[1];
        used[q] += took[q];
        draw_whole(&scheduler, next, took[q]);
        ask(&scheduler, &queue[q], next);
    }
    assert_in_range(used[0] * 100 / used[1], 95, 105);
}

static void test_costs(void **state)
{
    (void)state;
    static struct costs costs;
    uint64_t a = costs_key(costs_key(0, 1), 2), b = costs_key(costs_key(0, 2), 1);
    assert_true(a != b);
    assert_int_equal(costs_estimate(&costs, a, 1000), COSTS_UNKNOWN_US);
    costs_learn(&costs, a, 1000, 2000);
    assert_in_range(costs_estimate(&costs, a, 500), 999, 1000);
    assert_in_range(costs_estimate(&costs, b, 500), 999, 1000); /* as all do */
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
        cmocka_unit_test(test_empty),
        cmocka_unit_test(test_order_and_two_begun),
        cmocka_unit_test(test_two_tiles_on_the_device),
        cmocka_unit_test(test_long_tiles_do_not_queue_up),
        cmocka_unit_test(test_newer_request_of_a_view_replaces),
        cmocka_unit_test(test_batches_and_stills_without_a_view_stay),
        cmocka_unit_test(test_faster_than_drawn),
        cmocka_unit_test(test_encoded_frames_are_replaced_while_held),
        cmocka_unit_test(test_bound_of_a_class),
        cmocka_unit_test(test_a_full_class_admits_others),
        cmocka_unit_test(test_held_session_is_passed_over),
        cmocka_unit_test(test_session_that_goes),
        cmocka_unit_test(test_sessions_share_time_not_frames),
        cmocka_unit_test(test_parties_share_before_sessions),
        cmocka_unit_test(test_batches_keep_a_fifth),
        cmocka_unit_test(test_three_classes),
        cmocka_unit_test(test_shares_of_what_is_wanted),
        cmocka_unit_test(test_interactive_waits_for_one_tile),
        cmocka_unit_test(test_rare_ones_are_served_at_once),
        cmocka_unit_test(test_rare_frames_are_not_interrupted),
        cmocka_unit_test(test_lies_about_costs_do_not_pay),
        cmocka_unit_test(test_costs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
