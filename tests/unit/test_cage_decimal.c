/* decimal_read(): every number is the double nearest to its text. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/cage/read/numbers/decimal.h"

static locale_t c_locale;

static int setup(void **state)
{
    (void)state;
    c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    return c_locale ? 0 : -1;
}

static int teardown(void **state)
{
    (void)state;
    freelocale(c_locale);
    return 0;
}

static void expect_number(const char *text)
{
    double value = NAN, expected = strtod(text, NULL);
    assert_int_equal(decimal_read(text, strlen(text), c_locale, &value), DECIMAL_OK);
    if (memcmp(&value, &expected, sizeof value) != 0)
        fail_msg("%s read as %.17g, is %.17g", text, value, expected);
}

static void test_decimals(void **state)
{
    (void)state;
    static const char *const good[] = {
        "0",
        "-0",
        "+1",
        "1.",
        ".5",
        "-.5e1",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "123456789.125",
        "9007199254740992",
        "9007199254740993",
        "9007199254740993e0",
        "0.1",
        "0.3",
        "1e0",
        "1E+05",
        "1e-400",
        "0e999999999999",
        "1.7976931348623157e308",
        "4.9406564584124654e-324",
        "2.2250738585072011e-308",
        "18446744073709551615",
        "18446744073709551616",
        "184467440737095516150",
        "1844674407370955161.55",
        "3.14159265358979323846264338327950288",
        "0.000000000000000000000000000000000000000123",
        "8.5e-0005",
        "00000000000000000000000012",
        "1.00000000000000011102230246251565404236316680908203125",
        "1.00000000000000011102230246251565404236316680908203124",
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        expect_number(good[i]);
}

static void test_random_decimals(void **state)
{
    (void)state;
    static const char *const formats[] = {"%.17g", "%.9g", "%f", "%.3f", "%e", "%.15e", "%.25g"};
    uint64_t random = 88172645463325252u;
    for (int i = 0; i < 200000; i++) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        double value;
        if (i % 2) {
            memcpy(&value, &random, sizeof value);
            if (!isfinite(value) || fabs(value) > 1e300)
                continue;
        } else {
            value = (double)(int64_t)random * 0x1p-60 * (i % 1000);
        }
        char text[400];
        snprintf(text, sizeof text, formats[i % 7], value);
        expect_number(text);
    }
}

static void test_bad_decimals(void **state)
{
    (void)state;
    static const char *const bad[] = {"",    "-",   "+",    ".",    "e5",      "1e",
                                      "1e+", "1,5", "0x10", "1 ",   "--1",     "1.2.3",
                                      "abc", "1f",  "1e5.", "nano", "infinite"};
    static const char *const infinite[] = {"nan",    "-nan",    "NaN",      "-nan(ind)",
                                           "inf",    "+Inf",    "infinity", "1e309",
                                           "-1e400", "1.#QNAN", "-1.#IND"};
    double value = 42;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (decimal_read(bad[i], strlen(bad[i]), c_locale, &value) != DECIMAL_BAD)
            fail_msg("'%s' taken", bad[i]);
    for (size_t i = 0; i < sizeof infinite / sizeof *infinite; i++)
        if (decimal_read(infinite[i], strlen(infinite[i]), c_locale, &value) != DECIMAL_NOT_FINITE)
            fail_msg("'%s' taken", infinite[i]);
    char digits[2000];
    memset(digits, '1', sizeof digits);
    assert_int_equal(decimal_read(digits, sizeof digits, c_locale, &value), DECIMAL_BAD);
    assert_true(value == 42);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_decimals),
        cmocka_unit_test(test_random_decimals),
        cmocka_unit_test(test_bad_decimals),
    };
    return cmocka_run_group_tests_name("cage/decimal", tests, setup, teardown);
}
