/* The table of limits: names, ranges, defaults, and values in the notation that people use. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/limits.h"
#include "server/output/encode.h"
#include "server/ops/limits.h"

static const struct limits_row *row_of(const char *name)
{
    for (size_t i = 0; i < N_LIMITS; i++)
        if (strcmp(LIMITS[i].name, name) == 0)
            return &LIMITS[i];
    fail_msg("no limit is called %s", name);
    return NULL;
}

static void test_rows(void **state)
{
    (void)state;
    struct limits limits;
    memset(&limits, 0xff, sizeof limits);
    limits_init(&limits);
    /* each member of the struct has a row */
    assert_int_equal(N_LIMITS * sizeof(uint64_t), sizeof limits);
    for (size_t i = 0; i < N_LIMITS; i++) {
        const struct limits_row *row = &LIMITS[i];
        assert_true(row->low <= row->fallback && row->fallback <= row->high);
        assert_int_equal(limits_get(&limits, row), row->fallback);
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(row->name, LIMITS[k].name);
            assert_int_not_equal(row->offset, LIMITS[k].offset);
        }
    }
    assert_int_equal(limits.session.idle_s, 900);
    assert_int_equal(limits.session.max_upload, PROTOCOL_MAX_UPLOAD_BYTES);
    assert_true(limits.session.interactive_soft < limits.session.interactive_hard);
    assert_true(limits.session.output_soft < limits.session.output_hard);
}

static void test_values(void **state)
{
    (void)state;
    struct limits limits;
    struct error error = {0};
    const struct limits_row *budget = row_of("memory-budget"), *credits = row_of("credits");
    limits_init(&limits);
    static const struct {
        const char *text;
        uint64_t bytes;
    } good[] = {{"37748736", 37748736},    {"4000000000", 4000000000},
                {"50000K", 50000 << 10},   {"800M", (uint64_t)800 << 20},
                {"4G", (uint64_t)4 << 30}, {"2T", (uint64_t)2 << 40}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_true(limits_set(&limits, budget, good[i].text, &error));
        assert_int_equal(limits.assets.memory_budget, good[i].bytes);
    }
    static const char *const bad[] = {"",
                                      "-1",
                                      "+1",
                                      " 1",
                                      "1 ",
                                      "x",
                                      "1x",
                                      "4g",
                                      "0",
                                      "1",
                                      "4194303",
                                      "4095K",
                                      "4GB",
                                      "1.5G",
                                      "0x1",
                                      "99999999999T",
                                      "99999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_false(limits_set(&limits, budget, bad[i], &error));
        assert_int_equal(error.kind, ERROR_REQUEST);
        assert_non_null(strstr(error.text, "memory-budget is '"));
        assert_non_null(strstr(error.text, bad[i]));
        assert_int_equal(limits.assets.memory_budget, (uint64_t)2 << 40);
    }
    assert_true(limits_set(&limits, credits, "64", &error));
    assert_false(limits_set(&limits, credits, "65", &error));
    assert_non_null(strstr(error.text, "credits is '65'; it must be a whole number from 1 to 64"));
    assert_false(limits_set(&limits, credits, "1K", &error)); /* not a number of bytes */
    assert_int_equal(limits.session.credits, 64);
}

/* A limit with which the daemon could serve nobody is refused by its name; the least allowed value
 * is accepted. */
static void test_least_bytes(void **state)
{
    (void)state;
    static const struct {
        const char *name, *least, *less;
    } cases[] = {
        {"memory-budget", "36M", "37748735"}, {"peer-memory", "4M", "4194303"},
        {"spare-memory", "0", "-1"},          {"max-upload", "64K", "65535"},
        {"max-frame", "1228800", "1228799"},  {"interactive-hard", "64K", "65535"},
        {"interactive-soft", "64K", "65535"}, {"output-hard", "64K", "65535"},
        {"output-soft", "64K", "65535"},      {"worker-memory", "1M", "1048575"},
        {"worker-output", "1M", "1048575"},
    };
    size_t n_bytes = 0;
    for (size_t i = 0; i < N_LIMITS; i++)
        n_bytes += LIMITS[i].unit == UNIT_BYTES;
    assert_int_equal(n_bytes, sizeof cases / sizeof *cases);
    for (size_t i = 0; i < n_bytes; i++) {
        const struct limits_row *row = row_of(cases[i].name);
        struct limits limits;
        struct error error = {0};
        limits_init(&limits);
        assert_int_equal(row->unit, UNIT_BYTES);
        assert_true(limits_set(&limits, row, cases[i].least, &error));
        assert_false(limits_set(&limits, row, cases[i].less, &error));
        assert_non_null(strstr(error.text, cases[i].name));
        assert_int_equal(limits_get(&limits, row), row->low);
    }
}

/* The least memory of a client holds a frame of 640 x 480 pixels in every encoding; the least memory for planes
 * holds the colour of such a frame. */
static void test_least_memory_holds_a_frame(void **state)
{
    (void)state;
    struct codec_layout layout;
    codec_layout_init(&layout, 640, 480, sheen_Plane_PLANE_COLOUR);
    assert_int_equal(row_of("max-frame")->low, layout.raw_bytes);
    for (int e = _sheen_Encoding_MIN; e <= (int)_sheen_Encoding_MAX; e++) {
        const struct encode_format format = {(sheen_Encoding)e, JPEG_DEFAULTS};
        uint64_t bytes = layout.raw_bytes + encode_bytes(&layout, &format);
        assert_true(bytes <= row_of("peer-memory")->low);
    }
}

static void test_formats(void **state)
{
    (void)state;
    char text[LIMITS_TEXT_BYTES];
    const struct limits_row *budget = row_of("memory-budget");
    static const struct {
        uint64_t bytes;
        const char *text;
    } cases[] = {{0, "0"},
                 {1023, "1023"},
                 {1024, "1K"},
                 {1536, "1536"},
                 {(uint64_t)3 << 30, "3G"},
                 {(uint64_t)5 << 50, "5120T"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        limits_format(budget, cases[i].bytes, text);
        assert_string_equal(text, cases[i].text);
    }
    limits_format(row_of("credits"), 1024, text);
    assert_string_equal(text, "1024");
    char range[LIMITS_RANGE_BYTES];
    limits_range(budget, range);
    assert_string_equal(range, "36M or more");
    limits_range(row_of("max-upload"), range);
    assert_string_equal(range, "64K to 1G");
    assert_string_equal(limits_argument(budget), "BYTES");
    assert_string_equal(limits_argument(row_of("idle-timeout")), "SECONDS");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows),        cmocka_unit_test(test_values),
        cmocka_unit_test(test_least_bytes), cmocka_unit_test(test_least_memory_holds_a_frame),
        cmocka_unit_test(test_formats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
