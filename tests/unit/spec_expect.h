/* Helpers for tests of the hex examples of protocol/README.md. */
#ifndef SHEEN_TESTS_SPEC_EXPECT_H
#define SHEEN_TESTS_SPEC_EXPECT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "protocol/messages/message.h"

/* Decoded structs are compared by their encodings, which contain every field that is set. */
static inline void same_message(uint8_t type, uint32_t seq, const void *body, const uint8_t *bytes,
                                size_t size)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    assert_true(message_encode(type, seq, body, buffer, sizeof(buffer), &length));
    assert_int_equal(length, size);
    assert_memory_equal(buffer, bytes, size);

    struct message_header header;
    union {
        sheen_ModelInfo info;
        sheen_Frame frame;
        sheen_Render render;
        sheen_Stats stats;
        sheen_Error error;
        sheen_Superseded superseded;
        sheen_FindBreaks find_breaks;
        sheen_Breaks breaks;
        sheen_Compare compare;
        sheen_Compared compared;
        sheen_TraceLines trace_lines;
        sheen_Curves curves;
    } decoded;
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_int_equal(header.type, type);
    assert_int_equal(header.flags, 0);
    assert_int_equal(header.seq, seq);
    assert_int_equal(header.length, size - MESSAGE_HEADER_BYTES);
    if (type == MESSAGE_STATS_QUERY || type == MESSAGE_CANCEL)
        return;
    assert_true(message_decode(type, bytes + MESSAGE_HEADER_BYTES, header.length, &decoded));
    assert_true(message_encode(type, seq, &decoded, buffer, sizeof(buffer), &length));
    assert_int_equal(length, size);
    assert_memory_equal(buffer, bytes, size);
    /* A message that lacks one field must not count as equal. */
    assert_false(header.length > 0 &&
                 message_decode(type, bytes + MESSAGE_HEADER_BYTES, header.length - 1, &decoded));
}

static inline void count_id(uint8_t id[32])
{
    for (int i = 0; i < 32; i++)
        id[i] = (uint8_t)i;
}

#define CAMERA                                                                                     \
    {                                                                                              \
        .has_eye = true, .eye = {3, -4, 2}, .has_target = true, .target = {0, 0, 0.5},             \
        .has_up = true, .up = {0, 0, 1}, .has_fov_deg = true, .fov_deg = 35                        \
    }

static inline sheen_Render least_render(sheen_Encoding encoding)
{
    sheen_Render render = {.width_px = 1280,
                           .height_px = 720,
                           .planes = sheen_Plane_PLANE_COLOUR,
                           .encoding = encoding};
    count_id(render.model_sha256);
    return render;
}

#endif
