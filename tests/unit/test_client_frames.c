/* libsheen's frames, from fake servers: some serve, some die in the middle of an answer, some send
 * wrong data, some refuse. */
#include <stdlib.h>
#include <string.h>

#include "tests/unit/fake_server.h"

/* ---- frames ---- */

/* Greets, reads a request, and begins its answer: FRAME of a PNG file of so many bytes. Returns the
 * request's number. */
static uint32_t begin_png(int fd, uint64_t data_bytes)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_PNG, data_bytes);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
    return seq;
}

static void serve_file_in_two(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    const sheen_Progress progress = {.stage = "tables", .done = 1, .total = 2};
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_PNG, 10);
    send_message(fd, MESSAGE_PROGRESS, seq, &progress);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
    send_data(fd, seq, (const uint8_t *)"0123456", 7, 0);
    send_data(fd, seq, (const uint8_t *)"789", 3, MESSAGE_END);
}

static void count_reports(void *context, const char *stage, uint64_t done, uint64_t total)
{
    assert_string_equal(stage, "tables");
    assert_int_equal(done, 1);
    assert_int_equal(total, 2);
    ++*(int *)context;
}

static void a_file_arrives_whole(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
    int reports = 0;
    const struct sheen_progress progress = {count_reports, &reports};
    assert_int_equal(open_session(&fake, serve_file_in_two, &session, &error), SHEEN_OK);
    assert_string_equal(server_of(session).device, "fake device");
    assert_int_equal(sheen_render(session, &request, &progress, &frame, &error), SHEEN_OK);
    assert_int_equal(reports, 1);
    assert_int_equal(frame.data_bytes, 10);
    assert_memory_equal(frame.data, "0123456789", 10);
    assert_int_equal(frame.times.total_us, 7);
    assert_true(frame.camera.eye[0] == 1 && frame.camera.fov_deg == 35);
    assert_int_equal(frame.camera.projection, SHEEN_PROJECTION_PERSPECTIVE);
    sheen_frame_finish(&frame);
    assert_null(frame.data);
    sheen_close(session);
    fake_finish(&fake);
}

static void serve_gone_mid_frame(int fd)
{
    uint32_t seq = begin_png(fd, 1000);
    send_header(fd, MESSAGE_DATA, MESSAGE_END, 1000, seq);
    send_bytes(fd, "half", 4);
}

static void serve_too_much_data(int fd)
{
    uint32_t seq = begin_png(fd, 4);
    send_data(fd, seq, (const uint8_t *)"01234", 5, MESSAGE_END);
}

static void serve_no_end(int fd)
{
    uint32_t seq = begin_png(fd, 4);
    send_data(fd, seq, (const uint8_t *)"0123", 4, 0);
}

static void serve_early_end(int fd)
{
    uint32_t seq = begin_png(fd, 4);
    send_data(fd, seq, (const uint8_t *)"012", 3, MESSAGE_END);
}

static void serve_empty_data(int fd)
{
    uint32_t seq = begin_png(fd, 4);
    send_data(fd, seq, (const uint8_t *)"", 0, 0);
}

static void serve_other_size(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_PNG, 4);
    frame.width_px = 2 * WIDTH;
    send_message(fd, MESSAGE_FRAME, seq, &frame);
}

static void serve_raw_of_wrong_length(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_RAW, WIDTH * HEIGHT * 4 + 1);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
}

static void serve_zstd_bomb(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_ZSTD, 4000000000u);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
}

static void lying_frames(void **state)
{
    (void)state;
    render_ends_with(serve_gone_mid_frame, SHEEN_FORMAT_PNG, SHEEN_LOST_SERVER, "lost server");
    assert_int_equal(sheen_status_exit_code(SHEEN_LOST_SERVER), 4);
    render_ends_with(serve_too_much_data, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER, "DATA");
    render_ends_with(serve_no_end, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER, "end of DATA");
    render_ends_with(serve_early_end, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER, "end of DATA");
    render_ends_with(serve_empty_data, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER, "DATA");
    render_ends_with(serve_other_size, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER, "asked for");
    render_ends_with(serve_raw_of_wrong_length, SHEEN_FORMAT_RAW, SHEEN_BAD_PEER, "bytes");
    render_ends_with(serve_zstd_bomb, SHEEN_FORMAT_ZSTD, SHEEN_BAD_PEER, "more bytes");
}

/* A colour plane packed as the daemon packs it; the pixels' bytes count up from 0. */
static uint32_t packed_plane(uint8_t *bytes, size_t capacity)
{
    uint8_t plane[WIDTH * HEIGHT * 4];
    struct codec_layout layout;
    for (size_t i = 0; i < sizeof(plane); i++)
        plane[i] = (uint8_t)i;
    codec_layout_init(&layout, WIDTH, HEIGHT, 1);
    struct codec_strip strip = codec_strip_at(&layout, 0);
    struct codec_encoder *encoder = codec_encoder_create(1);
    uint32_t length = (uint32_t)codec_strip_encode(encoder, &strip, plane, bytes + 4, capacity - 4);
    codec_table_encode(&layout, &length, bytes);
    codec_encoder_destroy(encoder);
    return length + 4;
}

static void answer_packed(int fd, const uint8_t *bytes, uint32_t size)
{
    uint32_t seq = read_message(fd, NULL, 0).seq;
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_ZSTD, size);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
    send_data(fd, seq, bytes, size, MESSAGE_END);
}

static void serve_packed(int fd)
{
    uint8_t bytes[512];
    uint32_t size = packed_plane(bytes, sizeof(bytes));
    greet(fd);
    for (int i = 0; i < 4; i++)
        answer_packed(fd, bytes, size);
}

static void serve_truncated_zstd(int fd)
{
    uint8_t bytes[512];
    uint32_t size = packed_plane(bytes, sizeof(bytes));
    greet(fd);
    answer_packed(fd, bytes, size - 10);
}

static void serve_lying_table(int fd)
{
    uint8_t bytes[512];
    uint32_t size = packed_plane(bytes, sizeof(bytes));
    bytes[0] = bytes[1] = bytes[2] = bytes[3] = 0xff;
    greet(fd);
    answer_packed(fd, bytes, size);
}

static void packed_planes(void **state)
{
    (void)state;
    render_ends_with(serve_packed, SHEEN_FORMAT_ZSTD, SHEEN_OK, "");
    render_ends_with(serve_truncated_zstd, SHEEN_FORMAT_ZSTD, SHEEN_BAD_PEER, "strip");
    render_ends_with(serve_lying_table, SHEEN_FORMAT_ZSTD, SHEEN_BAD_PEER, "strip lengths");
}

static void requests_in_flight(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_model_info info = SHEEN_MODEL_INFO_DEFAULTS;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_ZSTD);
    assert_int_equal(open_session(&fake, serve_packed, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    const int most = (int)server_of(session).max_in_flight;
    assert_int_equal(most, 4); /* the number that holds when a server grants no credits */
    for (int i = 0; i < most; i++)
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_query_model(session, request.model_id, NULL, &info, &error),
                     SHEEN_BAD_ARGUMENT);
    void *memory = NULL;
    for (int i = 0; i < most; i++) {
        assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OK);
        const uint8_t *plane = frame.plane[0];
        for (int byte = 0; byte < WIDTH * HEIGHT * 4; byte++)
            assert_int_equal(plane[byte], byte);
        /* the second frame reuses the first one's memory */
        assert_true(i == 0 || frame.plane[0] == memory);
        memory = frame.plane[0];
        assert_null(frame.plane[1]);
        assert_null(frame.data);
    }
    sheen_frame_finish(&frame);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

/* Grants three requests. The second is answered first, the first is then reported as superseded by
 * the second, and the third is cancelled. */
static void serve_out_of_order(int fd)
{
    struct message_header hello = read_message(fd, NULL, 0);
    sheen_HelloOk ok = HELLO_OK;
    ok.minor = 1;
    ok.has_credits = true;
    ok.credits = 3;
    send_message(fd, MESSAGE_HELLO_OK, hello.seq, &ok);
    uint8_t body[3][200] = {{0}};
    uint32_t seq[3];
    for (int i = 0; i < 3; i++)
        seq[i] = read_message(fd, body[i], sizeof body[i]).seq;
    struct message_header cancel = read_message(fd, NULL, 0);
    if (cancel.type != MESSAGE_CANCEL || cancel.seq != seq[2] || cancel.length != 0)
        return;
    uint8_t pixels[WIDTH * HEIGHT * 4] = {0};
    sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_RAW, sizeof pixels);
    send_message(fd, MESSAGE_FRAME, seq[1], &frame);
    send_data(fd, seq[1], pixels, sizeof pixels, MESSAGE_END);
    sheen_Superseded superseded = {.by = seq[1]};
    send_message(fd, MESSAGE_SUPERSEDED, seq[0], &superseded);
    send_error(fd, seq[2], sheen_ErrorCode_ERROR_CANCELLED, "taken back");
}

static void answers_out_of_order(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    request.request_class = SHEEN_CLASS_INTERACTIVE;
    uint32_t number[3];
    assert_int_equal(open_session(&fake, serve_out_of_order, &session, &error), SHEEN_OK);
    assert_int_equal(server_of(session).max_in_flight, 3);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
        number[i] = sheen_last_number(session);
    }
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_cancel(session, number[2] + 1, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_cancel(session, number[2], &error), SHEEN_OK);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OK);
    assert_int_equal(frame.number, number[1]);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_SUPERSEDED);
    assert_int_equal(frame.number, number[0]);
    assert_int_equal(frame.superseded_by, number[1]);
    assert_int_equal(sheen_status_exit_code(SHEEN_SUPERSEDED), 4);
    assert_false(sheen_status_is_fatal(SHEEN_SUPERSEDED));
    /* it has been answered already */
    assert_int_equal(sheen_cancel(session, number[0], &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_CANCELLED);
    assert_int_equal(frame.number, number[2]);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

static void serve_one_at_a_time(int fd)
{
    struct message_header hello = read_message(fd, NULL, 0);
    sheen_HelloOk ok = HELLO_OK;
    ok.has_credits = true;
    ok.credits = 1;
    send_message(fd, MESSAGE_HELLO_OK, hello.seq, &ok);
    read_message(fd, NULL, 0);
}

static void more_than_is_granted_is_refused(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    assert_int_equal(open_session(&fake, serve_one_at_a_time, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
    assert_string_equal(error.text, "1 request is in flight: receive one");
    sheen_close(session);
    fake_finish(&fake);
}

static void serve_unknown_number(int fd)
{
    greet(fd);
    uint32_t seq = read_message(fd, NULL, 0).seq;
    sheen_Superseded superseded = {.by = seq};
    send_message(fd, MESSAGE_SUPERSEDED, seq + 1, &superseded);
}

static void answers_to_nothing_are_refused(void **state)
{
    (void)state;
    render_ends_with(serve_unknown_number, SHEEN_FORMAT_PNG, SHEEN_BAD_PEER,
                     "no request in flight");
}

/* ---- errors ---- */

static void serve_every_error(int fd)
{
    greet(fd);
    for (int code = sheen_ErrorCode_ERROR_REQUEST; code <= sheen_ErrorCode_ERROR_DEADLINE; code++) {
        if (code == sheen_ErrorCode_ERROR_SHUTTING_DOWN)
            continue;
        uint32_t seq = read_message(fd, NULL, 0).seq;
        send_error(fd, seq, (sheen_ErrorCode)code, "what, where, what to do");
    }
    uint32_t seq = read_message(fd, NULL, 0).seq;
    send_error(fd, seq, sheen_ErrorCode_ERROR_SHUTTING_DOWN, "shutting down");
}

static void every_error_has_its_status(void **state)
{
    (void)state;
    static const struct {
        enum sheen_status status;
        int exit_code;
    } expected[] = {{SHEEN_BAD_REQUEST, 2},
                    {SHEEN_BAD_MODEL, 3},
                    {SHEEN_BAD_IMAGE, 3},
                    /* TOO_BIG as the answer to RENDER */
                    {SHEEN_UNKNOWN_MODEL, 4},
                    {SHEEN_BAD_REQUEST, 2},
                    {SHEEN_OVERLOADED, 4},
                    {SHEEN_DEVICE_FAILED, 5},
                    {SHEEN_CANCELLED, 4},
                    {SHEEN_LATE, 4},
                    {SHEEN_SHUTTING_DOWN, 4}};
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
    assert_int_equal(open_session(&fake, serve_every_error, &session, &error), SHEEN_OK);
    for (size_t i = 0; i < sizeof(expected) / sizeof(*expected); i++) {
        enum sheen_status status = sheen_render(session, &request, NULL, &frame, &error);
        assert_int_equal(status, expected[i].status);
        assert_int_equal(error.status, status);
        assert_int_equal(sheen_status_exit_code(status), expected[i].exit_code);
    }
    assert_string_equal(error.text, "shutting down");
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_LOST_SERVER);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

/* Loses two frames and draws the third; then loses one frame every time that it is requested. */
static void serve_lost_frames(int fd)
{
    uint8_t first[512] = {0}, again[512] = {0};
    greet(fd);
    uint32_t seq = read_message(fd, first, sizeof(first)).seq;
    for (int i = 0; i < 2; i++) {
        send_error(fd, seq, sheen_ErrorCode_ERROR_GPU_LOST, "the GPU was lost");
        assert_int_equal(read_message(fd, again, sizeof(again)).seq, seq);
        assert_memory_equal(again, first, sizeof(first));
    }
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_PNG, 3);
    send_message(fd, MESSAGE_FRAME, seq, &frame);
    send_data(fd, seq, (const uint8_t *)"012", 3, MESSAGE_END);
    for (int i = 0; i <= SHEEN_MAX_RETRIES; i++)
        send_error(fd, read_message(fd, NULL, 0).seq, sheen_ErrorCode_ERROR_GPU_LOST, "lost");
}

static void a_lost_frame_is_asked_for_again(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
    assert_int_equal(open_session(&fake, serve_lost_frames, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_OK);
    assert_memory_equal(frame.data, "012", 3);
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_GPU_LOST);
    assert_int_equal(sheen_status_exit_code(SHEEN_GPU_LOST), 4);
    assert_false(sheen_status_is_fatal(SHEEN_GPU_LOST));
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

/* Three requests of one view are in flight. The first frame is lost; when it is requested again, it
 * must not supersede the last. */
static void serve_lost_view(int fd)
{
    uint32_t seq[3];
    greet(fd);
    for (int i = 0; i < 3; i++)
        seq[i] = read_message(fd, NULL, 0).seq;
    send_error(fd, seq[0], sheen_ErrorCode_ERROR_GPU_LOST, "the GPU was lost");
    send_error(fd, seq[2], sheen_ErrorCode_ERROR_CANCELLED, "the newest");
}

static void a_lost_frame_gives_way_to_a_newer_one(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    request.request_class = SHEEN_CLASS_INTERACTIVE;
    assert_int_equal(open_session(&fake, serve_lost_view, &session, &error), SHEEN_OK);
    for (int i = 0; i < 3; i++)
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_SUPERSEDED);
    assert_int_equal(frame.superseded_by, sheen_last_number(session));
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_CANCELLED);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

static void bad_arguments_send_nothing(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    assert_int_equal(open_session(&fake, serve_packed, &session, &error), SHEEN_OK);
    struct sheen_request request = small_request(SHEEN_FORMAT_ZSTD);
    request.width_px = 0;
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    request.width_px = 1001; /* this server's limit is 1000 */
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "1 to 1000"));
    request = small_request(SHEEN_FORMAT_ZSTD);
    request.lights[0].pattern.duty = 2;
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    request = small_request((enum sheen_format)17);
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_render(session, NULL, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_render(NULL, &request, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    request = small_request(SHEEN_FORMAT_ZSTD);
    assert_int_equal(sheen_render(session, &request, NULL, NULL, &error), SHEEN_BAD_ARGUMENT);
    /* The session still works after these errors. */
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_OK);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_arrives_whole),
        cmocka_unit_test(lying_frames),
        cmocka_unit_test(packed_planes),
        cmocka_unit_test(requests_in_flight),
        cmocka_unit_test(answers_out_of_order),
        cmocka_unit_test(more_than_is_granted_is_refused),
        cmocka_unit_test(answers_to_nothing_are_refused),
        cmocka_unit_test(every_error_has_its_status),
        cmocka_unit_test(a_lost_frame_is_asked_for_again),
        cmocka_unit_test(a_lost_frame_gives_way_to_a_newer_one),
        cmocka_unit_test(bad_arguments_send_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
