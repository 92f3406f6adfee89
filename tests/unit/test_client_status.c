/* Which characters of error texts reach a terminal. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "client/lib/status.h"

static void expect_text(const char *given, const char *shown)
{
    struct sheen_error error;
    assert_int_equal(status_set(&error, SHEEN_BAD_MODEL, "%s", given), SHEEN_BAD_MODEL);
    assert_string_equal(error.text, shown);
}

/* All characters of one to three bytes: those that are control characters, change the writing
 * direction or end a line are hidden, all others are not. */
static void controls_are_hidden(void **state)
{
    (void)state;
    for (unsigned code = 1; code < 0x10000; code++) {
        if (code >= 0xd800 && code < 0xe000)
            continue; /* surrogates, which are no characters */
        bool hidden = code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c ||
                      code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
                      (code >= 0x2066 && code <= 0x2069);
        char text[16];
        int n = code < 0x80 ? snprintf(text, sizeof text, "a%cz", code)
                : code < 0x800
                    ? snprintf(text, sizeof text, "a%c%cz", 0xc0 | code >> 6, 0x80 | (code & 0x3f))
                    : snprintf(text, sizeof text, "a%c%c%cz", 0xe0 | code >> 12,
                               0x80 | (code >> 6 & 0x3f), 0x80 | (code & 0x3f));
        assert_true(n > 2);
        expect_text(text, hidden ? "a?z" : text);
    }
    expect_text("\U0001F697\u202e\xc2\x9b"
                "31m",
                "\U0001F697??31m");
    expect_text("a\U000e0000b\U000e007fc\U000e0080", "a?b?c\U000e0080"); /* tag characters */
}

static void bytes_that_are_no_text_are_hidden(void **state)
{
    (void)state;
    expect_text("latin\xfc", "latin?");
    expect_text("\x9b"
                "31m",
                "?31m");
    expect_text("end\xe2\x80", "end??");
    expect_text("end\xc2", "end?");
    expect_text("\xc0\x9b\xe0\x82\x9b.", "?????.");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(controls_are_hidden),
        cmocka_unit_test(bytes_that_are_no_text_are_hidden),
    };
    return cmocka_run_group_tests_name("client/status", tests, NULL, NULL);
}
