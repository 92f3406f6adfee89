/* How frames are sent: encoded by a pool of threads, answered in the order of their requests, and
 * cut into DATA messages. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/base/block_cache.h"
#include "server/session/reply.h"
#include "tests/unit/build_folder.h"
#include "tests/unit/jpeg_file.h"
#include "tests/unit/png_file.h"

enum {
    WIDTH = 811,
    HEIGHT = 523
}; /* odd; several strips for each plane, several DATA for each
                                     * frame */

static const struct image_attribute METADATA[] = {{"sheen:version", "1.2.3"}};

struct fixture {
    struct loop *loop;
    struct completions *completions;
    struct pool *pool;
    struct workers workers;
    struct conn conn;
    struct reply_list replies;
    int peer; /* the client's end */
    uint64_t sent_bytes;
    struct encoded *encoded[2]; /* of the last call of encode() */
    size_t n_encoded;
};

static void nothing(void *owner)
{
    (void)owner;
}

static int setup(void **state)
{
    static const struct conn_handler handler = {0};
    struct fixture *f = calloc(1, sizeof *f);
    const struct loop_hooks hooks = {nothing, nothing, NULL};
    int ends[2];
    struct error error = {0};
    const struct workers_limits limits = {(uint64_t)1 << 33, (uint64_t)1 << 33, 60, 120};
    assert_non_null(f);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    f->loop = loop_create(&hooks, &error);
    f->completions = completions_create(f->loop, &error);
    f->pool = pool_create("test", 3, 1, &encode_context, f->completions, &error);
    assert_non_null(f->pool);
    assert_true(workers_init(&f->workers, build_folder(), &limits, (uint64_t)1 << 32, &error));
    assert_true(conn_init(&f->conn, f->loop, ends[0], &handler, NULL, &f->sent_bytes, &error));
    f->peer = ends[1];
    reply_list_init(&f->replies, NULL);
    f->replies.is_ordered = true;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    reply_list_finish(&f->replies);
    conn_finish(&f->conn);
    close(f->peer);
    pool_destroy(f->pool);
    workers_finish(&f->workers);
    completions_destroy(f->completions);
    loop_destroy(f->loop);
    free(f);
    return 0;
}

static struct frame make_frame(uint32_t planes)
{
    struct frame frame = {.width_px = WIDTH, .height_px = HEIGHT};
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++) {
        size_t size = (size_t)WIDTH * HEIGHT * codec_pixel_bytes(plane);
        if (!(planes & (1u << plane)))
            continue;
        uint8_t *bytes = block_cache_take(NULL, size);
        assert_non_null(bytes);
        for (size_t i = 0; i < size; i++)
            bytes[i] = (uint8_t)((i * i + plane) >> 7);
        frame.plane[plane] = bytes;
    }
    return frame;
}

static void encode_finished(void *owner, struct encoded *encoded, const struct error *error)
{
    struct fixture *f = owner;
    if (error)
        fail_msg("%s", error->text);
    assert_true(f->n_encoded < 2);
    f->encoded[f->n_encoded++] = encoded;
    loop_stop(f->loop);
}

/* Takes ownership of the frame. */
static void start_frame(struct fixture *f, struct frame frame, uint32_t planes,
                        sheen_Encoding encoding)
{
    struct codec_layout layout;
    assert_true(codec_layout_init(&layout, WIDTH, HEIGHT, planes));
    const struct encode_format format = {encoding, JPEG_DEFAULTS};
    encode_start(f->pool, &f->workers, &frame, &layout, &format, POOL_SOON, METADATA, 1,
                 encode_finished, f);
    assert_null(frame.plane[0]);
}

static void start_encoding(struct fixture *f, uint32_t planes, sheen_Encoding encoding)
{
    start_frame(f, make_frame(planes), planes, encoding);
}

/* The concatenated bytes of all pieces; the caller frees them. */
static uint8_t *join(const struct encoded *encoded)
{
    uint8_t *bytes = malloc(encoded->size), *end = bytes;
    assert_non_null(bytes);
    for (size_t i = 0; i < encoded->n_pieces; i++) {
        memcpy(end, encoded->pieces[i].bytes, encoded->pieces[i].size);
        end += encoded->pieces[i].size;
    }
    assert_int_equal(end - bytes, encoded->size);
    return bytes;
}

static struct encoded *encode(struct fixture *f, uint32_t planes, sheen_Encoding encoding)
{
    f->n_encoded = 0;
    start_encoding(f, planes, encoding);
    while (f->n_encoded == 0)
        completions_deliver(f->completions);
    return f->encoded[0];
}

static void test_zstd_round_trip(void **state)
{
    struct fixture *f = *state;
    struct encoded *encoded = encode(f, CODEC_ALL_PLANES, sheen_Encoding_ENCODING_ZSTD);
    uint8_t *bytes = join(encoded);
    struct codec_layout layout;
    assert_true(codec_layout_init(&layout, WIDTH, HEIGHT, CODEC_ALL_PLANES));
    struct frame want = make_frame(CODEC_ALL_PLANES), got = make_frame(CODEC_ALL_PLANES);
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++)
        memset(got.plane[plane], 0, codec_plane_bytes(&layout, plane));
    struct codec_decoder *decoder = codec_decoder_create();
    assert_null(codec_zstd_decode(decoder, &layout, bytes, encoded->size, got.plane));
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++)
        assert_memory_equal(got.plane[plane], want.plane[plane], codec_plane_bytes(&layout, plane));
    codec_decoder_destroy(decoder);
    frame_finish(&want);
    frame_finish(&got);
    free(bytes);
    encoded_destroy(encoded);
}

/* Three threads encode; each takes the next free strip. */
static void test_two_jpeg_files_at_once(void **state)
{
    struct fixture *f = *state;
    struct frame frame = make_frame(1);
    struct jpeg_encoder *encoder = jpeg_encoder_create();
    size_t size;
    uint8_t *want = jpeg_file(encoder, frame.plane[0], WIDTH, HEIGHT, METADATA, 1, &size);
    for (int i = 0; i < 2; i++)
        start_encoding(f, 1, sheen_Encoding_ENCODING_JPEG);
    while (f->n_encoded < 2)
        completions_deliver(f->completions);
    for (int i = 0; i < 2; i++) {
        uint8_t *got = join(f->encoded[i]);
        assert_int_equal(f->encoded[i]->size, size);
        assert_memory_equal(got, want, size);
        free(got);
        encoded_destroy(f->encoded[i]);
    }
    free(want);
    jpeg_encoder_destroy(encoder);
    frame_finish(&frame);
}

/* A picture whose alpha is 255 except in one pixel, or in all pixels (pixel < 0). */
static struct frame make_picture(long pixel)
{
    struct frame frame = make_frame(1);
    uint8_t *rgba = frame.plane[0];
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        rgba[4 * i + 3] = (long)i == pixel ? 77 : 255;
    return frame;
}

/* Threads look for transparent pixels while other strips are being encoded. The file does not
 * depend on which thread finds one first. */
static void test_png_files(void **state)
{
    struct fixture *f = *state;
    const long last = (long)WIDTH * HEIGHT - 1, cases[] = {-1, 0, last / 2, last};
    struct png_encoder *encoder = png_encoder_create();
    for (int i = 0; i < 24; i++) {
        struct frame frame = make_picture(cases[i % 4]);
        size_t size;
        uint8_t *want = png_file(encoder, frame.plane[0], WIDTH, HEIGHT, METADATA, 1, &size);
        f->n_encoded = 0;
        start_frame(f, frame, 1, sheen_Encoding_ENCODING_PNG);
        while (f->n_encoded == 0)
            completions_deliver(f->completions);
        uint8_t *got = join(f->encoded[0]);
        assert_int_equal(f->encoded[0]->size, size);
        assert_memory_equal(got, want, size);
        free(got);
        encoded_destroy(f->encoded[0]);
        free(want);
    }
    png_encoder_destroy(encoder);
}

/* Reads exactly n bytes, and lets the connection write what it has buffered. */
static void read_exactly(struct fixture *f, void *bytes, size_t n)
{
    for (uint8_t *to = bytes; n > 0;) {
        ssize_t got = recv(f->peer, to, n, MSG_DONTWAIT);
        if (got > 0) {
            to += got;
            n -= (size_t)got;
        } else {
            size_t unsent = conn_unsent_bytes(&f->conn);
            conn_flush(&f->conn);
            assert_true(conn_unsent_bytes(&f->conn) < unsent);
        }
    }
}

static struct message_header read_header(struct fixture *f, void *body, size_t capacity)
{
    uint8_t bytes[MESSAGE_HEADER_BYTES];
    struct message_header header;
    read_exactly(f, bytes, sizeof bytes);
    assert_int_equal(message_header_decode(&header, bytes), HEADER_OK);
    assert_true(header.length <= capacity);
    read_exactly(f, body, header.length);
    return header;
}

static void expect_silence(struct fixture *f)
{
    uint8_t byte;
    assert_int_equal(recv(f->peer, &byte, 1, MSG_DONTWAIT), -1);
}

static sheen_Frame frame_message(const struct encoded *encoded)
{
    return (sheen_Frame){.width_px = WIDTH,
                         .height_px = HEIGHT,
                         .planes = CODEC_ALL_PLANES,
                         .data_bytes = encoded->size};
}

static void test_frame_is_cut_into_data(void **state)
{
    struct fixture *f = *state;
    struct encoded *encoded = encode(f, CODEC_ALL_PLANES, sheen_Encoding_ENCODING_RAW);
    uint64_t size = encoded->size, seen = 0;
    assert_true(size > 5ull * PROTOCOL_MAX_DATA_BYTES);
    struct reply *reply = reply_expect_frame(&f->replies, 7, CLASS_STILL);
    sheen_Frame message = frame_message(encoded);
    assert_true(reply_fill_frame(reply, &message, encoded));
    reply_send_due(&f->replies, &f->conn);

    uint8_t *data = malloc(size + PROTOCOL_MAX_DATA_BYTES);
    assert_non_null(data);
    assert_int_equal(read_header(f, data, PROTOCOL_MAX_SMALL_BODY_BYTES).type, MESSAGE_FRAME);
    for (bool end = false; !end;) {
        struct message_header header = read_header(f, data + seen, PROTOCOL_MAX_DATA_BYTES);
        assert_int_equal(header.type, MESSAGE_DATA);
        assert_int_equal(header.seq, 7);
        seen += header.length;
        end = header.flags & MESSAGE_END;
        assert_true(end == (seen == size));
        assert_true(end || header.length == PROTOCOL_MAX_DATA_BYTES);
    }
    struct frame want = make_frame(CODEC_ALL_PLANES);
    const uint8_t *at = data;
    for (unsigned plane = 0; plane < PLANE_COUNT; plane++) {
        size_t plane_bytes = (size_t)WIDTH * HEIGHT * codec_pixel_bytes(plane);
        assert_memory_equal(at, want.plane[plane], plane_bytes);
        at += plane_bytes;
    }
    frame_finish(&want);
    free(data);
    assert_int_equal(conn_unsent_bytes(&f->conn), 0);
}

static void test_order_of_requests(void **state)
{
    struct fixture *f = *state;
    uint8_t body[PROTOCOL_MAX_SMALL_BODY_BYTES];
    struct reply *a[3];
    const sheen_UploadState done = {true, 1};
    for (uint32_t i = 0; i < 3; i++)
        a[i] = reply_expect(&f->replies, 10 + i);
    assert_int_equal(f->replies.n, 3);
    for (int i = 2; i > 0; i--) {
        assert_true(reply_fill(a[i], MESSAGE_UPLOAD_STATE, &done));
        reply_send_due(&f->replies, &f->conn);
        expect_silence(f);
    }
    assert_true(reply_fill(a[0], MESSAGE_UPLOAD_STATE, &done));
    reply_send_due(&f->replies, &f->conn);
    for (uint32_t i = 0; i < 3; i++)
        assert_int_equal(read_header(f, body, sizeof body).seq, 10 + i);
    assert_int_equal(f->replies.n, 0);
}

static void fill_picture(struct fixture *f, struct reply *reply)
{
    struct encoded *encoded = encode(f, 1, sheen_Encoding_ENCODING_PNG);
    sheen_Frame message = frame_message(encoded);
    message.planes = 1;
    assert_true(reply_fill_frame(reply, &message, encoded));
    reply_send_due(&f->replies, &f->conn);
}

/* Reads a FRAME message and all of its DATA. */
static void expect_frame(struct fixture *f, uint32_t seq)
{
    uint8_t *body = malloc(PROTOCOL_MAX_DATA_BYTES);
    assert_non_null(body);
    struct message_header header = read_header(f, body, PROTOCOL_MAX_DATA_BYTES);
    assert_int_equal(header.type, MESSAGE_FRAME);
    assert_int_equal(header.seq, seq);
    do {
        header = read_header(f, body, PROTOCOL_MAX_DATA_BYTES);
        assert_int_equal(header.type, MESSAGE_DATA);
        assert_int_equal(header.seq, seq);
    } while (!(header.flags & MESSAGE_END));
    free(body);
}

/* A frame waits for earlier frames of its class, and for no other reply. */
static void test_frames_wait_for_frames_of_their_class(void **state)
{
    struct fixture *f = *state;
    uint8_t body[PROTOCOL_MAX_SMALL_BODY_BYTES];
    const sheen_UploadState done = {true, 1};
    f->replies.is_ordered = false;
    struct reply *other = reply_expect(&f->replies, 1),
                 *batch = reply_expect_frame(&f->replies, 2, CLASS_BATCH),
                 *first = reply_expect_frame(&f->replies, 3, CLASS_STILL),
                 *second = reply_expect_frame(&f->replies, 4, CLASS_STILL),
                 *quick = reply_expect_frame(&f->replies, 5, CLASS_INTERACTIVE);
    fill_picture(f, quick);
    expect_frame(f, 5);
    fill_picture(f, second);
    expect_silence(f);
    fill_picture(f, first);
    expect_frame(f, 3);
    expect_frame(f, 4);
    assert_true(reply_fill(other, MESSAGE_UPLOAD_STATE, &done));
    reply_send_due(&f->replies, &f->conn);
    assert_int_equal(read_header(f, body, sizeof body).seq, 1);
    expect_silence(f);
    fill_picture(f, batch);
    expect_frame(f, 2);
    assert_int_equal(f->replies.n, 0);
}

/* The records of a computation leave at once, although an earlier frame of each class is owed, and later frames do not
 * wait for the records. */
static void test_records_and_frames_do_not_wait_for_each_other(void **state)
{
    struct fixture *f = *state;
    static uint8_t body[PROTOCOL_MAX_DATA_BYTES];
    const sheen_Superseded answer = {.by = 7};
    f->replies.is_ordered = false;
    struct reply *frame = reply_expect_frame(&f->replies, 1, CLASS_BATCH);
    struct reply *records = reply_expect(&f->replies, 2), *late = reply_expect(&f->replies, 3);
    struct reply *other = reply_expect_frame(&f->replies, 4, CLASS_STILL);
    uint8_t *bytes = block_cache_take(NULL, 5);
    memcpy(bytes, "12345", 5);
    assert_true(
        reply_fill_records(records, MESSAGE_SUPERSEDED, &answer, encoded_of(NULL, bytes, 5)));
    reply_send_due(&f->replies, &f->conn);
    assert_int_equal(read_header(f, body, sizeof body).seq, 2);
    struct message_header header = read_header(f, body, sizeof body);
    assert_int_equal(header.type, MESSAGE_DATA);
    assert_int_equal(header.flags, MESSAGE_END);
    assert_int_equal(header.length, 5);
    assert_memory_equal(body, "12345", 5);
    assert_true(reply_fill(other, MESSAGE_SUPERSEDED, &answer));
    reply_send_due(&f->replies, &f->conn);
    assert_int_equal(read_header(f, body, sizeof body).seq, 4);
    /* Without records there is no DATA. */
    assert_true(reply_fill_records(late, MESSAGE_SUPERSEDED, &answer, NULL));
    assert_true(reply_fill(frame, MESSAGE_SUPERSEDED, &answer));
    reply_send_due(&f->replies, &f->conn);
    assert_int_equal(read_header(f, body, sizeof body).seq, 1);
    assert_int_equal(read_header(f, body, sizeof body).seq, 3);
    expect_silence(f);
}

static void test_nothing_after_the_last(void **state)
{
    struct fixture *f = *state;
    uint8_t body[PROTOCOL_MAX_SMALL_BODY_BYTES];
    const sheen_UploadState done = {true, 1};
    struct reply *first = reply_expect(&f->replies, 1), *last = reply_expect(&f->replies, 2),
                 *late = reply_expect(&f->replies, 3);
    reply_mark_last(last);
    assert_true(reply_fill(last, MESSAGE_UPLOAD_STATE, &done));
    assert_true(reply_fill(late, MESSAGE_UPLOAD_STATE, &done));
    reply_send_due(&f->replies, &f->conn);
    expect_silence(f);
    assert_int_equal(f->conn.state, CONN_OPEN);
    assert_true(reply_fill(first, MESSAGE_UPLOAD_STATE, &done));
    reply_send_due(&f->replies, &f->conn);
    assert_int_equal(read_header(f, body, sizeof body).seq, 1);
    assert_int_equal(read_header(f, body, sizeof body).seq, 2);
    assert_int_equal(recv(f->peer, body, 1, 0), 0);
    assert_int_equal(f->conn.state, CONN_LINGERING);
}

/* The client reads nothing: unsent bytes are freed when the connection closes, as a leak checker
 * confirms. */
static void test_closed_with_a_frame_unsent(void **state)
{
    struct fixture *f = *state;
    struct encoded *encoded = encode(f, CODEC_ALL_PLANES, sheen_Encoding_ENCODING_RAW);
    sheen_Frame message = frame_message(encoded);
    assert_true(
        reply_fill_frame(reply_expect_frame(&f->replies, 1, CLASS_STILL), &message, encoded));
    reply_send_due(&f->replies, &f->conn);
    assert_true(conn_unsent_bytes(&f->conn) > 0);
    conn_close(&f->conn);
    assert_int_equal(conn_unsent_bytes(&f->conn), 0);
    encoded = encode(f, 1, sheen_Encoding_ENCODING_PNG);
    message = frame_message(encoded);
    assert_true(
        reply_fill_frame(reply_expect_frame(&f->replies, 2, CLASS_STILL), &message, encoded));
    reply_send_due(&f->replies, &f->conn);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_zstd_round_trip, setup, teardown),
        cmocka_unit_test_setup_teardown(test_two_jpeg_files_at_once, setup, teardown),
        cmocka_unit_test_setup_teardown(test_png_files, setup, teardown),
        cmocka_unit_test_setup_teardown(test_frame_is_cut_into_data, setup, teardown),
        cmocka_unit_test_setup_teardown(test_order_of_requests, setup, teardown),
        cmocka_unit_test_setup_teardown(test_frames_wait_for_frames_of_their_class, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_records_and_frames_do_not_wait_for_each_other, setup,
                                        teardown),
        cmocka_unit_test_setup_teardown(test_nothing_after_the_last, setup, teardown),
        cmocka_unit_test_setup_teardown(test_closed_with_a_frame_unsent, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
