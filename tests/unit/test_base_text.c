/* Hexadecimal digits and quoted texts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/hex.h"
#include "server/base/quote.h"

static void test_hex_both_ways(void **state)
{
    (void)state;
    uint8_t bytes[256], back[256];
    char text[2 * sizeof bytes + 1], wanted[3];
    for (unsigned i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)i;
    hex_write(bytes, sizeof bytes, text);
    for (unsigned i = 0; i < sizeof bytes; i++) {
        snprintf(wanted, sizeof wanted, "%02x", i);
        assert_memory_equal(text + 2 * i, wanted, 2);
    }
    assert_int_equal(strlen(text), 2 * sizeof bytes);
    assert_true(hex_read(text, back, sizeof back));
    assert_memory_equal(back, bytes, sizeof bytes);
}

static void test_hex_refuses(void **state)
{
    (void)state;
    uint8_t bytes[2];
    static const char *const bad[] = {"",     "00",   "00112", "001122", "00F1",
                                      "0g11", "00 1", "/011",  ":011"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (hex_read(bad[i], bytes, sizeof bytes))
            fail_msg("'%s' was taken", bad[i]);
    assert_true(hex_read("00f1", bytes, sizeof bytes));
}

static void quote(enum quote_form form, const char *text, char *quoted)
{
    for (*quoted = 0; *text; quoted += strlen(quoted))
        text += quote_character(form, text, quoted);
}

static void test_quotes(void **state)
{
    (void)state;
    static const struct {
        const char *text, *json, *metrics;
    } cases[] = {
        {"plain /path-1", "plain /path-1", "plain /path-1"},
        {"a\"b\\c", "a\\\"b\\\\c", "a\\\"b\\\\c"},
        {"a\nb\tc\x7f", "a\\u000ab\\u0009c\\u007f", "a\\nb?c?"},
        {"\x1b[2J", "\\u001b[2J", "?[2J"},
        {"Kotfl\xc3\xbcgel \xe2\x82\xac \xf0\x9f\x9a\x97",
         "Kotfl\xc3\xbcgel \xe2\x82\xac \xf0\x9f\x9a\x97",
         "Kotfl\xc3\xbcgel \xe2\x82\xac \xf0\x9f\x9a\x97"},
        {"\u202egnp.obj a\u2028b\u2029", "\\u202egnp.obj a\\u2028b\\u2029", "?gnp.obj a?b?"},
        {"tag\U000e0041\U000e007f.", "tag\\udb40\\udc41\\udb40\\udc7f.", "tag??."},
        /* neither a tag character nor a separator */
        {"\U000e0080\u2027", "\U000e0080\u2027", "\U000e0080\u2027"},
        {"cut \xc3", "cut ?", "cut ?"},
        {"\xff\xc3\xbc\xc0\x80", "?\xc3\xbc??", "?\xc3\xbc??"},
        {"\xc2\x85", "??", "??"}, /* a control character above ASCII */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char quoted[200];
        quote(QUOTE_JSON, cases[i].text, quoted);
        assert_string_equal(quoted, cases[i].json);
        quote(QUOTE_METRICS, cases[i].text, quoted);
        assert_string_equal(quoted, cases[i].metrics);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hex_both_ways),
        cmocka_unit_test(test_hex_refuses),
        cmocka_unit_test(test_quotes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
