/* The JSON writer. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "client/cli/output/json.h"

static void json_is_json(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    struct json json = {.out = open_memstream(&text, &size)};
    const double v[3] = {0.1, NAN, -INFINITY};
    json_object_begin(&json, NULL);
    json_text(&json, "name", "a\"b\\c\nd\x01\x7f\xc3\xbc\xff\xc3");
    json_uint(&json, "n", UINT64_MAX);
    json_bool(&json, "yes", true);
    json_vec3(&json, "v", v);
    json_double(&json, "all digits", 0.1 + 0.2);
    json_hex(&json, "id", (const uint8_t *)"\x00\xff", 2);
    json_lines(&json, "lines", "one\n\ntwo\n");
    json_array_begin(&json, "empty");
    json_array_end(&json);
    json_object_end(&json);
    assert_true(json_finish(&json));
    fclose(json.out);
    assert_string_equal(text,
                        "{\n"
                        "  \"name\": \"a\\\"b\\\\c\\u000ad\\u0001\\u007f\xc3\xbc\\ufffd\\ufffd\",\n"
                        "  \"n\": 18446744073709551615,\n"
                        "  \"yes\": true,\n"
                        "  \"v\": [\n    0.1,\n    null,\n    null\n  ],\n"
                        "  \"all digits\": 0.30000000000000004,\n"
                        "  \"id\": \"00ff\",\n"
                        "  \"lines\": [\n    \"one\",\n    \"two\"\n  ],\n"
                        "  \"empty\": []\n"
                        "}\n");
    free(text);
    FILE *full = fopen("/dev/full", "w");
    json = (struct json){.out = full};
    json_uint(&json, NULL, 1);
    assert_false(json_finish(&json));
    fclose(full);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(json_is_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
