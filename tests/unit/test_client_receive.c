/* sheen_try_receive() and undecoded frames: answers that arrive byte by byte, and answers that end
 * in the middle. */
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "client/lib/session.h"
#include "tests/unit/certificates.h"
#include "tests/unit/fake_server.h"

/* The bytes of a daemon's messages, collected before they are sent. */
struct script {
    uint8_t bytes[4096];
    size_t size;
};

static void add_bytes(struct script *script, const void *bytes, size_t size)
{
    assert_true(script->size + size <= sizeof(script->bytes));
    memcpy(script->bytes + script->size, bytes, size);
    script->size += size;
}

static void add_message(struct script *script, uint8_t type, uint32_t seq, const void *body)
{
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    assert_true(message_encode(type, seq, body, buffer, sizeof(buffer), &length));
    add_bytes(script, buffer, length);
}

static void add_data(struct script *script, uint32_t seq, const void *bytes, uint32_t size,
                     uint16_t flags)
{
    uint8_t head[MESSAGE_HEADER_BYTES];
    message_header_encode(&(struct message_header){PROTOCOL_MAJOR, MESSAGE_DATA, flags, size, seq},
                          head);
    add_bytes(script, head, sizeof(head));
    add_bytes(script, bytes, size);
}

/* A PNG file of ten bytes in two DATA messages, with PROGRESS before and between them. */
static void add_file(struct script *script, uint32_t seq)
{
    const sheen_Progress progress = {.stage = "tables", .done = 1, .total = 2};
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_PNG, 10);
    add_message(script, MESSAGE_PROGRESS, seq, &progress);
    add_message(script, MESSAGE_FRAME, seq, &frame);
    add_data(script, seq, "0123456", 7, 0);
    add_message(script, MESSAGE_PROGRESS, seq, &progress);
    add_data(script, seq, "789", 3, MESSAGE_END);
}

/* A session with three requests in flight (1 and 2 want PNG, 3 raw planes), and the daemon's end of
 * its connection. */
static struct sheen_session *script_session(int *peer)
{
    int ends[2];
    struct sheen_session *session = calloc(1, sizeof(*session));
    assert_non_null(session);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
    assert_int_equal(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
    session->connection = (struct connection){.fd = ends[0], .timeout_ms = 2000};
    session->daemon.stderr_fd = -1;
    session->hello = HELLO_OK;
    session->hello.minor = 1;
    session->hello.credits = 4;
    session->last_seq = 3;
    for (uint32_t seq = 1; seq <= 3; seq++)
        session->pending[session->n_pending++] = (struct session_pending){
            .seq = seq,
            .render = {.width_px = WIDTH,
                       .height_px = HEIGHT,
                       .planes = 1,
                       .encoding =
                           seq == 3 ? sheen_Encoding_ENCODING_RAW : sheen_Encoding_ENCODING_PNG}};
    *peer = ends[1];
    return session;
}

/* Sends the script byte by byte and calls sheen_try_receive() after each byte, passing the frames
 * in turn, until an answer is complete. *got is the frame that was passed to the last call. */
static enum sheen_status drip(struct sheen_session *session, int peer, const struct script *script,
                              size_t *sent, struct sheen_frame *frames, size_t n_frames,
                              struct sheen_frame **got)
{
    for (size_t n = 0; *sent < script->size; n++) {
        send_bytes(peer, script->bytes + (*sent)++, 1);
        *got = &frames[n % n_frames];
        enum sheen_status status = sheen_try_receive(session, NULL, *got, NULL);
        if (status != SHEEN_AGAIN)
            return status;
    }
    return SHEEN_AGAIN;
}

static void answers_come_byte_by_byte(void **state)
{
    (void)state;
    int peer;
    struct sheen_session *session = script_session(&peer);
    uint8_t planes[WIDTH * HEIGHT * 4];
    struct script script = {.size = 0};
    size_t ends[3], sent = 0;
    for (size_t i = 0; i < sizeof(planes); i++)
        planes[i] = (uint8_t)(7 * i);
    add_file(&script, 1);
    ends[0] = script.size;
    const sheen_Error refusal = {.code = sheen_ErrorCode_ERROR_OVERLOADED, .text = "full"};
    add_message(&script, MESSAGE_ERROR, 2, &refusal);
    ends[1] = script.size;
    const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_RAW, sizeof(planes));
    add_message(&script, MESSAGE_FRAME, 3, &frame);
    add_data(&script, 3, planes, sizeof(planes), MESSAGE_END);
    ends[2] = script.size;

    /* Each call may pass another frame, because the session keeps the bytes that have arrived. */
    struct sheen_frame frames[3] = {SHEEN_FRAME_DEFAULTS, SHEEN_FRAME_DEFAULTS,
                                    SHEEN_FRAME_DEFAULTS};
    struct sheen_frame *got = NULL;
    assert_int_equal(drip(session, peer, &script, &sent, frames, 3, &got), SHEEN_OK);
    assert_int_equal(sent, ends[0]);
    assert_int_equal(got->number, 1);
    assert_int_equal(got->data_bytes, 10);
    assert_memory_equal(got->data, "0123456789", 10);
    assert_int_equal(session->n_pending, 2);
    assert_int_equal(drip(session, peer, &script, &sent, frames, 3, &got), SHEEN_OVERLOADED);
    assert_int_equal(sent, ends[1]);
    assert_int_equal(got->number, 2);
    assert_int_equal(drip(session, peer, &script, &sent, frames, 3, &got), SHEEN_OK);
    assert_int_equal(sent, ends[2]);
    assert_int_equal(got->number, 3);
    assert_null(got->data);
    assert_memory_equal(got->plane[0], planes, sizeof(planes));
    assert_int_equal(sheen_try_receive(session, NULL, &frames[0], NULL), SHEEN_BAD_ARGUMENT);
    for (int i = 0; i < 3; i++)
        sheen_frame_finish(&frames[i]);
    close(peer);
    sheen_close(session);
}

/* While half of an answer has arrived, other messages can be sent, and a waiting call completes
 * it. */
static void a_half_answer_stands_in_nobodys_way(void **state)
{
    (void)state;
    int peer;
    struct sheen_session *session = script_session(&peer);
    struct script script = {.size = 0};
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
    struct sheen_stats stats = SHEEN_STATS_DEFAULTS;
    add_file(&script, 1);
    size_t half = script.size - 15;
    send_bytes(peer, script.bytes, half);
    assert_int_equal(sheen_try_receive(session, NULL, &frame, NULL), SHEEN_AGAIN);
    assert_null(frame.data);
    assert_int_equal(sheen_send(session, &request, NULL), SHEEN_OK);
    /* refused: four requests are in flight already */
    assert_int_equal(sheen_send(session, &request, NULL), SHEEN_BAD_ARGUMENT);
    assert_int_equal(sheen_cancel(session, 1, NULL), SHEEN_OK);
    assert_int_equal(sheen_query_stats(session, &stats, NULL), SHEEN_BAD_ARGUMENT);
    assert_int_equal(read_message(peer, NULL, 0).type, MESSAGE_RENDER);
    assert_int_equal(read_message(peer, NULL, 0).type, MESSAGE_CANCEL);
    send_bytes(peer, script.bytes + half, script.size - half);
    assert_int_equal(sheen_receive(session, NULL, &frame, NULL), SHEEN_OK);
    assert_memory_equal(frame.data, "0123456789", 10);
    sheen_frame_finish(&frame);
    close(peer);
    sheen_close(session);
}

static void an_end_in_the_middle_is_a_loss(void **state)
{
    (void)state;
    struct script script = {.size = 0};
    add_file(&script, 1);
    for (size_t size = 0; size < script.size; size++) {
        int peer;
        struct sheen_session *session = script_session(&peer);
        struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
        short events;
        send_bytes(peer, script.bytes, size);
        assert_int_equal(sheen_try_receive(session, NULL, &frame, NULL), SHEEN_AGAIN);
        assert_true(sheen_descriptor(session, &events) >= 0);
        assert_int_equal(events, POLLIN);
        close(peer);
        assert_int_equal(sheen_try_receive(session, NULL, &frame, NULL), SHEEN_LOST_SERVER);
        assert_int_equal(sheen_descriptor(session, &events), -1);
        assert_int_equal(events, 0);
        sheen_frame_finish(&frame);
        sheen_close(session);
    }
    assert_int_equal(sheen_descriptor(NULL, NULL), -1);
}

/* ---- over a real connection ---- */

static uint32_t raw_planes(uint8_t *bytes)
{
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        bytes[i] = (uint8_t)(3 * i);
    return WIDTH * HEIGHT * 4;
}

static void serve_raw_twice(int fd)
{
    uint8_t bytes[WIDTH * HEIGHT * 4];
    uint32_t size = raw_planes(bytes);
    greet(fd);
    for (int i = 0; i < 2; i++) {
        uint32_t seq = read_message(fd, NULL, 0).seq;
        const sheen_Frame frame = frame_of(sheen_Encoding_ENCODING_RAW, size);
        send_message(fd, MESSAGE_FRAME, seq, &frame);
        send_data(fd, seq, bytes, size, MESSAGE_END);
    }
}

static void planes_stay_as_they_came(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    uint8_t bytes[WIDTH * HEIGHT * 4];
    uint32_t size = raw_planes(bytes);
    assert_int_equal(open_session(&fake, serve_raw_twice, &session, &error), SHEEN_OK);
    request.undecoded = true;
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_OK);
    assert_null(frame.plane[0]);
    assert_int_equal(frame.data_bytes, size);
    assert_memory_equal(frame.data, bytes, size);
    request.undecoded = false;
    assert_int_equal(sheen_render(session, &request, NULL, &frame, &error), SHEEN_OK);
    assert_null(frame.data);
    assert_memory_equal(frame.plane[0], bytes, size);
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

static void an_event_loop_waits_on_the_descriptor(void **state)
{
    (void)state;
    struct fake fake;
    struct sheen_error error;
    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_RAW);
    assert_int_equal(open_session(&fake, serve_raw_twice, &session, &error), SHEEN_OK);
    assert_int_equal(sheen_try_receive(session, NULL, &frame, &error), SHEEN_BAD_ARGUMENT);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(sheen_send(session, &request, &error), SHEEN_OK);
        enum sheen_status status;
        while ((status = sheen_try_receive(session, NULL, &frame, &error)) == SHEEN_AGAIN) {
            struct pollfd entry = {.fd = sheen_descriptor(session, &entry.events)};
            assert_int_equal(poll(&entry, 1, 2000), 1);
        }
        assert_int_equal(status, SHEEN_OK);
        assert_int_equal(frame.number, sheen_last_number(session));
    }
    sheen_frame_finish(&frame);
    sheen_close(session);
    fake_finish(&fake);
}

/* ---- TLS: one record may hold several answers, or a part of one ---- */

static struct certificates certificates;

static ssize_t plain_read(void *owner, void *bytes, size_t size)
{
    return recv(*(const int *)owner, bytes, size, 0);
}

static ssize_t plain_write(void *owner, const void *bytes, size_t size)
{
    return send(*(const int *)owner, bytes, size, MSG_NOSIGNAL);
}

/* Reads one message and drops it. Returns its number, or 0 at the end of the connection. */
static uint32_t tls_read_message(struct tls_channel *channel)
{
    uint8_t bytes[MESSAGE_BUFFER_BYTES];
    struct message_header header = {.length = 0};
    size_t n_got = 0, moved;
    for (size_t wanted = MESSAGE_HEADER_BYTES; n_got < wanted; n_got += moved) {
        if (tls_read(channel, bytes + n_got, wanted - n_got, &moved) != TLS_MOVED)
            return 0;
        if (n_got + moved == MESSAGE_HEADER_BYTES &&
            message_header_decode(&header, bytes) == HEADER_OK &&
            header.length < sizeof(bytes) - 16)
            wanted += header.length;
    }
    return header.seq;
}

static void tls_send(struct tls_channel *channel, const uint8_t *bytes, size_t size)
{
    size_t moved = 0;
    for (size_t sent = 0; sent < size; sent += moved)
        if (tls_write(channel, bytes + sent, size - sent, &moved) != TLS_MOVED)
            return;
}

/* Sends two answers in one record, then one answer in which each byte is a record. */
static void *serve_records(void *listener)
{
    char text[TLS_TEXT_BYTES];
    const struct tls_files files = {.cert = certificates.cert, .key = certificates.key};
    struct tls_context *context = tls_context_create(TLS_SERVER, &files, text);
    int fd = accept(*(const int *)listener, NULL, NULL);
    const struct tls_io io = {plain_read, plain_write, &fd};
    struct tls_channel *channel = tls_channel_create(context, &io, NULL);
    struct script script = {.size = 0};
    add_message(&script, MESSAGE_HELLO_OK, tls_read_message(channel), &HELLO_OK);
    tls_send(channel, script.bytes, script.size);
    script.size = 0;
    add_file(&script, tls_read_message(channel));
    add_file(&script, tls_read_message(channel));
    tls_send(channel, script.bytes, script.size);
    script.size = 0;
    add_file(&script, tls_read_message(channel));
    for (size_t i = 0; i < script.size; i++)
        tls_send(channel, script.bytes + i, 1);
    tls_read_message(channel); /* until the client has closed the connection */
    tls_channel_destroy(channel);
    tls_context_destroy(context);
    close(fd);
    return NULL;
}

/* Receives as sheen.h describes: waits for the descriptor only when no answer is complete. Returns
 * how often it waited. */
static int receive_by_poll(struct sheen_session *session, struct sheen_frame *frame)
{
    int n_waits = 0;
    enum sheen_status status;
    while ((status = sheen_try_receive(session, NULL, frame, NULL)) == SHEEN_AGAIN) {
        struct pollfd entry = {.fd = sheen_descriptor(session, &entry.events)};
        assert_int_equal(poll(&entry, 1, 2000), 1);
        n_waits++;
    }
    assert_int_equal(status, SHEEN_OK);
    assert_memory_equal(frame->data, "0123456789", 10);
    return n_waits;
}

static void tls_reads_ahead_of_poll(void **state)
{
    (void)state;
    struct sockaddr_in name = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    socklen_t name_bytes = sizeof(name);
    char address[40];
    pthread_t thread;
    assert_int_equal(certificates_init(&certificates), 0);
    int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_int_equal(bind(listener, (const struct sockaddr *)&name, sizeof(name)), 0);
    assert_int_equal(listen(listener, 1), 0);
    assert_int_equal(getsockname(listener, (struct sockaddr *)&name, &name_bytes), 0);
    snprintf(address, sizeof(address), "tls:127.0.0.1:%d", ntohs(name.sin_port));
    assert_int_equal(pthread_create(&thread, NULL, serve_records, &listener), 0);

    struct sheen_session *session;
    struct sheen_frame frame = SHEEN_FRAME_DEFAULTS;
    struct sheen_connect_options options = SHEEN_CONNECT_DEFAULTS;
    struct sheen_request request = small_request(SHEEN_FORMAT_PNG);
    options.address = address;
    options.ca = certificates.ca;
    assert_int_equal(sheen_connect(&session, &options, NULL), SHEEN_OK);
    for (int i = 0; i < 2; i++)
        assert_int_equal(sheen_send(session, &request, NULL), SHEEN_OK);
    receive_by_poll(session, &frame);
    /* this answer came in the same record as the first */
    assert_int_equal(receive_by_poll(session, &frame), 0);
    assert_int_equal(sheen_send(session, &request, NULL), SHEEN_OK);
    receive_by_poll(session, &frame);
    assert_int_equal(frame.number, sheen_last_number(session));
    sheen_frame_finish(&frame);
    sheen_close(session);
    pthread_join(thread, NULL);
    close(listener);
    certificates_finish(&certificates);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(answers_come_byte_by_byte),
        cmocka_unit_test(a_half_answer_stands_in_nobodys_way),
        cmocka_unit_test(an_end_in_the_middle_is_a_loss),
        cmocka_unit_test(planes_stay_as_they_came),
        cmocka_unit_test(an_event_loop_waits_on_the_descriptor),
        cmocka_unit_test(tls_reads_ahead_of_poll),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
