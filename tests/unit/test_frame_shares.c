/* The scheduler's shares, on a simulated device whose time is a number: equal shares of time, and
 * no request that waits for ever. */
#include "server/frame/costs.h"
#include "tests/unit/schedule_entries.h"

/* Each session always has its next frame ready. */
enum { MOST_SESSIONS = 72, PER_SESSION = 2 };

struct client {
    struct schedule_queue queue;
    struct schedule_entry entry[PER_SESSION];
    unsigned tiles[PER_SESSION]; /* tiles that are left of the frame */
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

/* `party` NULL: the client is the only one of its party. */
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

/* Parties have equal shares, however many connections they have; within a party its connections
 * have equal shares. */
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
        /* one turn of each party, while each may be two frames ahead */
        assert_true(one->longest_wait_us < 40000);
        free(device);
    }
}

/* With 64 interactive clients and 8 batch clients, the batches get one fifth of the time, in equal
 * shares. */
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
    /* two frames of each other client, and the batches' fifth between them */
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

/* Without interactive work, stills come before batches, which keep their fifth. A class that is
 * alone gets all the time, and has no disadvantage later because of that. */
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

/* An interactive request that arrives alone, while batches are drawn, waits only for the tile that
 * is on the device. */
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

/* A client with one request at a time gets its share, too. A client that rarely asks does not wait
 * behind everything that busy clients have queued. */
static void test_rare_ones_are_served_at_once(void **state)
{
    (void)state;
    struct device *device = calloc(1, sizeof *device);
    /* so that two frames of each can begin */
    for (unsigned i = 0; 2 * i + 2 < SCHEDULER_PER_CLASS; i++)
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
        assert_true(before <= SCHEDULER_PER_CLASS); /* a turn is a tile, not a frame */
        draw_whole(&device->scheduler, &rare, 1000);
    }
    free(device);
}

/* A frame of several tiles of a client that rarely asks is drawn without interruption beside busy
 * clients. A frame that is longer than the share that can be saved up shares the rest of its
 * time. */
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
                /* the scheduler is asked again while the tile is drawn */
                assert_null(scheduler_next(&device->scheduler));
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
            assert_true(others <= 3); /* a tile whose turn was counted already */
        else
            assert_in_range(others, 3 * (20 - 8), 3 * (20 - 5)); /* a quarter of the time */
    }
    free(device);
}

/* A wrong estimate is corrected by the measured time. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sessions_share_time_not_frames),
        cmocka_unit_test(test_parties_share_before_sessions),
        cmocka_unit_test(test_batches_keep_a_fifth),
        cmocka_unit_test(test_three_classes),
        cmocka_unit_test(test_shares_of_what_is_wanted),
        cmocka_unit_test(test_interactive_waits_for_one_tile),
        cmocka_unit_test(test_rare_ones_are_served_at_once),
        cmocka_unit_test(test_rare_frames_are_not_interrupted),
        cmocka_unit_test(test_lies_about_costs_do_not_pay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
