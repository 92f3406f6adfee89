/* libsheen with programs that were compiled with an older or a newer sheen.h, in which structs have
 * other sizes. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/fake_server.h"

#define CANARY 0xa5

/* A struct as a later sheen.h may have it. */
struct newer_request {
    struct sheen_request request;
    uint64_t later;
};
struct newer_stats {
    struct sheen_stats stats;
    uint64_t later;
};
struct newer_options {
    struct sheen_connect_options options;
    uint64_t later;
};

static void serve_raw(int fd)
{
    static const uint8_t bytes[WIDTH * HEIGHT * 4];
    greet(fd);
    for (int i = 0; i < 2; i++) {
        uint32_t seq = read_message(fd, NULL, 0).seq;
        const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_RAW, sizeof(bytes));
        if (!seq)
            return;
        send_message(fd, MESSAGE_FRAME, seq, &frame);
        send_data(fd, seq, bytes, sizeof(bytes), MESSAGE_END);
    }
}

static void assert_canary(const void *bytes, size_t from, size_t to)
{
    for (size_t i = from; i < to; i++)
        assert_int_equal(((const uint8_t *)bytes)[i], CANARY);
}

static void an_older_program_gives_and_gets_less(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    struct sheen_frame frame;
    assert_int_equal(open_session(&fake, serve_raw, &session, &error), SHEEN_OK);
    /* A frame from before `undecoded` and `times` were added. */
    memset(&request.undecoded, CANARY, sizeof(request) - offsetof(struct sheen_request, undecoded));
    request.size = offsetof(struct sheen_request, undecoded);
    memset(&frame, CANARY, sizeof(frame));
    sheen_struct_init(&frame, offsetof(struct sheen_frame, times));
    assert_canary(&frame, offsetof(struct sheen_frame, times), sizeof(frame));
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_OK);
    assert_non_null(frame.plane[0]); /* frames are decoded, which is the default */
    assert_int_equal(frame.n_lights, 1);
    assert_int_equal(frame.size, offsetof(struct sheen_frame, times));
    assert_canary(&frame, offsetof(struct sheen_frame, times), sizeof(frame));

    struct sheen_server server;
    memset(&server, CANARY, sizeof(server));
    server.size = offsetof(struct sheen_server, max_in_flight);
    assert_int_equal(sheen_get_server(session, &server, &error), SHEEN_OK);
    assert_int_equal(server.max_upload_bytes, 1000000);
    assert_canary(&server, offsetof(struct sheen_server, max_in_flight), sizeof(server));

    sheen_frame_finish(&frame);
    assert_int_equal(frame.size, offsetof(struct sheen_frame, times));
    assert_canary(&frame, offsetof(struct sheen_frame, times), sizeof(frame));
    sheen_close(session);
    fake_finish(&fake);
}

static void serve_queries(int fd)
{
    const sheen_Stats stats = {.frames = 7, .device = "d", .driver = "e", .server = "f"};
    const sheen_ModelInfo info = {.vertices = 9, .name = "cube.obj"};
    greet(fd);
    for (struct message_header header; (header = read_message(fd, NULL, 0)).seq != 0;)
        if (header.type == MESSAGE_STATS_QUERY)
            send_message(fd, MESSAGE_STATS, header.seq, &stats);
        else
            send_message(fd, MESSAGE_MODEL_INFO, header.seq, &info);
}

static void answers_fill_what_the_program_has(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    const uint8_t id[SHEEN_ID_BYTES] = {1};
    assert_int_equal(open_session(&fake, serve_queries, &session, &error), SHEEN_OK);
    struct sheen_stats stats;
    memset(&stats, CANARY, sizeof(stats));
    stats.size = offsetof(struct sheen_stats, models);
    assert_int_equal(sheen_query_stats(session, &stats, &error), SHEEN_OK);
    assert_int_equal(stats.frames, 7);
    assert_canary(&stats, offsetof(struct sheen_stats, models), sizeof(stats));
    struct sheen_model_info info;
    memset(&info, CANARY, sizeof(info));
    info.size = offsetof(struct sheen_model_info, faces);
    assert_int_equal(sheen_query_model(session, id, NULL, &info, &error), SHEEN_OK);
    assert_int_equal(info.vertices, 9);
    assert_canary(&info, offsetof(struct sheen_model_info, faces), sizeof(info));
    /* A newer program finds zero in the fields that this library does not know. */
    struct newer_stats newer = {.later = 5};
    newer.stats.size = sizeof(newer);
    assert_int_equal(sheen_query_stats(session, &newer.stats, &error), SHEEN_OK);
    assert_int_equal(newer.stats.frames, 7);
    assert_int_equal(newer.stats.size, sizeof(newer));
    assert_int_equal(newer.later, 0);
    sheen_close(session);
    fake_finish(&fake);
}

static void a_newer_program_asks_for_what_is_known(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct newer_request newer;
    assert_int_equal(open_session(&fake, serve_raw, &session, &error), SHEEN_OK);
    sheen_request_init(&newer.request, sizeof(newer));
    assert_int_equal(newer.later, 0);
    newer.request.width_px = WIDTH;
    newer.request.height_px = HEIGHT;
    newer.request.format = SHEEN_FORMAT_RAW;
    assert_int_equal(sheen_render(session, &newer.request, NULL, &frame, &error), SHEEN_OK);
    newer.later = 1;
    assert_int_equal(sheen_send(session, &newer.request, &error), SHEEN_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "newer"));
    newer.later = 0;
    assert_int_equal(sheen_render(session, &newer.request, NULL, &frame, &error), SHEEN_OK);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);

    struct newer_options options = {.options = SHEEN_CONNECT_DEFAULTS, .later = 1};
    options.options.size = sizeof(options);
    assert_int_equal(sheen_connect(&session, &options.options, &error), SHEEN_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "newer"));
}

static void a_size_that_was_never_set_is_refused(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_stats stats = SHEEN_STATS_DEFAULTS;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    struct sheen_server server = SHEEN_SERVER_DEFAULTS;
    static const size_t bad[] = {0, 15, ((size_t)1 << 20) + 1, (size_t)CANARY << 56, SIZE_MAX};
    assert_int_equal(open_session(&fake, serve_raw, &session, &error), SHEEN_OK);
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        struct sheen_connect_options options = {.size = bad[i]};
        struct sheen_session *none;
        assert_int_equal(sheen_connect(&none, &options, &error), SHEEN_BAD_ARGUMENT);
        request.size = frame.size = stats.size = info.size = server.size = bad[i];
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "request.size"));
        assert_int_equal(sheen_query_stats(session, &stats, &error), SHEEN_BAD_ARGUMENT);
        assert_int_equal(sheen_query_model(session, request.model_id, NULL, &info, &error),
                         SHEEN_BAD_ARGUMENT);
        assert_int_equal(sheen_get_server(session, &server, &error), SHEEN_BAD_ARGUMENT);
        request.size = sizeof(request);
        assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "frame.size"));
    }
    sheen_close(session);
    fake_finish(&fake);
}

/* The macros and the functions give the same defaults. */
static void defaults_are_the_same_both_ways(void **state)
{
    (void)state;
    const struct sheen_request macro = SHEEN_REQUEST_DEFAULTS, made = sheen_request_defaults();
    assert_memory_equal(&macro.camera, &made.camera, sizeof(macro.camera));
    assert_memory_equal(&macro.lights, &made.lights, sizeof(macro.lights));
    assert_memory_equal(&macro.lines, &made.lines, sizeof(macro.lines));
    assert_memory_equal(&macro.show, &made.show, sizeof(macro.show));
    assert_true(made.size == sizeof(made) && macro.size == sizeof(macro));
    assert_true(made.width_px == 1280 && made.height_px == 720 && made.n_lights == 1);
    assert_true(made.planes == SHEEN_PLANE_COLOUR && made.format == SHEEN_FORMAT_PNG);
    const struct sheen_pattern pattern = sheen_pattern_defaults();
    assert_true(pattern.count == 40 && pattern.duty == 0.5 && pattern.opacity == 1);
    const struct sheen_connect_options options = sheen_connect_defaults();
    assert_true(options.size == sizeof(options) && options.timeout_ms == 300000);
    assert_int_equal(sheen_frame_defaults().size, sizeof(struct sheen_frame));
    assert_int_equal(sheen_stats_defaults().size, sizeof(struct sheen_stats));
    assert_int_equal(sheen_breaks_defaults().size, sizeof(struct sheen_breaks));
    assert_int_equal(sheen_curves_defaults().size, sizeof(struct sheen_curves));
    assert_int_equal(sheen_curve_options_defaults().size, sizeof(struct sheen_curve_options));
    assert_int_equal(sheen_break_limits_defaults().size, sizeof(struct sheen_break_limits));
    assert_int_equal(sheen_compare_options_defaults().size, sizeof(struct sheen_compare_options));
    assert_int_equal(sheen_comparison_defaults().size, sizeof(struct sheen_comparison));
    assert_int_equal(sheen_server_defaults().size, sizeof(struct sheen_server));
    assert_int_equal(sheen_model_info_defaults().size, sizeof(struct sheen_model_info));
    /* In the struct of an older program nothing beyond its size is written. */
    struct sheen_request older;
    memset(&older, CANARY, sizeof(older));
    sheen_request_init(&older, offsetof(struct sheen_request, camera));
    assert_int_equal(older.width_px, 1280);
    assert_canary(&older, offsetof(struct sheen_request, camera), sizeof(older));
    sheen_request_init(NULL, sizeof(older));
    sheen_request_init(&older, 15);
    assert_int_equal(older.size, offsetof(struct sheen_request, camera));
}

#if UINTPTR_MAX == UINT64_MAX
/* What each version added to the structs of sheen.h: the first and the last new member, and the
 * struct's sizeof in that version. The rows of a struct stand in order. A row of a released version
 * never changes; a version that adds members adds rows. */
#define ADDED(name, first, last, size)                                                             \
    {                                                                                              \
#name, offsetof(struct name, first),                                                       \
            offsetof(struct name, last) + sizeof(((struct name *)0)->last), size,                  \
            sizeof(struct name)                                                                    \
    }
static const struct {
    const char *name;
    size_t first, end, size, size_now;
} VERSIONS[] = {
    ADDED(sheen_connect_options, size, native_threads, 128), /* 0.1 */
    ADDED(sheen_server, size, max_in_flight, 64),
    ADDED(sheen_model_info, size, patches, 5400),
    ADDED(sheen_request, size, window, 3304),
    ADDED(sheen_frame, size, threads, 3824),
    ADDED(sheen_stats, size, daemon_bytes, 848),
    ADDED(sheen_break_limits, size, curvature_percent, 32),
    ADDED(sheen_breaks, size, server, 3240),
    ADDED(sheen_compare_options, size, samples, 88),
    ADDED(sheen_comparison, size, server, 4952),
    ADDED(sheen_curve_options, size, silhouettes, 40),
    ADDED(sheen_curves, size, server, 3184),
    /* Structs without `size` never change: each has one row. */
    ADDED(sheen_error, status, text, 644),
    ADDED(sheen_progress, report, context, 16),
    ADDED(sheen_finding, kind, face, 20),
    ADDED(sheen_valence, valence, count, 8),
    ADDED(sheen_camera, projection, ortho_height, 128),
    ADDED(sheen_pattern, kind, image_id, 280),
    ADDED(sheen_light, kind, pattern, 360),
    ADDED(sheen_lines, family, eye, 64),
    ADDED(sheen_show, kind, without_legend, 48),
    ADDED(sheen_extreme, has_value, v, 80),
    ADDED(sheen_window, x_px, height_px, 24),
    ADDED(sheen_times, tables_us, total_us, 56),
    ADDED(sheen_latency, frames, p99_us, 32),
    ADDED(sheen_break_worst, value, uv, 48),
    ADDED(sheen_break_edge, kind, worst, 352),
    ADDED(sheen_break_vertex, face, position, 64),
    ADDED(sheen_compared_place, face, position, 48),
    ADDED(sheen_compared_measure, is_known, area_out, 144),
    ADDED(sheen_compared_side, samples, measures, 816),
    ADDED(sheen_curve_point, face, length, 112),
    ADDED(sheen_curve, light, length, 48),
    ADDED(sheen_curve_mark, kind, normal, 80),
};

static void members_stay_where_they_are(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof(VERSIONS) / sizeof(*VERSIONS); i++) {
        bool follows = i > 0 && strcmp(VERSIONS[i].name, VERSIONS[i - 1].name) == 0;
        bool is_newest = i + 1 == sizeof(VERSIONS) / sizeof(*VERSIONS) ||
                         strcmp(VERSIONS[i].name, VERSIONS[i + 1].name) != 0;
        if (VERSIONS[i].first < (follows ? VERSIONS[i - 1].size : 0))
            fail_msg("%s: a new member begins in the older struct", VERSIONS[i].name);
        if (VERSIONS[i].end > VERSIONS[i].size || VERSIONS[i].size - VERSIONS[i].end >= 8 ||
            (is_newest && VERSIONS[i].size_now != VERSIONS[i].size))
            fail_msg("%s: its last member ends at %zu of %zu bytes now, instead of %zu",
                     VERSIONS[i].name, VERSIONS[i].end, VERSIONS[i].size_now, VERSIONS[i].size);
    }
}
#else
static void members_stay_where_they_are(void **state)
{
    (void)state;
    skip();
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_older_program_gives_and_gets_less),
        cmocka_unit_test(answers_fill_what_the_program_has),
        cmocka_unit_test(a_newer_program_asks_for_what_is_known),
        cmocka_unit_test(a_size_that_was_never_set_is_refused),
        cmocka_unit_test(defaults_are_the_same_both_ways),
        cmocka_unit_test(members_stay_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
