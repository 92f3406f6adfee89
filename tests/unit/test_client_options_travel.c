/* The options of a request reach a daemon whose protocol version knows them. */
#include <string.h>

#include "tests/unit/fake_server.h"

/* The last RENDER that a fake daemon has read. */
static sheen_Render seen_render;

static void keep_render(int fd)
{
    uint8_t body[4096];
    struct message_header header = read_message(fd, body, sizeof body);
    message_decode(MESSAGE_RENDER, body, header.length, &seen_render);
    send_error(fd, header.seq, sheen_ErrorCode_ERROR_OVERLOADED, "later");
}

static void serve_and_keep(int fd)
{
    greet(fd);
    keep_render(fd);
}

static void serve_and_keep_minor(int fd, uint32_t minor)
{
    struct message_header hello = read_message(fd, NULL, 0);
    sheen_HelloOk ok = HELLO_OK;
    ok.minor = minor;
    send_message(fd, MESSAGE_HELLO_OK, hello.seq, &ok);
    keep_render(fd);
}

static void serve_and_keep_newer(int fd)
{
    serve_and_keep_minor(fd, 2);
}

static void serve_and_keep_1_3(int fd)
{
    serve_and_keep_minor(fd, 3);
}

static void serve_and_keep_1_4(int fd)
{
    serve_and_keep_minor(fd, 4);
}

static void serve_and_keep_1_5(int fd)
{
    serve_and_keep_minor(fd, 5);
}

static void classes_travel(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    request.request_class = SHEEN_CLASS_INTERACTIVE;
    request.has_view = true;
    request.view = 9;
    request.deadline_ms = 250;
    assert_int_equal(open_session(&fake, serve_and_keep, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
    assert_int_equal(sheen_cancel(session, sheen_last_number(session), &error),
                     SHEEN_BAD_ARGUMENT); /* minor version 0 has no CANCEL */
    assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OVERLOADED);
    assert_int_equal(seen_render.request_class, sheen_RequestClass_CLASS_INTERACTIVE);
    assert_true(seen_render.has_view && seen_render.has_deadline_ms);
    assert_int_equal(seen_render.view, 9);
    assert_int_equal(seen_render.deadline_ms, 250);
    request.request_class = SHEEN_CLASS_BATCH; /* a batch request may name no view */
    assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
    assert_non_null(strstr(error.text, "view"));
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

/* Options of JPEG are sent only to a daemon of minor version 2 or later: an older one would ignore
 * them. */
static void jpeg_options_travel(void **state)
{
    (void)state;
    for (int is_newer = 0; is_newer < 2; is_newer++) {
        struct fake fake;
        struct sheen_error error;
        struct sheen_session *session;
        struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
        struct sheen_request request = small_request(SHEEN_FORMAT_JPEG);
        assert_int_equal(
            open_session(&fake, is_newer ? serve_and_keep_newer : serve_and_keep, &session, &error),
            SHEEN_OK);
        request.jpeg_quality = 101;
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_BAD_ARGUMENT);
        assert_non_null(strstr(error.text, "jpeg_quality"));
        request.jpeg_quality = is_newer ? 80 : 0;
        request.jpeg_subsampling = SHEEN_JPEG_420;
        enum sheen_status status = sheen_send(session, &request, &error);
        assert_int_equal(status, is_newer ? SHEEN_OK : SHEEN_BAD_ARGUMENT);
        if (!is_newer) {
            assert_non_null(strstr(error.text, "too old"));
            /* the value that an older daemon uses anyway */
            request.jpeg_subsampling = SHEEN_JPEG_444;
            assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
        }
        assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OVERLOADED);
        assert_int_equal(seen_render.has_jpeg_quality, is_newer);
        assert_int_equal(seen_render.has_jpeg_subsampling, is_newer);
        if (is_newer) {
            assert_int_equal(seen_render.jpeg_quality, 80);
            assert_int_equal(seen_render.jpeg_subsampling, sheen_JpegSubsampling_JPEG_420);
        }
        sheen_frame_finish(&frame);
        sheen_close(session);
        fake_finish(&fake);
    }
}

/* `aliased` is sent only to a daemon of minor version 4 or later: an older one would ignore it and
 * antialias. */
static void no_antialiasing_travels(void **state)
{
    (void)state;
    for (int is_newer = 0; is_newer < 2; is_newer++) {
        struct fake fake;
        struct sheen_error error;
        struct sheen_session *session;
        struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
        struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
        assert_int_equal(open_session(&fake, is_newer ? serve_and_keep_1_4 : serve_and_keep_1_3,
                                      &session, &error),
                         SHEEN_OK);
        request.aliased = true;
        enum sheen_status status = sheen_send(session, &request, &error);
        assert_int_equal(status, is_newer ? SHEEN_OK : SHEEN_BAD_ARGUMENT);
        if (!is_newer) {
            assert_non_null(strstr(error.text, "too old"));
            request.aliased = false;
            request.unfiltered = true; /* every daemon knows this field */
            assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
        }
        assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OVERLOADED);
        assert_int_equal(seen_render.has_aliased, is_newer);
        assert_int_equal(seen_render.aliased, is_newer);
        assert_int_equal(seen_render.unfiltered, !is_newer);
        sheen_frame_finish(&frame);
        sheen_close(session);
        fake_finish(&fake);
    }
}

/* A daemon of minor version 4 would draw the whole picture where a part is wanted. */
static void a_window_travels(void **state)
{
    (void)state;
    for (int is_newer = 0; is_newer < 2; is_newer++) {
        struct fake fake;
        struct sheen_error error;
        struct sheen_session *session;
        struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
        struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
        assert_int_equal(open_session(&fake, is_newer ? serve_and_keep_1_5 : serve_and_keep_1_4,
                                      &session, &error),
                         SHEEN_OK);
        request.window = (struct sheen_window){2.5, 3, 640, 480};
        enum sheen_status status = sheen_send(session, &request, &error);
        assert_int_equal(status, is_newer ? SHEEN_OK : SHEEN_BAD_ARGUMENT);
        if (!is_newer) {
            assert_non_null(strstr(error.text, "too old"));
            request.window = (struct sheen_window){0};
            assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
        }
        assert_int_equal(sheen_receive(session, NULL, &frame, &error), SHEEN_OVERLOADED);
        assert_int_equal(seen_render.has_window, is_newer);
        if (is_newer) {
            assert_true(seen_render.window.x_px == 2.5 && seen_render.window.y_px == 3);
            assert_int_equal(seen_render.window.width_px, 640);
            assert_int_equal(seen_render.window.height_px, 480);
        }
        sheen_frame_finish(&frame);
        sheen_close(session);
        fake_finish(&fake);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(classes_travel),
        cmocka_unit_test(jpeg_options_travel),
        cmocka_unit_test(no_antialiasing_travels),
        cmocka_unit_test(a_window_travels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
