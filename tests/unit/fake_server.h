/* Fake servers for tests of libsheen: a thread on a Unix socket serves one connection by a function
 * of the test. Serving functions ignore a client that has gone. */
#ifndef SHEEN_TESTS_FAKE_SERVER_H
#define SHEEN_TESTS_FAKE_SERVER_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "client/lib/sheen.h"
#include "protocol/codec.h"
#include "protocol/messages/message.h"

#define WIDTH 8
#define HEIGHT 4

struct fake {
    char folder[64], path[96], address[112];
    int listener;
    pthread_t thread;
    void (*serve)(int fd);
};

/* ---- what every fake server needs; a failure here ends the thread's connection ---- */

static inline bool read_exact(int fd, void *bytes, size_t size)
{
    uint8_t *next = bytes;
    while (size > 0) {
        ssize_t n = recv(fd, next, size, 0);
        if (n <= 0)
            return false;
        next += n;
        size -= (size_t)n;
    }
    return true;
}

static inline void send_bytes(int fd, const void *bytes, size_t size)
{
    const uint8_t *next = bytes;
    while (size > 0) {
        ssize_t n = send(fd, next, size, MSG_NOSIGNAL);
        if (n <= 0)
            return;
        next += n;
        size -= (size_t)n;
    }
}

static inline void send_message(int fd, uint8_t type, uint32_t seq, const void *body)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    if (message_encode(type, seq, body, buffer, sizeof(buffer), &length))
        send_bytes(fd, buffer, length);
}

static inline void send_error(int fd, uint32_t seq, sheen_ErrorCode code, const char *text)
{
    sheen_Error error = {.code = code};
    snprintf(error.text, sizeof(error.text), "%s", text);
    send_message(fd, MESSAGE_ERROR, seq, &error);
}

static inline void send_header(int fd, uint8_t type, uint16_t flags, uint32_t length, uint32_t seq)
{
    uint8_t bytes[MESSAGE_HEADER_BYTES];
    message_header_encode(&(struct message_header){PROTOCOL_MAJOR, type, flags, length, seq},
                          bytes);
    send_bytes(fd, bytes, sizeof(bytes));
}

/* Reads one message; its body, cut off at `size`, goes to `body`. The number is 0 at the end of the
 * connection. */
static inline struct message_header read_message(int fd, uint8_t *body, size_t size)
{
    static uint8_t scratch[PROTOCOL_MAX_CHUNK_BYTES];
    uint8_t bytes[MESSAGE_HEADER_BYTES];
    struct message_header header = {0};
    if (!read_exact(fd, bytes, sizeof(bytes)) ||
        message_header_decode(&header, bytes) != HEADER_OK || header.length > sizeof(scratch) ||
        !read_exact(fd, scratch, header.length))
        return (struct message_header){0};
    if (body)
        memcpy(body, scratch, header.length < size ? header.length : size);
    return header;
}

static const sheen_HelloOk HELLO_OK = {.server = "0.0.0",
                                       .device = "fake device",
                                       .driver = "fake driver",
                                       .software = true,
                                       .max_width_px = 1000,
                                       .max_height_px = 1000,
                                       .max_upload_bytes = 1000000};

static inline void greet(int fd)
{
    struct message_header hello = read_message(fd, NULL, 0);
    send_message(fd, MESSAGE_HELLO_OK, hello.seq, &HELLO_OK);
}

static inline sheen_Frame frame_of(sheen_Encoding encoding, uint64_t data_bytes)
{
    return (sheen_Frame){
        .width_px = WIDTH,
        .height_px = HEIGHT,
        .planes = 1,
        .encoding = encoding,
        .data_bytes = data_bytes,
        .times = {.visibility_us = 1, .evaluate_us = 2, .shade_us = 3, .total_us = 7},
        .camera = {.has_eye = true,
                   .eye = {1, 0, 0},
                   .has_target = true,
                   .has_up = true,
                   .up = {0, 0, 1},
                   .has_fov_deg = true,
                   .fov_deg = 35},
        .lights_count = 1,
        .lights = {{.has_centre = true,
                    .centre = {0, 0, 4},
                    .has_u = true,
                    .u = {4, 0, 0},
                    .has_v = true,
                    .v = {0, 4, 0},
                    .has_pattern = true}},
        .device = "fake device",
        .driver = "fake driver",
        .server = "0.0.0",
    };
}

static inline void send_data(int fd, uint32_t seq, const uint8_t *bytes, uint32_t size,
                             uint16_t flags)
{
    send_header(fd, MESSAGE_DATA, flags, size, seq);
    send_bytes(fd, bytes, size);
}

/* ---- the test's side ---- */

static inline void *fake_thread(void *context)
{
    struct fake *fake = context;
    int fd = accept(fake->listener, NULL, NULL);
    if (fd >= 0) {
        fake->serve(fd);
        close(fd);
    }
    return NULL;
}

static inline void fake_start(struct fake *fake, void (*serve)(int fd))
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    strcpy(fake->folder, "/tmp/sheen-test-XXXXXX");
    assert_non_null(mkdtemp(fake->folder));
    snprintf(fake->path, sizeof(fake->path), "%s/socket", fake->folder);
    snprintf(fake->address, sizeof(fake->address), "unix:%s", fake->path);
    snprintf(name.sun_path, sizeof(name.sun_path), "%s", fake->path);
    fake->serve = serve;
    fake->listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fake->listener >= 0);
    assert_int_equal(bind(fake->listener, (const struct sockaddr *)&name, sizeof(name)), 0);
    assert_int_equal(listen(fake->listener, 4), 0);
    assert_int_equal(pthread_create(&fake->thread, NULL, fake_thread, fake), 0);
}

static inline void fake_finish(struct fake *fake)
{
    pthread_join(fake->thread, NULL);
    close(fake->listener);
    unlink(fake->path);
    rmdir(fake->folder);
}

static inline enum sheen_status open_session(struct fake *fake, void (*serve)(int fd),
                                             struct sheen_session **session,
                                             struct sheen_error *error)
{
    fake_start(fake, serve);
    struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    options.address = fake->address;
    options.timeout_ms = 2000;
    return sheen_connect(session, &options, error);
}

static inline struct sheen_server server_of(const struct sheen_session *session)
{
    struct sheen_server server = SHEEN_SERVER_DEFAULTS;
    assert_int_equal(sheen_get_server(session, &server, NULL), SHEEN_OK);
    return server;
}

static inline struct sheen_request small_request(enum sheen_format format)
{
    struct sheen_request request = SHEEN_REQUEST_DEFAULTS;
    request.width_px = WIDTH;
    request.height_px = HEIGHT;
    request.format = format;
    return request;
}

/* Expects that connecting to this server fails with this status and a text that contains the
 * word. */
static inline void connect_ends_with(void (*serve)(int fd), enum sheen_status status,
                                     const char *word)
{
    struct fake fake;
    struct sheen_error error = {0};
    struct sheen_session *session = (struct sheen_session *)1;
    assert_int_equal(open_session(&fake, serve, &session, &error), status);
    assert_null(session);
    assert_int_equal(error.status, status);
    assert_non_null(strstr(error.text, word));
    assert_null(strchr(error.text, '\n'));
    fake_finish(&fake);
}

/* Expects that connecting works and that rendering ends with this status. After a fatal one, the
 * session only fails. */
static inline void render_ends_with(void (*serve)(int fd), enum sheen_format format,
                                    enum sheen_status status, const char *word)
{
    struct fake fake;
    struct sheen_error error = {0};
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(format);
    assert_int_equal(open_session(&fake, serve, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), status);
    if (status != SHEEN_OK) {
        assert_int_equal(error.status, status);
        assert_non_null(strstr(error.text, word));
    }
    if (sheen_status_is_fatal(status))
        assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_LOST_SERVER);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

#endif
