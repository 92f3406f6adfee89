/* Bodies of messages: their bounds, and the checks that the schema cannot express
 * (test_protocol_render.c has those of RENDER). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "protocol/messages/message.h"
#include "tests/unit/good_render.h"

static void text_is_utf8_without_controls(void **state)
{
    (void)state;
    static const char *const good[] = {"",
                                       "hood.obj",
                                       "Kotfl\xc3\xbcgel",
                                       "\xe2\x82\xac",
                                       "\xf0\x9f\x98\x80",
                                       "\xf4\x8f\xbf\xbf",
                                       "\xc2\xa0"};
    static const char *const bad[] = {"a\nb",
                                      "\x1b[2J",
                                      "\x7f",
                                      "\x80",
                                      "\xc3",
                                      "\xc0\x80", /* an overlong encoding of "/" */
                                      "\xc1\xbf",
                                      "\xe0\x9f\xbf",     /* overlong */
                                      "\xed\xa0\x80",     /* surrogate */
                                      "\xf0\x80\x80\x80", /* overlong */
                                      "\xf4\x90\x80\x80", /* over U+10FFFF */
                                      "\xf8\x88\x80\x80\x80",
                                      "\xff",
                                      "\xe2\x82",
                                      "\xe2(\xa1",
                                      "\xc2\x9b" /* C1: the beginning of a terminal's control
                                                  * sequence */};
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
        assert_true(message_is_text(good[i], false));
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
        assert_false(message_is_text(bad[i], false));
    assert_true(message_is_text("one\ntwo\n", true));
    assert_false(message_is_text("one\rtwo", true));
}

static void uploads_are_checked(void **state)
{
    (void)state;
    const sheen_UploadBegin good = {.size_bytes = 1, .name = "a.obj"};
    char text[MESSAGE_TEXT_BYTES];
    assert_true(message_check_upload_begin(&good, text));
    sheen_UploadBegin bad = good;
    bad.size_bytes = 0;
    assert_false(message_check_upload_begin(&bad, text));
    bad.size_bytes = PROTOCOL_MAX_UPLOAD_BYTES;
    assert_true(message_check_upload_begin(&bad, text));
    bad.size_bytes++;
    assert_false(message_check_upload_begin(&bad, text));
    assert_non_null(strstr(text, "size_bytes"));
    bad = good;
    strcpy(bad.name, "a\x1b.obj");
    assert_false(message_check_upload_begin(&bad, text));
    assert_non_null(strstr(text, "name"));
    bad = good;
    bad.kind = (sheen_UploadKind)2;
    assert_false(message_check_upload_begin(&bad, text));
    const sheen_Hello hello = {.client = "\xff"};
    assert_false(message_check_hello(&hello, text));
}

static void credits_and_replacements_are_checked(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_HelloOk ok = {.credits = PROTOCOL_MAX_CREDITS};
    assert_true(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    ok.credits++;
    assert_false(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    assert_non_null(strstr(text, "credits is 65"));
    ok.credits = 0;
    assert_false(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    sheen_Superseded superseded = {.by = 7};
    assert_true(message_check_answer(MESSAGE_SUPERSEDED, &superseded, text));
    superseded.by = 0;
    assert_false(message_check_answer(MESSAGE_SUPERSEDED, &superseded, text));
    assert_false(message_check_answer(MESSAGE_CANCEL, NULL, text)); /* no server sends this value */

    /* The fields that a server of minor version 0 leaves out. */
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length;
    ok = (sheen_HelloOk){.server = "0"};
    assert_true(message_encode(MESSAGE_HELLO_OK, 1, &ok, buffer, sizeof(buffer), &length));
    assert_true(message_decode(MESSAGE_HELLO_OK, buffer + MESSAGE_HEADER_BYTES,
                               length - MESSAGE_HEADER_BYTES, &ok));
    assert_int_equal(ok.credits, PROTOCOL_MAX_IN_FLIGHT);
}

static void answers_are_checked(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_MODEL, .text = "a.obj: line 3"};
    assert_true(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_NONE;
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_GPU_LOST;
    assert_true(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = (sheen_ErrorCode)14;
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_MODEL;
    strcpy(error.text, "a\x1b[2J");
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    static sheen_ModelInfo info;
    strcpy(info.warnings, "one\ntwo");
    assert_true(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    info.box_max.z = NAN;
    assert_false(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    assert_non_null(strstr(text, "box_max.z"));
    info.box_max.z = 0;
    info.findings_count = 2; /* also of a kind that this version does not know */
    info.findings[0] = (sheen_Finding){.kind = (sheen_FindingKind)99, .count = 1};
    info.findings[1] = (sheen_Finding){.count = 1, .has_line = true};
    assert_false(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    assert_non_null(strstr(text, "findings[1]"));
    info.findings[1].line = 1;
    assert_true(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    info.findings[0].count = 0;
    assert_false(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    sheen_Frame frame = {.width_px = 2,
                         .height_px = 2,
                         .planes = 1,
                         .data_bytes = 16,
                         .camera = GOOD.camera,
                         .lights_count = 1,
                         .lights = {GOOD.lights[0]}};
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.has_show_range = true;
    frame.show_range = 0.25;
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.show_range = NAN;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "show_range"));
    frame.has_show_range = false;
    const sheen_Extreme least = {.value = -1,
                                 .has_x_px = true,
                                 .x_px = 1,
                                 .has_y_px = true,
                                 .has_position = true,
                                 .has_face = true,
                                 .has_u = true,
                                 .has_v = true,
                                 .v = 1};
    frame.has_show_least = true;
    frame.show_least = frame.show_greatest = least;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "come together"));
    frame.has_show_greatest = true;
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.show_greatest = (sheen_Extreme){.value = 2};
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
#define BAD_EXTREME(field, bad, word)                                                              \
    do {                                                                                           \
        frame.show_least = least;                                                                  \
        frame.show_least.field = bad;                                                              \
        assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));                           \
        assert_non_null(strstr(text, word));                                                       \
    } while (0)
    BAD_EXTREME(value, NAN, "show_least.value");
    BAD_EXTREME(value, 3, "above show_greatest");
    BAD_EXTREME(x_px, 2, "no pixel");
    BAD_EXTREME(y_px, 2, "no pixel");
    BAD_EXTREME(has_y_px, false, "no pixel");
    BAD_EXTREME(has_position, false, "no pixel");
    BAD_EXTREME(position.z, INFINITY, "show_least.z");
    BAD_EXTREME(has_u, false, "face, u and v");
    BAD_EXTREME(v, NAN, "face, u and v");
    frame.has_show_least = frame.has_show_greatest = false;
    frame.has_miss = frame.has_base = true;
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.base.a = 2;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "base.a"));
    frame.base.a = 1;
    frame.camera.has_up = false; /* optional in a request, required in an answer */
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "camera"));
    frame.camera = GOOD.camera;
    frame.camera.has_fov_deg = false;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.camera = GOOD.camera;
    frame.data_bytes = 0;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.data_bytes = UINT64_MAX;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.data_bytes = 16;
    frame.width_px = UINT32_MAX;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_false(message_check_answer(MESSAGE_RENDER, &GOOD, text));
}

static void encoding_stays_within_its_buffer(void **state)
{
    (void)state;
    uint8_t whole[MESSAGE_BUFFER_BYTES], small[MESSAGE_BUFFER_BYTES];
    size_t length = 0, other = 0;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, whole, sizeof(whole), &length));
    for (size_t capacity = 0; capacity < length; capacity++) {
        memset(small, 0xaa, sizeof(small));
        assert_false(message_encode(MESSAGE_RENDER, 9, &GOOD, small, capacity, &other));
        for (size_t i = capacity; i < length; i++)
            assert_int_equal(small[i], 0xaa);
    }
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, small, length, &other));
    assert_memory_equal(small, whole, length);
    assert_false(message_encode(MESSAGE_DATA, 9, &GOOD, whole, sizeof(whole), &length));
    assert_false(message_encode(200, 9, &GOOD, whole, sizeof(whole), &length));
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_MODEL};
    memset(error.text, 'x', sizeof(error.text)); /* a text without its terminating zero */
    assert_false(message_encode(MESSAGE_ERROR, 9, &error, whole, sizeof(whole), &length));
}

static void the_largest_messages_fit(void **state)
{
    (void)state;
    static sheen_ModelInfo info;
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    memset(info.warnings, 'w', sizeof(info.warnings) - 1);
    memset(info.name, 'n', sizeof(info.name) - 1);
    info.extraordinary_count = 64;
    for (int i = 0; i < 64; i++)
        info.extraordinary[i] = (sheen_ValenceCount){UINT32_MAX, UINT32_MAX};
    info.findings_count = 16;
    for (int i = 0; i < 16; i++)
        info.findings[i] =
            (sheen_Finding){(sheen_FindingKind)10, UINT32_MAX, true, UINT32_MAX, true, UINT32_MAX};
    assert_true(message_encode(MESSAGE_MODEL_INFO, 1, &info, buffer, sizeof(buffer), &length));
    static sheen_ModelInfo decoded;
    assert_true(message_decode(MESSAGE_MODEL_INFO, buffer + 16, length - 16, &decoded));
    assert_memory_equal(decoded.warnings, info.warnings, sizeof(info.warnings));
}

static void malformed_bodies_are_refused(void **state)
{
    (void)state;
    uint8_t buffer[MESSAGE_BUFFER_BYTES], id[32];
    size_t length = 0;
    sheen_Render render;
    sheen_Hello hello = {.client = "c"};
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, buffer, sizeof(buffer), &length));
    for (size_t n = 0; n + 1 < length - 16; n++)
        assert_false(message_decode(MESSAGE_RENDER, buffer + 16, n, &render));
    /* A text longer than its bound. */
    uint8_t progress[64] = {0x0a, 40};
    memset(progress + 2, 's', 40);
    memcpy(progress + 42, "\x10\x01\x18\x02", 4);
    sheen_Progress body;
    assert_false(message_decode(MESSAGE_PROGRESS, progress, 46, &body));
    progress[1] = 31;
    memcpy(progress + 33, "\x10\x01\x18\x02", 4);
    assert_true(message_decode(MESSAGE_PROGRESS, progress, 37, &body));
    /* An id that has not 32 bytes. */
    assert_false(message_decode(MESSAGE_MODEL_QUERY, (const uint8_t *)"\x0a\x02xy", 4, &render));
    assert_true(message_hello_encode(1, id, &hello, buffer, sizeof(buffer), &length));
    for (size_t n = 0; n < length - 16; n++)
        assert_false(message_hello_decode(buffer + 16, n, id, &hello));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_is_utf8_without_controls),
        cmocka_unit_test(uploads_are_checked),
        cmocka_unit_test(credits_and_replacements_are_checked),
        cmocka_unit_test(answers_are_checked),
        cmocka_unit_test(encoding_stays_within_its_buffer),
        cmocka_unit_test(the_largest_messages_fit),
        cmocka_unit_test(malformed_bodies_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
