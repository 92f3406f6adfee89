/* message_find_fault(): the text about a body that cannot be decoded. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <string.h>

#include "protocol/messages/message.h"
#include "tests/unit/good_render.h"

#define NOT_WELL_FORMED "it is not well-formed"

/* The fault of the request GOOD with `n` bytes of further fields. */
static const char *fault_with(const void *fields, size_t n)
{
    static uint8_t buffer[2 * MESSAGE_BUFFER_BYTES];
    static char text[MESSAGE_TEXT_BYTES];
    sheen_Render render;
    size_t length = 0;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, buffer, MESSAGE_BUFFER_BYTES, &length));
    memcpy(buffer + length, fields, n);
    length += n - MESSAGE_HEADER_BYTES;
    assert_false(message_decode(MESSAGE_RENDER, buffer + MESSAGE_HEADER_BYTES, length, &render));
    message_find_fault(MESSAGE_RENDER, buffer + MESSAGE_HEADER_BYTES, length, text);
    return text;
}

static const char *fault_of(uint8_t type, const void *body, size_t n)
{
    static char text[MESSAGE_TEXT_BYTES];
    message_find_fault(type, body, n, text);
    return text;
}

/* Exceeding a limit of limits.h names that limit. */
static void faults_are_named(void **state)
{
    (void)state;
    uint8_t lights[2 * 8], bytes[400] = {0};
    for (int i = 0; i < 16; i++)
        lights[i] = i % 2 ? 0 : 0x2a; /* an empty light */
    assert_string_equal(fault_with(lights, 16), "lights has 9 entries; it may have at most 8");
    /* A light with a pattern of lines that has 17 places, once packed and once one by one. */
    memcpy(bytes, "\x2a\x90\x01\x32\x8d\x01\x08\x04\x62\x88\x01", 11);
    assert_string_equal(fault_with(bytes, 11 + 17 * 8),
                        "lights.pattern.at has 17 entries; it may have at most 16");
    memcpy(bytes, "\x2a\x9e\x01\x32\x9b\x01\x08\x04", 8);
    for (int i = 0; i < 17; i++)
        bytes[8 + 9 * i] = 0x61;
    assert_string_equal(fault_with(bytes, 8 + 17 * 9),
                        "lights.pattern.at has 17 entries; it may have at most 16");
    assert_string_equal(fault_with("\x2a\x02\x32\x00", 4), "lights.pattern.kind is missing");
    assert_string_equal(fault_with("\x10\x80\x80\x80\x80\x10", 6),
                        "width_px is 4294967296; it must be at most 4294967295");
    assert_string_equal(fault_with("\x22\xff", 2), NOT_WELL_FORMED);
    assert_string_equal(fault_of(MESSAGE_RENDER, "", 0), "model_sha256 is missing");
    assert_string_equal(fault_of(MESSAGE_MODEL_QUERY, "\x0a\x02xy", 4),
                        "sha256 has 2 bytes; it must have 32");
    memset(bytes, 'n', sizeof(bytes));
    memcpy(bytes, "\x22\x80\x02", 3);
    assert_string_equal(fault_of(MESSAGE_UPLOAD_BEGIN, bytes, 3 + 256),
                        "name has 256 bytes; it may have at most 255");
    memcpy(bytes + MODEL_ID_BYTES, "\x08\x00\x12\x40", 4);
    assert_string_equal(fault_of(MESSAGE_HELLO, bytes, MODEL_ID_BYTES + 4 + 64),
                        "client has 64 bytes; it may have at most 63");
    memcpy(bytes + MODEL_ID_BYTES,
           "\x08\x00\x12\x03"
           "a\0b",
           7);
    assert_string_equal(fault_of(MESSAGE_HELLO, bytes, MODEL_ID_BYTES + 7),
                        "client has a zero byte; texts have none");
    uint8_t id[MODEL_ID_BYTES];
    sheen_Hello hello;
    assert_false(message_hello_decode(bytes, MODEL_ID_BYTES + 7, id, &hello));
    bytes[MODEL_ID_BYTES + 5] = 'c';
    assert_true(message_hello_decode(bytes, MODEL_ID_BYTES + 7, id, &hello));
    assert_string_equal(fault_of(MESSAGE_HELLO, bytes, 31), NOT_WELL_FORMED);
    assert_string_equal(fault_of(MESSAGE_STATS_QUERY, bytes, 4), NOT_WELL_FORMED);
}

/* Changes random bytes of a request: if the request can be decoded, no fault is found. */
static void faults_are_found_only_where_they_are(void **state)
{
    (void)state;
    uint8_t good[MESSAGE_BUFFER_BYTES], bytes[MESSAGE_BUFFER_BYTES];
    size_t length = 0, n_named = 0;
    uint32_t noise = 1;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, good, sizeof(good), &length));
    length -= MESSAGE_HEADER_BYTES;
    for (int i = 0; i < 50000; i++) {
        memcpy(bytes, good + MESSAGE_HEADER_BYTES, length);
        for (int k = 0; k < 1 + i % 4; k++) {
            noise = noise * 1664525 + 1013904223;
            bytes[(noise >> 8) % length] = (uint8_t)(noise >> 24);
        }
        sheen_Render render;
        bool reads = message_decode(MESSAGE_RENDER, bytes, length, &render);
        bool named = strcmp(fault_of(MESSAGE_RENDER, bytes, length), NOT_WELL_FORMED) != 0;
        assert_false(reads && named);
        n_named += named;
    }
    assert_true(n_named > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(faults_are_found_only_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
