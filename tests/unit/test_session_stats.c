/* Histograms, against sorted lists; and which values of the last minute are kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/session/stats.h"

#define N 5000

static int compare(const void *a, const void *b)
{
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

/* Values distributed over all octaves, from a generator with a fixed seed, so that every run is the
 * same. */
static void fill(struct histogram *histogram, uint64_t *values)
{
    uint64_t state = 12345;
    *histogram = (struct histogram){0};
    for (int i = 0; i < N; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        values[i] = state >> 33 >> (state >> 20) % 30;
        histogram_add(histogram, values[i]);
    }
    qsort(values, N, sizeof *values, compare);
}

static void test_percentiles(void **test_state)
{
    (void)test_state;
    static struct histogram histogram;
    static uint64_t values[N];
    fill(&histogram, values);
    assert_int_equal(histogram.n, N);
    for (double p = 0.01; p < 1; p += 0.01) {
        uint64_t found = histogram_percentile(&histogram, p), exact = values[(int)(p * N)];
        uint64_t error = found > exact ? found - exact : exact - found;
        /* 1 part in 32, and the distance of the neighbouring value where two values are far
         * apart */
        uint64_t gap = values[(int)(p * N)] - values[(int)(p * N) - 1];
        assert_true(error <= exact / 31 + gap);
    }
}

static void test_below_is_exact_at_powers_of_two(void **test_state)
{
    (void)test_state;
    static struct histogram histogram;
    static uint64_t values[N];
    fill(&histogram, values);
    for (unsigned exponent = 0; exponent < HISTOGRAM_OCTAVES; exponent++) {
        uint64_t n = 0;
        while (n < N && values[n] < 1ull << exponent)
            n++;
        assert_int_equal(histogram_below(&histogram, exponent), n);
    }
}

static void test_ends(void **test_state)
{
    (void)test_state;
    struct histogram histogram = {0};
    assert_int_equal(histogram_percentile(&histogram, 0.5), 0);
    histogram_add(&histogram, UINT64_MAX / 2);
    assert_true(histogram_percentile(&histogram, 0.5) > 1ull << (HISTOGRAM_OCTAVES - 1));
    struct histogram small = {0};
    for (uint64_t us = 0; us < HISTOGRAM_SUB; us++) {
        small = (struct histogram){0};
        histogram_add(&small, us);
        assert_int_equal(histogram_percentile(&small, 1), us);
    }
}

static void test_mean_of_the_last(void **test_state)
{
    (void)test_state;
    static struct stats stats;
    stats_init(&stats);
    assert_int_equal(stats_mean(&stats).total_us, 0);
    const sheen_Times slow = {.total_us = 1000000}, fast = {.total_us = 10, .encode_us = 4};
    stats_frame(&stats, CLASS_STILL, &slow, stats.start_us);
    stats_frame(&stats, CLASS_STILL, &fast, stats.start_us);
    assert_int_equal(stats_mean(&stats).total_us, 500005);
    for (int i = 0; i < STATS_FRAMES; i++)
        stats_frame(&stats, CLASS_STILL, &fast, stats.start_us);
    assert_int_equal(stats_mean(&stats).total_us, 10);
    assert_int_equal(stats_mean(&stats).encode_us, 4);
    assert_int_equal(stats.stage[STAGE_TOTAL].n, STATS_FRAMES + 2);
    assert_int_equal(stats.stage[STAGE_ENCODE].n, STATS_FRAMES + 1);
    assert_int_equal(stats.stage[STAGE_TABLES].n, 0);
}

static void answered_class(struct stats *stats, enum request_class request_class, uint64_t total_us,
                           uint64_t now_us)
{
    const sheen_Times times = {.total_us = total_us};
    stats_reply(stats, MESSAGE_FRAME, sheen_ErrorCode_ERROR_NONE, now_us);
    stats_frame(stats, request_class, &times, now_us);
}

static void answered(struct stats *stats, uint64_t total_us, uint64_t now_us)
{
    answered_class(stats, CLASS_STILL, total_us, now_us);
}

static void test_the_last_minute(void **test_state)
{
    (void)test_state;
    static struct stats stats;
    struct stats_recent recent;
    stats_init(&stats);
    const uint64_t start = stats.start_us, second = 1000000;
    stats_recent(&stats, start, &recent);
    assert_int_equal(recent.window_us + recent.frames + recent.p50.total_us, 0);

    for (unsigned i = 0; i < 100; i++)
        answered(&stats, 8, start + i * second / 10);
    stats_reply(&stats, MESSAGE_ERROR, sheen_ErrorCode_ERROR_MODEL, start + 11 * second);
    stats_recent(&stats, start + 20 * second, &recent);
    assert_int_equal(recent.window_us, 20 * second);
    assert_int_equal(recent.frames, 100);
    assert_int_equal(recent.requests, 101);
    assert_int_equal(recent.p50.total_us, 8);
    assert_int_equal(stats.error_codes[sheen_ErrorCode_ERROR_MODEL], 1);

    /* At 60 s the first slice is dropped, and its frames no longer count in any percentile. */
    answered(&stats, 2, start + 59 * second);
    stats_recent(&stats, start + 59 * second, &recent);
    assert_int_equal(recent.frames, 101);
    stats_recent(&stats, start + 60 * second, &recent);
    assert_int_equal(recent.window_us, 50 * second);
    assert_int_equal(recent.frames, 1);
    assert_int_equal(recent.p99.total_us, 2);
    /* The sums since the start remain. */
    assert_int_equal(stats.frames, 101);
    assert_int_equal(stats.stage[STAGE_TOTAL].n, 101);

    /* After a long pause, old slices do not count as new ones. */
    stats_recent(&stats, start + 3600 * second, &recent);
    assert_int_equal(recent.frames + recent.requests, 0);
    answered(&stats, 4, start + 3600 * second);
    stats_recent(&stats, start + 3600 * second, &recent);
    assert_int_equal(recent.frames, 1);
}

static void test_latency_by_class(void **test_state)
{
    (void)test_state;
    static struct stats stats;
    struct stats_recent recent;
    stats_init(&stats);
    const uint64_t start = stats.start_us, second = 1000000;
    for (uint64_t i = 1; i <= 100; i++)
        answered_class(&stats, CLASS_INTERACTIVE, i <= 50 ? 8 : i <= 95 ? 10 : 12, start);
    answered_class(&stats, CLASS_BATCH, 15, start + 30 * second);
    stats_recent(&stats, start + 30 * second, &recent);
    const sheen_Latency *interactive = &recent.latency[CLASS_INTERACTIVE];
    assert_int_equal(interactive->frames, 100);
    assert_int_equal(interactive->p50_us, 8);
    assert_int_equal(interactive->p95_us, 10);
    assert_int_equal(interactive->p99_us, 12);
    assert_int_equal(recent.latency[CLASS_STILL].frames, 0);
    assert_int_equal(recent.latency[CLASS_STILL].p99_us, 0);
    assert_int_equal(recent.latency[CLASS_BATCH].frames, 1);
    assert_int_equal(recent.latency[CLASS_BATCH].p50_us, 15);
    /* The interactive frames have become too old. */
    stats_recent(&stats, start + 70 * second, &recent);
    assert_int_equal(recent.latency[CLASS_INTERACTIVE].frames, 0);
    assert_int_equal(recent.latency[CLASS_BATCH].frames, 1);
}

static void test_sent_bytes(void **test_state)
{
    (void)test_state;
    static struct stats stats;
    struct stats_recent recent;
    stats_init(&stats);
    const uint64_t start = stats.start_us, second = 1000000;
    answered_class(&stats, CLASS_STILL, 8, start);
    stats.sent_bytes += 1000; /* incremented as a connection does it */
    stats_recent(&stats, start + second, &recent);
    assert_int_equal(recent.sent_bytes, 1000);
    answered_class(&stats, CLASS_STILL, 8, start + 35 * second);
    stats.sent_bytes += 70;
    answered_class(&stats, CLASS_STILL, 8, start + 45 * second);
    stats.sent_bytes += 5;
    stats_recent(&stats, start + 50 * second, &recent);
    assert_int_equal(recent.sent_bytes, 1075);
    /* Bytes sent before the window count in the sum only. */
    stats_recent(&stats, start + 65 * second, &recent);
    assert_int_equal(recent.sent_bytes, 75);
    stats_recent(&stats, start + 99 * second, &recent);
    assert_int_equal(recent.sent_bytes, 5);
    stats_recent(&stats, start + 3600 * second, &recent);
    assert_int_equal(recent.sent_bytes, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_percentiles),
        cmocka_unit_test(test_below_is_exact_at_powers_of_two),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_mean_of_the_last),
        cmocka_unit_test(test_the_last_minute),
        cmocka_unit_test(test_latency_by_class),
        cmocka_unit_test(test_sent_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
