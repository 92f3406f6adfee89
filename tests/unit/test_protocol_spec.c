/* The hex examples of protocol/README.md, the specification, are decoded and encoded again. Runs in
 * the repository's root. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/messages/message.h"
#include "protocol/ranges.h"
#include "tests/unit/spec_computations.h"

#define SPECIFICATION "protocol/README.md"
#define MAX_EXAMPLE_BYTES 4096

static void check_hello(const uint8_t *bytes, size_t size)
{
    const sheen_Hello hello = {.minor = PROTOCOL_MINOR, .client = "sheen 0.1.0"};
    uint8_t id[32], buffer[256], decoded_id[32];
    size_t length = 0;
    count_id(id);
    assert_true(message_hello_encode(1, id, &hello, buffer, sizeof(buffer), &length));
    assert_int_equal(length, size);
    assert_memory_equal(buffer, bytes, size);
    assert_memory_equal(bytes + 16, id, 32); /* the offset at which a load balancer reads the id */

    sheen_Hello decoded;
    struct message_header header;
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_int_equal(header.type, MESSAGE_HELLO);
    assert_true(message_hello_decode(bytes + 16, header.length, decoded_id, &decoded));
    assert_memory_equal(decoded_id, id, 32);
    assert_int_equal(decoded.minor, PROTOCOL_MINOR);
    assert_string_equal(decoded.client, "sheen 0.1.0");
}

static void check_hello_token(const uint8_t *bytes, size_t size)
{
    const sheen_Hello hello = {.minor = 0,
                               .client = "sheen 0.1.0",
                               .has_token = true,
                               .token = "correct-horse-battery-staple-0123"};
    const uint8_t id[32] = {0};
    uint8_t buffer[256];
    size_t length = 0;
    assert_true(message_hello_encode(1, id, &hello, buffer, sizeof(buffer), &length));
    assert_int_equal(length, size);
    assert_memory_equal(buffer, bytes, size);
}

static void check_hello_ok(const uint8_t *bytes, size_t size)
{
    const sheen_HelloOk ok = {.minor = PROTOCOL_MINOR,
                              .server = "0.1.0",
                              .device = "llvmpipe",
                              .driver = "Mesa",
                              .software = true,
                              .max_width_px = 16384,
                              .max_height_px = 16384,
                              .max_upload_bytes = 1073741824,
                              .has_credits = true,
                              .credits = 16};
    same_message(MESSAGE_HELLO_OK, 1, &ok, bytes, size);
}

static void check_upload_begin(const uint8_t *bytes, size_t size)
{
    sheen_UploadBegin begin = {
        .kind = sheen_UploadKind_UPLOAD_MODEL, .size_bytes = 8, .name = "a.obj"};
    count_id(begin.sha256);
    same_message(MESSAGE_UPLOAD_BEGIN, 2, &begin, bytes, size);
}

static void check_upload_chunk(const uint8_t *bytes, size_t size)
{
    struct message_header header;
    assert_true(size > MESSAGE_HEADER_BYTES);
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_int_equal(header.type, MESSAGE_UPLOAD_CHUNK);
    assert_int_equal(header.seq, 2);
    assert_int_equal(header.length, 8);
    assert_int_equal(size, MESSAGE_HEADER_BYTES + 8);
    assert_memory_equal(bytes + MESSAGE_HEADER_BYTES, "v 1 2 3\n", 8);
    uint8_t encoded[MESSAGE_HEADER_BYTES];
    message_header_encode(&header, encoded);
    assert_memory_equal(encoded, bytes, sizeof(encoded));
}

static void check_upload_state(const uint8_t *bytes, size_t size)
{
    const sheen_UploadState state = {.complete = true, .received_bytes = 8};
    same_message(MESSAGE_UPLOAD_STATE, 2, &state, bytes, size);
}

static void check_model_query(const uint8_t *bytes, size_t size)
{
    sheen_ModelQuery query = sheen_ModelQuery_init_zero;
    count_id(query.sha256);
    same_message(MESSAGE_MODEL_QUERY, 3, &query, bytes, size);
}

static void check_model_query_file(const uint8_t *bytes, size_t size)
{
    const sheen_ModelQuery query = {.has_file = true, .file = "cars/hood.obj"};
    same_message(MESSAGE_MODEL_QUERY, 8, &query, bytes, size);
}

static void check_model_info(const uint8_t *bytes, size_t size)
{
    sheen_ModelInfo info = {.name = "cube.obj",
                            .file_bytes = 300,
                            .vertices = 8,
                            .faces = 6,
                            .quads = 6,
                            .ptex_faces = 6,
                            .extraordinary_count = 1,
                            .extraordinary = {{.valence = 3, .count = 8}},
                            .corner_patches = 24,
                            .split_nodes = 6,
                            .table_bytes = 296832,
                            .regular_bytes = 320,
                            .corner_bytes = 12368,
                            .tables_us = 1500,
                            .box_min = {-0.5, -0.5, -0.5},
                            .box_max = {0.5, 0.5, 0.5},
                            .findings_count = 1,
                            .findings = {{.kind = sheen_FindingKind_FINDING_WOUND_AGAINST,
                                          .count = 4,
                                          .has_line = true,
                                          .line = 10}}};
    count_id(info.sha256);
    same_message(MESSAGE_MODEL_INFO, 3, &info, bytes, size);
}

static void check_render_least(const uint8_t *bytes, size_t size)
{
    sheen_Render render = least_render(sheen_Encoding_ENCODING_PNG);
    same_message(MESSAGE_RENDER, 4, &render, bytes, size);
}

static void check_render_full(const uint8_t *bytes, size_t size)
{
    sheen_Render render = {.width_px = 2,
                           .height_px = 1,
                           .has_camera = true,
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
                                                   .count = 20,
                                                   .has_duty = true,
                                                   .duty = 0.5,
                                                   .has_foreground = true,
                                                   .foreground = {1, 1, 1, 1},
                                                   .has_background = true,
                                                   .background = {0, 0, 0, 1}}}},
                           .has_lines = true,
                           .lines = {.family = sheen_LineFamily_LINES_HIGHLIGHT},
                           .has_miss = true,
                           .miss = {0.125f, 0.125f, 0.125f, 1},
                           .has_empty = true,
                           .empty = {0, 0, 0, 0},
                           .planes = sheen_Plane_PLANE_COLOUR | sheen_Plane_PLANE_PTEX,
                           .encoding = sheen_Encoding_ENCODING_ZSTD};
    count_id(render.model_sha256);
    same_message(MESSAGE_RENDER, 5, &render, bytes, size);
}

static void check_render_interactive(const uint8_t *bytes, size_t size)
{
    sheen_Render render = least_render(sheen_Encoding_ENCODING_PNG);
    render.has_request_class = true;
    render.request_class = sheen_RequestClass_CLASS_INTERACTIVE;
    render.has_view = true;
    render.view = 3;
    render.has_deadline_ms = true;
    render.deadline_ms = 200;
    same_message(MESSAGE_RENDER, 8, &render, bytes, size);
}

static void check_render_window(const uint8_t *bytes, size_t size)
{
    sheen_Render render = least_render(sheen_Encoding_ENCODING_RAW);
    render.width_px = render.height_px = 1;
    render.planes = sheen_Plane_PLANE_POSITION | sheen_Plane_PLANE_NORMAL;
    render.has_window = true;
    render.window = (sheen_Window){640, 360, 1280, 720};
    same_message(MESSAGE_RENDER, 12, &render, bytes, size);
}

static void check_render_jpeg(const uint8_t *bytes, size_t size)
{
    sheen_Render render = least_render(sheen_Encoding_ENCODING_JPEG);
    render.has_jpeg_quality = true;
    render.jpeg_quality = 80;
    render.has_jpeg_subsampling = true;
    render.jpeg_subsampling = sheen_JpegSubsampling_JPEG_420;
    same_message(MESSAGE_RENDER, 10, &render, bytes, size);
}

static void check_render_aliased(const uint8_t *bytes, size_t size)
{
    sheen_Render render = least_render(sheen_Encoding_ENCODING_PNG);
    render.has_aliased = true;
    render.aliased = true;
    same_message(MESSAGE_RENDER, 11, &render, bytes, size);
}

static void check_superseded(const uint8_t *bytes, size_t size)
{
    const sheen_Superseded superseded = {.by = 9};
    same_message(MESSAGE_SUPERSEDED, 8, &superseded, bytes, size);
}

static void check_cancel(const uint8_t *bytes, size_t size)
{
    same_message(MESSAGE_CANCEL, 9, NULL, bytes, size);
}

static void check_frame(const uint8_t *bytes, size_t size)
{
    const sheen_Frame frame = {.width_px = 2,
                               .height_px = 1,
                               .planes = sheen_Plane_PLANE_COLOUR,
                               .encoding = sheen_Encoding_ENCODING_RAW,
                               .data_bytes = 8,
                               .times = {.visibility_us = 12000,
                                         .evaluate_us = 20000,
                                         .shade_us = 3000,
                                         .readback_us = 500,
                                         .total_us = 36000},
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
                                                       .count = 20,
                                                       .has_duty = true,
                                                       .duty = 0.5}}},
                               .device = "llvmpipe",
                               .driver = "Mesa",
                               .software = true,
                               .server = "0.1.0"};
    same_message(MESSAGE_FRAME, 5, &frame, bytes, size);
}

static void check_data(const uint8_t *bytes, size_t size)
{
    struct message_header header;
    uint8_t colour[8], encoded[MESSAGE_HEADER_BYTES];
    void *const planes[CODEC_PLANES] = {colour};
    struct codec_layout layout;
    assert_int_equal(size, MESSAGE_HEADER_BYTES + 8);
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_int_equal(header.type, MESSAGE_DATA);
    assert_int_equal(header.flags, MESSAGE_END);
    message_header_encode(&header, encoded);
    assert_memory_equal(encoded, bytes, sizeof(encoded));
    assert_true(codec_layout_init(&layout, 2, 1, 1));
    assert_null(codec_raw_decode(&layout, bytes + MESSAGE_HEADER_BYTES, header.length, planes));
    assert_memory_equal(colour, "\xff\xff\xff\xff\x00\x00\x00\x00", 8);
}

/* Another version of zstd may compress differently: so the example is unpacked, and its pixels,
 * packed anew, must unpack to the same pixels. */
static void check_zstd_data(const uint8_t *bytes, size_t size)
{
    const uint8_t colour[8] = {255, 255, 255, 255, 0, 0, 0, 0};
    const struct {
        uint32_t face;
        float u, v;
    } ptex[2] = {{3, 0.25f, 0.5f}, {UINT32_MAX, 0, 0}};
    uint8_t colour_read[8], ptex_read[24];
    void *const planes[CODEC_PLANES] = {[0] = colour_read, [3] = ptex_read};
    struct codec_layout layout;
    struct codec_decoder *decoder = codec_decoder_create();
    assert_non_null(decoder);
    assert_true(codec_layout_init(&layout, 2, 1, 1 | 8));
    assert_null(codec_zstd_decode(decoder, &layout, bytes, size, planes));
    assert_memory_equal(colour_read, colour, sizeof(colour));
    assert_memory_equal(ptex_read, ptex, sizeof(ptex));
    codec_decoder_destroy(decoder);
}

static void check_progress(const uint8_t *bytes, size_t size)
{
    const sheen_Progress progress = {.stage = "tables", .done = 128, .total = 434};
    same_message(MESSAGE_PROGRESS, 4, &progress, bytes, size);
}

static void check_stats_query(const uint8_t *bytes, size_t size)
{
    same_message(MESSAGE_STATS_QUERY, 6, NULL, bytes, size);
}

static void check_stats(const uint8_t *bytes, size_t size)
{
    const sheen_Stats stats = {.uptime_us = 60000000,
                               .sessions = 1,
                               .frames = 2,
                               .models = 1,
                               .model_bytes = 296832,
                               .uploads_bytes = 300,
                               .sent_bytes = 5000,
                               .device = "llvmpipe",
                               .driver = "Mesa",
                               .software = true,
                               .server = "0.1.0",
                               .mean = {.total_us = 36000},
                               .has_window_us = true,
                               .window_us = 60000000,
                               .has_window_requests = true,
                               .window_requests = 3,
                               .has_window_frames = true,
                               .window_frames = 2,
                               .has_p50 = true,
                               .p50 = {.total_us = 35840},
                               .has_p95 = true,
                               .p95 = {.total_us = 37888},
                               .has_p99 = true,
                               .p99 = {.total_us = 37888}};
    same_message(MESSAGE_STATS, 6, &stats, bytes, size);
}

static void check_error(const uint8_t *bytes, size_t size)
{
    const sheen_Error error = {.code = sheen_ErrorCode_ERROR_REQUEST,
                               .text = "width is 0 px; it must be from 1 to 16384"};
    same_message(MESSAGE_ERROR, 7, &error, bytes, size);
}

static const struct {
    const char *name;
    void (*check)(const uint8_t *bytes, size_t size);
} EXAMPLES[] = {
    {"hello", check_hello},
    {"hello-token", check_hello_token},
    {"hello-ok", check_hello_ok},
    {"upload-begin", check_upload_begin},
    {"upload-chunk", check_upload_chunk},
    {"upload-state", check_upload_state},
    {"model-query", check_model_query},
    {"model-query-file", check_model_query_file},
    {"model-info", check_model_info},
    {"render-least", check_render_least},
    {"render-full", check_render_full},
    {"render-interactive", check_render_interactive},
    {"render-jpeg", check_render_jpeg},
    {"render-aliased", check_render_aliased},
    {"render-window", check_render_window},
    {"superseded", check_superseded},
    {"cancel", check_cancel},
    {"frame", check_frame},
    {"data", check_data},
    {"zstd-data", check_zstd_data},
    {"progress", check_progress},
    {"stats-query", check_stats_query},
    {"stats", check_stats},
    {"error", check_error},
    {"find-breaks", check_find_breaks},
    {"breaks", check_breaks},
    {"break-records", check_break_records},
    {"compare", check_compare},
    {"compared", check_compared},
    {"trace-lines", check_trace_lines},
    {"curves", check_curves},
    {"curve-records", check_curve_records},
};
#define N_EXAMPLES (sizeof(EXAMPLES) / sizeof(*EXAMPLES))

/* Appends the bytes of one line of an example; '#' starts a comment. */
static size_t read_hex_line(const char *line, uint8_t *bytes, size_t size)
{
    while (*line && *line != '#' && *line != '\n') {
        if (isspace((unsigned char)*line)) {
            line++;
            continue;
        }
        unsigned value;
        assert_int_equal(sscanf(line, "%2x", &value), 1);
        assert_true(isxdigit((unsigned char)line[1]));
        assert_true(size < MAX_EXAMPLE_BYTES);
        bytes[size++] = (uint8_t)value;
        line += 2;
    }
    return size;
}

static void run_example(const char *name, const uint8_t *bytes, size_t size, bool *seen)
{
    for (size_t i = 0; i < N_EXAMPLES; i++)
        if (strcmp(EXAMPLES[i].name, name) == 0) {
            assert_false(seen[i]);
            seen[i] = true;
            EXAMPLES[i].check(bytes, size);
            return;
        }
    fail_msg("%s has an example '%s' that this test does not know", SPECIFICATION, name);
}

static void every_example_is_what_the_codecs_say(void **state)
{
    (void)state;
    char line[400], name[64];
    bool seen[N_EXAMPLES] = {false};
    FILE *file = fopen(SPECIFICATION, "r");
    assert_non_null(file);
    while (fgets(line, sizeof(line), file)) {
        if (sscanf(line, "```hex %63s", name) != 1)
            continue;
        uint8_t bytes[MAX_EXAMPLE_BYTES];
        size_t size = 0;
        while (fgets(line, sizeof(line), file) && strncmp(line, "```", 3) != 0)
            size = read_hex_line(line, bytes, size);
        run_example(name, bytes, size, seen);
    }
    fclose(file);
    for (size_t i = 0; i < N_EXAMPLES; i++)
        if (!seen[i])
            fail_msg("%s lacks the example '%s'", SPECIFICATION, EXAMPLES[i].name);
}

static bool file_has_line(const char *path, const char *begin)
{
    char line[400];
    bool has = false;
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (!has && fgets(line, sizeof line, file))
        has = strncmp(line, begin, strlen(begin)) == 0;
    fclose(file);
    return has;
}

static void the_version_is_that_of_the_page(void **state)
{
    (void)state;
    char title[80], entry[80];
    snprintf(title, sizeof title, "# sheen's wire protocol, version %d.%d\n", PROTOCOL_MAJOR,
             PROTOCOL_MINOR);
    snprintf(entry, sizeof entry, "* %d.%d: ", PROTOCOL_MAJOR, PROTOCOL_MINOR);
    assert_true(file_has_line(SPECIFICATION, title));
    assert_true(file_has_line("CHANGELOG.md", entry));
}

/* The table of chapter 7 has all these rows and no others. */
static void the_ranges_are_those_of_the_table(void **state)
{
    (void)state;
    static char page[1 << 17];
    char wanted[8000] = "\n\n| field | range | option |\n|---|---|---|\n", text[RANGE_TEXT_BYTES];
    for (size_t i = 0; i < N_RANGES; i++) {
        size_t used = strlen(wanted);
        snprintf(wanted + used, sizeof(wanted) - used, "| %s | %s | %s |\n", RANGES[i].field,
                 range_text(&RANGES[i], text), RANGES[i].option ? RANGES[i].option : "");
    }
    strcat(wanted, "\n");
    FILE *file = fopen(SPECIFICATION, "r");
    assert_non_null(file);
    size_t n = fread(page, 1, sizeof(page) - 1, file);
    fclose(file);
    assert_true(n > 0 && n < sizeof(page) - 1);
    if (!strstr(page, wanted)) {
        fprintf(stderr, "%s, chapter 7, must have this table:%s", SPECIFICATION, wanted);
        fail();
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_example_is_what_the_codecs_say),
                                       cmocka_unit_test(the_version_is_that_of_the_page),
                                       cmocka_unit_test(the_ranges_are_those_of_the_table)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
