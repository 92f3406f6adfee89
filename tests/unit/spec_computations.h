/* The examples of computations and of their answers in protocol/README.md: breaks, lines as curves, comparisons. */
#ifndef SHEEN_TESTS_SPEC_COMPUTATIONS_H
#define SHEEN_TESTS_SPEC_COMPUTATIONS_H

#include "protocol/break_records.h"
#include "protocol/curve_records.h"
#include "tests/unit/spec_expect.h"

static inline void check_find_breaks(const uint8_t *bytes, size_t size)
{
    sheen_FindBreaks asked = {.scene = least_render(sheen_Encoding_ENCODING_PNG),
                              .has_angle_deg = true,
                              .angle_deg = 0.05};
    same_message(MESSAGE_FIND_BREAKS, 12, &asked, bytes, size);
}

static inline void check_breaks(const uint8_t *bytes, size_t size)
{
    const sheen_Breaks breaks = {.data_bytes = 336,
                                 .edges = 1,
                                 .vertices = 1,
                                 .edges_out = 1,
                                 .gap = 1e-5,
                                 .angle_deg = 0.05,
                                 .curvature_percent = 10,
                                 .creases = 1,
                                 .creases_length = 0.5,
                                 .out_length = 0.5,
                                 .diagonal = 1,
                                 .total_us = 1500,
                                 .camera = CAMERA,
                                 .lights_count = 1,
                                 .lights = {{.has_centre = true,
                                             .centre = {0, 0, 4},
                                             .has_u = true,
                                             .u = {4, 0, 0},
                                             .has_v = true,
                                             .v = {0, 4, 0},
                                             .has_pattern = true,
                                             .pattern = {.kind = sheen_PatternKind_PATTERN_STRIPES,
                                                         .has_count = true,
                                                         .count = 20}}},
                                 .server = "0.1.0"};
    char text[MESSAGE_TEXT_BYTES];
    same_message(MESSAGE_BREAKS, 12, &breaks, bytes, size);
    assert_true(message_check_answer(MESSAGE_BREAKS, &breaks, text));
}

/* The two records of the answer above. */
static inline void check_break_records(const uint8_t *bytes, size_t size)
{
    const struct break_edge edge = {.face = {0, 5},
                                    .edge = {2, 1},
                                    .kind = BREAK_CREASE,
                                    .over = 1 << BREAK_ANGLE,
                                    .kink_light = 0,
                                    .jump_light = 0,
                                    .has_dart = true,
                                    .length = 0.5,
                                    .out_length = 0.5,
                                    .worst = {{0, 0, {0, 0, 0}},
                                              {30, 0.25, {0.5, 0, 1}},
                                              {0, 0, {0, 0, 0}},
                                              {0, 0, {0, 0, 0}},
                                              {12.5, 0.5, {0.5, 0.25, 1}},
                                              {1.5, 1, {0.5, 0.5, 1}}},
                                    .shift = 0.125};
    const struct break_vertex vertex = {.face = 3,
                                        .corner = 2,
                                        .is_inside = true,
                                        .n_faces = 3,
                                        .radius = 0.015625,
                                        .k_least = -2,
                                        .k_greatest = -1.5,
                                        .point = {1, 2, 3}};
    uint8_t packed[BREAK_EDGE_BYTES + BREAK_VERTEX_BYTES];
    struct break_edge edge_read;
    struct break_vertex vertex_read;
    assert_int_equal(size, sizeof packed);
    break_edge_pack(&edge, packed);
    break_vertex_pack(&vertex, packed + BREAK_EDGE_BYTES);
    assert_memory_equal(packed, bytes, size);
    assert_true(break_edge_unpack(bytes, &edge_read));
    assert_true(break_vertex_unpack(bytes + BREAK_EDGE_BYTES, &vertex_read));
    assert_memory_equal(edge_read.worst, edge.worst, sizeof edge.worst);
    break_edge_pack(&edge_read, packed);
    break_vertex_pack(&vertex_read, packed + BREAK_EDGE_BYTES);
    assert_memory_equal(packed, bytes, size);
}

static inline void check_trace_lines(const uint8_t *bytes, size_t size)
{
    const sheen_TraceLines asked = {.scene = least_render(sheen_Encoding_ENCODING_PNG),
                                    .has_tolerance = true,
                                    .tolerance = 0.001,
                                    .at_count = 2,
                                    .at = {0.25, 0.5}};
    same_message(MESSAGE_TRACE_LINES, 13, &asked, bytes, size);
}

static inline void check_curves(const uint8_t *bytes, size_t size)
{
    const sheen_Curves curves = {.data_bytes =
                                     CURVE_BYTES + 2 * CURVE_POINT_BYTES + CURVE_MARK_BYTES,
                                 .curves = 1,
                                 .points = 2,
                                 .marks = 1,
                                 .tolerance = 0.001,
                                 .diagonal = 1,
                                 .total_us = 1500,
                                 .camera = CAMERA,
                                 .lights_count = 1,
                                 .lights = {{.has_centre = true,
                                             .centre = {0, 0, 4},
                                             .has_u = true,
                                             .u = {4, 0, 0},
                                             .has_v = true,
                                             .v = {0, 4, 0},
                                             .has_pattern = true,
                                             .pattern = {.kind = sheen_PatternKind_PATTERN_STRIPES,
                                                         .has_count = true,
                                                         .count = 20}}},
                                 .server = "0.1.0"};
    char text[MESSAGE_TEXT_BYTES];
    same_message(MESSAGE_CURVES, 13, &curves, bytes, size);
    assert_true(message_check_answer(MESSAGE_CURVES, &curves, text));
    sheen_Curves wrong = curves;
    wrong.points = 3;
    assert_false(message_check_answer(MESSAGE_CURVES, &wrong, text));
}

/* The four records of the answer above. */
static inline void check_curve_records(const uint8_t *bytes, size_t size)
{
    const struct curve_record curve = {CURVE_LINE, false, 0, 1, 0.5, 2, 1};
    const struct curve_point_record points[2] = {
        {3, 0.5, 0, {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 0, 0},
        {4, 0.5, 1, {1, 0, 0}, {0, 0, 1}, {1, 0, 0}, 0, 1},
    };
    const struct curve_mark_record mark = {CURVE_SINGULAR, 0, 1, 4, 0.5, 1, {1, 0, 0}, {0, 0, 1}};
    uint8_t packed[CURVE_BYTES + 2 * CURVE_POINT_BYTES + CURVE_MARK_BYTES];
    uint8_t *at_points = packed + CURVE_BYTES, *at_mark = at_points + 2 * CURVE_POINT_BYTES;
    struct curve_record curve_read;
    struct curve_point_record point_read;
    struct curve_mark_record mark_read;
    assert_int_equal(size, sizeof packed);
    curve_pack(&curve, packed);
    for (int i = 0; i < 2; i++)
        curve_point_pack(&points[i], at_points + i * CURVE_POINT_BYTES);
    curve_mark_pack(&mark, at_mark);
    assert_memory_equal(packed, bytes, size);
    assert_true(curve_unpack(packed, &curve_read));
    assert_true(curve_point_unpack(at_points + CURVE_POINT_BYTES, &point_read));
    assert_true(curve_mark_unpack(at_mark, &mark_read));
    assert_int_equal(curve_read.points, 2);
    assert_true(point_read.length == 1 && point_read.along[0] == 1 && mark_read.v == 1);
    /* Numbers out of range. */
    packed[0] = CURVE_KINDS;
    assert_false(curve_unpack(packed, &curve_read));
    at_points[31] = 0x7f; /* a coordinate above 1e300 */
    assert_false(curve_point_unpack(at_points, &point_read));
    at_mark[0] = CURVE_MARK_KINDS;
    assert_false(curve_mark_unpack(at_mark, &mark_read));
}

static inline void check_compare(const uint8_t *bytes, size_t size)
{
    sheen_Compare asked = {.scene = least_render(sheen_Encoding_ENCODING_PNG),
                           .has_normal_deg = true,
                           .normal_deg = 0.1,
                           .has_align = true,
                           .align = true};
    for (size_t i = 0; i < sizeof asked.new_sha256; i++)
        asked.new_sha256[i] = (uint8_t)(0xff - i);
    same_message(MESSAGE_COMPARE, 13, &asked, bytes, size);
}

static inline void check_compared(const uint8_t *bytes, size_t size)
{
    const sheen_ComparedMeasure distance = {.worst = -0.25,
                                            .old = {3, 0.5, 0.25, {1, 2, 3}},
                                            .new = {4, 0.5, 0.75, {1, 2, 2.75}},
                                            .rms = 0.125,
                                            .p95 = 0.1875,
                                            .p99 = 0.21875,
                                            .area_out = 1.5};
    const sheen_Compared compared = {
        .old = {.samples = 500000,
                .area = 6,
                .area_uncovered = 0.5,
                .has_uncovered = true,
                .uncovered = {7, 0, 1, {0, 1, 0}},
                .has_distance = true,
                .distance = distance},
        .new = {.samples = 500000, .area = 5.5},
        .diagonal = 4,
        .distance_floor = 6e-8,
        .normal_floor_deg = 2e-5,
        .distance = 4e-5,
        .normal_deg = 0.1,
        .lines = 0.1,
        .has_alignment = true,
        .alignment = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0.5}, 0, 0.5, 0},
        .total_us = 1500,
        .camera = CAMERA,
        .lights_count = 1,
        .lights = {{.has_centre = true,
                    .centre = {0, 0, 4},
                    .has_u = true,
                    .u = {4, 0, 0},
                    .has_v = true,
                    .v = {0, 4, 0},
                    .has_pattern = true,
                    .pattern = {.kind = sheen_PatternKind_PATTERN_STRIPES,
                                .has_count = true,
                                .count = 20}}},
        .server = "0.1.0"};
    char text[MESSAGE_TEXT_BYTES];
    same_message(MESSAGE_COMPARED, 13, &compared, bytes, size);
    assert_true(message_check_answer(MESSAGE_COMPARED, &compared, text));
}

#endif
