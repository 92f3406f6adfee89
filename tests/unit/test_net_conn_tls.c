/* A connection whose TLS handshake does not fit the socket's buffer, because the certificates are
 * larger than the buffer and the peer reads slowly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/net/conn_tls.h"
#include "tests/unit/certificates.h"

#define ANSWER_BYTES 200000u

struct fixture {
    struct loop *loop;
    struct conn conn;
    uint64_t sent_bytes;
    int peer;
    atomic_bool wanted_write; /* reading had to wait until TLS could write */
    uint8_t answer[ANSWER_BYTES];
};

static void on_message(void *owner, const struct message_header *header, const uint8_t *body)
{
    struct fixture *f = owner;
    (void)body;
    assert_int_equal(header->type, MESSAGE_STATS_QUERY);
    conn_send_block(&f->conn, f->answer, sizeof f->answer, NULL, NULL);
    conn_flush(&f->conn);
}

static void on_malformed(void *owner, const struct message_header *header, enum header_error error)
{
    (void)owner;
    (void)header;
    fail_msg("malformed: %d", (int)error);
}

static void after(void *owner)
{
    struct fixture *f = owner;
    if (f->conn.read_wants_write)
        atomic_store(&f->wanted_write, true);
    if (f->conn.peer_ended)
        conn_close_after_flush(&f->conn);
    if (f->conn.state == CONN_CLOSED)
        loop_stop(f->loop);
}

static void tick(void *owner)
{
    (void)owner;
}

static void *serve(void *loop)
{
    loop_run(loop);
    return NULL;
}

static ssize_t peer_read(void *owner, void *bytes, size_t size)
{
    const struct fixture *f = owner;
    return recv(f->peer, bytes, size, MSG_DONTWAIT);
}

static ssize_t peer_write(void *owner, const void *bytes, size_t size)
{
    const struct fixture *f = owner;
    return send(f->peer, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL);
}

static void wait_for_peer(const struct fixture *f, enum tls_result result)
{
    struct pollfd entry = {f->peer, result == TLS_WANTS_READ ? POLLIN : POLLOUT, 0};
    assert_true(result == TLS_WANTS_READ || result == TLS_WANTS_WRITE);
    assert_int_equal(poll(&entry, 1, 10000), 1);
}

static void ask_and_read(const struct fixture *f, struct tls_channel *channel)
{
    static uint8_t got[ANSWER_BYTES];
    uint8_t ask[MESSAGE_HEADER_BYTES];
    const struct message_header header = {PROTOCOL_MAJOR, MESSAGE_STATS_QUERY, 0, 0, 1};
    size_t moved, n = 0;
    message_header_encode(&header, ask);
    assert_int_equal(tls_write(channel, ask, sizeof ask, &moved), TLS_WANTS_READ);
    usleep(100000); /* the socket's buffer is full of the server's certificates by now */
    for (enum tls_result result; (result = tls_write(channel, ask, sizeof ask, &moved));)
        wait_for_peer(f, result);
    while (n < sizeof got) {
        enum tls_result result = tls_read(channel, got + n, sizeof got - n, &moved);
        n += moved;
        if (result != TLS_MOVED)
            wait_for_peer(f, result);
    }
    assert_memory_equal(got, f->answer, sizeof got);
}

static void test_certificates_larger_than_the_buffer(void **state)
{
    static const struct conn_handler handler = {.message = on_message, .malformed = on_malformed};
    static struct fixture f;
    const struct certificates *files = *state;
    const struct loop_hooks hooks = {after, tick, &f};
    char chain[128], text[TLS_TEXT_BYTES];
    struct error error = {0};
    int ends[2], least = 1;
    pthread_t thread;

    snprintf(chain, sizeof chain, "%s/chain.pem", files->folder);
    assert_int_equal(shell("cat %s >%s; for i in $(seq 60); do cat %s >>%s; done", files->cert,
                           chain, files->ca, chain),
                     0);
    const struct tls_files server = {.cert = chain, .key = files->key};
    const struct tls_files client = {.ca = files->ca};
    struct tls_context *server_context = tls_context_create(TLS_SERVER, &server, text);
    struct tls_context *client_context = tls_context_create(TLS_CLIENT, &client, text);
    assert_non_null(server_context);
    assert_non_null(client_context);

    for (size_t i = 0; i < sizeof f.answer; i++)
        f.answer[i] = (uint8_t)(i * 7 >> 2);
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    f.peer = ends[1];
    setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &least, sizeof least);
    f.loop = loop_create(&hooks, &error);
    assert_true(conn_init(&f.conn, f.loop, ends[0], &handler, &f, &f.sent_bytes, &error));
    assert_true(conn_start_tls(&f.conn, server_context, &error));
    assert_int_equal(pthread_create(&thread, NULL, serve, f.loop), 0);

    const struct tls_io io = {peer_read, peer_write, &f};
    struct tls_channel *channel = tls_channel_create(client_context, &io, "localhost");
    assert_non_null(channel);
    ask_and_read(&f, channel);
    assert_true(atomic_load(&f.wanted_write));
    tls_end(channel);
    tls_channel_destroy(channel);
    close(f.peer);
    pthread_join(thread, NULL);

    assert_int_equal(f.sent_bytes, ANSWER_BYTES);
    conn_finish(&f.conn);
    loop_destroy(f.loop);
    tls_context_destroy(server_context);
    tls_context_destroy(client_context);
}

static int set_up(void **state)
{
    static struct certificates files;
    *state = &files;
    return certificates_init(&files);
}

static int tear_down(void **state)
{
    certificates_finish(*state);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_certificates_larger_than_the_buffer)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
