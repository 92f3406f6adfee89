/* TLS through pipes in memory that hold few bytes, so that a channel wants to read and to write in
 * every situation. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <time.h>

#include <openssl/ssl.h>

#include "protocol/tls.h"
#include "tests/unit/certificates.h"

#define MAX_PIPE 4096

struct pipe {
    uint8_t bytes[MAX_PIPE];
    size_t used, capacity;
    bool closed;
};

struct end {
    struct pipe *in, *out;
    struct tls_channel *channel;
    unsigned wanted_read, wanted_write;
};

static struct certificates files;
static struct tls_context *server_context, *client_context;

static ssize_t pipe_read(void *owner, void *bytes, size_t size)
{
    const struct end *end = owner;
    struct pipe *pipe = end->in;
    size_t n = size < pipe->used ? size : pipe->used;
    if (n == 0 && pipe->closed)
        return 0;
    if (n == 0) {
        errno = EAGAIN;
        return -1;
    }
    memcpy(bytes, pipe->bytes, n);
    memmove(pipe->bytes, pipe->bytes + n, pipe->used -= n);
    return (ssize_t)n;
}

static ssize_t pipe_write(void *owner, const void *bytes, size_t size)
{
    const struct end *end = owner;
    struct pipe *pipe = end->out;
    size_t room = pipe->capacity - pipe->used, n = size < room ? size : room;
    if (n == 0) {
        errno = EAGAIN;
        return -1;
    }
    memcpy(pipe->bytes + pipe->used, bytes, n);
    pipe->used += n;
    return (ssize_t)n;
}

struct pair {
    struct pipe up, down;
    struct end client, server;
};

static void pair_init(struct pair *pair, size_t capacity, struct tls_context *client,
                      const char *host)
{
    *pair = (struct pair){.up = {.capacity = capacity}, .down = {.capacity = capacity}};
    pair->client = (struct end){.in = &pair->down, .out = &pair->up};
    pair->server = (struct end){.in = &pair->up, .out = &pair->down};
    const struct tls_io client_io = {pipe_read, pipe_write, &pair->client};
    const struct tls_io server_io = {pipe_read, pipe_write, &pair->server};
    pair->client.channel = tls_channel_create(client, &client_io, host);
    pair->server.channel = tls_channel_create(server_context, &server_io, NULL);
    assert_non_null(pair->client.channel);
    assert_non_null(pair->server.channel);
}

static void pair_finish(struct pair *pair)
{
    tls_channel_destroy(pair->client.channel);
    tls_channel_destroy(pair->server.channel);
}

static void count_wants(struct end *end, enum tls_result result)
{
    end->wanted_read += result == TLS_WANTS_READ;
    end->wanted_write += result == TLS_WANTS_WRITE;
}

/* Moves n bytes from one end to the other and compares them. */
static enum tls_result move(struct end *from, struct end *to, size_t n)
{
    static uint8_t sent[100000], got[100000];
    size_t written = 0, read = 0;
    for (size_t i = 0; i < n; i++)
        sent[i] = (uint8_t)(i * i >> 3);
    for (unsigned turns = 0; read < n; turns++) {
        size_t moved;
        assert_true(turns < 1000000);
        if (written < n) {
            enum tls_result result = tls_write(from->channel, sent + written, n - written, &moved);
            written += moved;
            count_wants(from, result);
            if (result == TLS_FAILED)
                return result;
        }
        enum tls_result result = tls_read(to->channel, got + read, n - read, &moved);
        read += moved;
        count_wants(to, result);
        if (result == TLS_FAILED || result == TLS_ENDED)
            return result;
    }
    assert_memory_equal(sent, got, n);
    return TLS_MOVED;
}

static void test_narrow_pipes(void **state)
{
    (void)state;
    static struct pair pair;
    const size_t capacities[] = {1, 7, 100, MAX_PIPE};
    for (size_t i = 0; i < sizeof capacities / sizeof *capacities; i++) {
        pair_init(&pair, capacities[i], client_context, "localhost");
        assert_int_equal(move(&pair.client, &pair.server, 5000), TLS_MOVED);
        assert_int_equal(move(&pair.server, &pair.client, 100000), TLS_MOVED);
        assert_int_equal(move(&pair.client, &pair.server, 1), TLS_MOVED);
        assert_true(pair.server.wanted_read > 0);
        if (capacities[i] <= 100) /* also during the handshake, while it reads */
            assert_true(pair.server.wanted_write > 0);
        assert_string_equal(tls_reason(pair.server.channel), "");
        assert_int_equal(tls_fault(pair.server.channel), TLS_NO_FAULT);
        pair_finish(&pair);
    }
}

static void test_end_and_cut(void **state)
{
    (void)state;
    static struct pair pair;
    uint8_t byte;
    size_t moved;
    pair_init(&pair, MAX_PIPE, client_context, "127.0.0.1");
    assert_int_equal(move(&pair.client, &pair.server, 10), TLS_MOVED);
    tls_end(pair.client.channel);
    assert_int_equal(tls_read(pair.server.channel, &byte, 1, &moved), TLS_ENDED);
    pair_finish(&pair);
    /* A connection that closes without TLS's closing message is an error and no end. */
    pair_init(&pair, MAX_PIPE, client_context, "127.0.0.1");
    assert_int_equal(move(&pair.client, &pair.server, 10), TLS_MOVED);
    pair.up.closed = true;
    assert_int_equal(tls_read(pair.server.channel, &byte, 1, &moved), TLS_FAILED);
    assert_int_equal(tls_read(pair.server.channel, &byte, 1, &moved), TLS_FAILED);
    assert_int_equal(tls_write(pair.server.channel, &byte, 1, &moved), TLS_FAILED);
    assert_string_not_equal(tls_reason(pair.server.channel), "");
    assert_int_equal(tls_fault(pair.server.channel), TLS_PEER_GONE);
    pair_finish(&pair);
}

static void test_pending(void **state)
{
    (void)state;
    static struct pair pair;
    uint8_t bytes[100] = {0};
    size_t moved;
    pair_init(&pair, MAX_PIPE, client_context, "localhost");
    assert_int_equal(move(&pair.client, &pair.server, 10), TLS_MOVED);
    assert_int_equal(tls_write(pair.client.channel, bytes, 100, &moved), TLS_MOVED);
    assert_int_equal(tls_read(pair.server.channel, bytes, 30, &moved), TLS_MOVED);
    assert_int_equal(tls_pending(pair.server.channel), 70);
    pair_finish(&pair);
}

/* --- a client that behaves as tls.c never does */

/* Passes everything that `ssl` has to send to the other end. */
static void say(SSL *ssl, const struct end *end)
{
    char *bytes = NULL;
    long n = BIO_get_mem_data(SSL_get_wbio(ssl), &bytes);
    assert_int_equal(pipe_write((void *)(uintptr_t)end, bytes, (size_t)n), n);
    assert_int_equal(BIO_reset(SSL_get_wbio(ssl)), 1);
}

static void shake_hands(SSL *ssl, const struct pair *pair)
{
    uint8_t bytes[MAX_PIPE];
    size_t moved;
    while (SSL_do_handshake(ssl) != 1) {
        say(ssl, &pair->client);
        assert_int_equal(tls_read(pair->server.channel, bytes, sizeof bytes, &moved),
                         TLS_WANTS_READ);
        ssize_t n = pipe_read((void *)(uintptr_t)&pair->client, bytes, sizeof bytes);
        assert_int_equal(BIO_write(SSL_get_rbio(ssl), bytes, (int)n), n);
    }
}

/* A single call must return, though the peer may send new keys for ever. */
static void test_key_updates(void **state)
{
    (void)state;
    enum { UPDATES = 50 };
    static struct pair pair;
    uint8_t byte;
    size_t moved, n;
    SSL_CTX *ctx = SSL_CTX_new(TLS_client_method());
    SSL *ssl = SSL_new(ctx);
    pair_init(&pair, MAX_PIPE, client_context, "localhost");
    SSL_set_bio(ssl, BIO_new(BIO_s_mem()), BIO_new(BIO_s_mem()));
    SSL_set_connect_state(ssl);
    shake_hands(ssl, &pair);
    for (int i = 0; i < UPDATES; i++) {
        assert_int_equal(SSL_key_update(ssl, SSL_KEY_UPDATE_NOT_REQUESTED), 1);
        assert_int_equal(SSL_do_handshake(ssl), 1);
    }
    assert_int_equal(SSL_write_ex(ssl, "x", 1, &n), 1);
    say(ssl, &pair.client);

    unsigned turns = 0;
    enum tls_result result;
    while ((result = tls_read(pair.server.channel, &byte, 1, &moved)) == TLS_WANTS_READ)
        assert_true(++turns < 2 * UPDATES);
    assert_int_equal(result, TLS_MOVED);
    assert_int_equal(byte, 'x');
    assert_true(turns >= UPDATES);
    SSL_free(ssl);
    SSL_CTX_free(ctx);
    pair_finish(&pair);
}

static void test_wrong_host(void **state)
{
    (void)state;
    static struct pair pair;
    const char *const hosts[] = {"example.org", "127.0.0.2", "::1"};
    for (size_t i = 0; i < sizeof hosts / sizeof *hosts; i++) {
        pair_init(&pair, MAX_PIPE, client_context, hosts[i]);
        assert_int_equal(move(&pair.server, &pair.client, 10), TLS_FAILED);
        assert_non_null(strstr(tls_reason(pair.client.channel), "mismatch"));
        assert_int_equal(tls_fault(pair.client.channel), TLS_PEER_UNTRUSTED);
        /* The client sent an alert that says so. */
        assert_int_equal(move(&pair.client, &pair.server, 10), TLS_FAILED);
        uint8_t byte;
        size_t moved;
        assert_int_equal(tls_read(pair.server.channel, &byte, 1, &moved), TLS_FAILED);
        assert_int_equal(tls_fault(pair.server.channel), TLS_PEER_GONE);
        pair_finish(&pair);
    }
}

static void test_no_tls(void **state)
{
    (void)state;
    static struct pair pair;
    uint8_t byte;
    size_t moved;
    pair_init(&pair, MAX_PIPE, client_context, "localhost");
    pipe_write(&pair.server, "HTTP/1.1 400 Bad Request\r\n\r\n", 28);
    assert_int_equal(tls_read(pair.client.channel, &byte, 1, &moved), TLS_FAILED);
    assert_int_equal(tls_fault(pair.client.channel), TLS_NO_TLS);
    pair_finish(&pair);
}

static void test_peer(void **state)
{
    (void)state;
    static struct pair pair;
    struct tls_peer peer, again;
    char text[TLS_TEXT_BYTES];
    int64_t now = time(NULL);
    pair_init(&pair, MAX_PIPE, client_context, "localhost");
    assert_int_equal(move(&pair.client, &pair.server, 10), TLS_MOVED);
    assert_false(tls_peer(pair.server.channel, &peer));
    assert_true(tls_peer(pair.client.channel, &peer));
    assert_string_equal(peer.subject, "CN=server");
    pair_finish(&pair);

    const struct tls_files anna = {
        .cert = files.client_cert, .key = files.client_key, .ca = files.ca};
    struct tls_context *context = tls_context_create(TLS_CLIENT, &anna, text);
    assert_non_null(context);
    pair_init(&pair, MAX_PIPE, context, "localhost");
    tls_context_destroy(context); /* the channel keeps its own reference */
    assert_int_equal(move(&pair.client, &pair.server, 10), TLS_MOVED);
    assert_true(tls_peer(pair.server.channel, &again));
    assert_string_equal(again.subject, "CN=anna");
    assert_string_equal(again.issuer, peer.issuer);
    assert_memory_equal(again.issuer_key, peer.issuer_key, sizeof peer.issuer_key);
    assert_true(again.expires_s > now + 86400 && again.expires_s < now + 3 * 86400);
    pair_finish(&pair);
}

static void test_bad_files(void **state)
{
    (void)state;
    char text[TLS_TEXT_BYTES];
    const struct tls_files bad[] = {{.cert = files.cert}, /* the file with its key is missing */
                                    {.cert = "/no/such", .key = files.key},
                                    {.cert = files.cert, .key = "/no/such"},
                                    {.cert = files.cert, .key = files.client_key},
                                    {.cert = files.key, .key = files.key},
                                    {.ca = "/no/such"},
                                    {.ca = files.key}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (int side = TLS_SERVER; side <= TLS_CLIENT; side++) {
            text[0] = 0;
            assert_null(tls_context_create(side, &bad[i], text));
            assert_string_not_equal(text, "");
            assert_null(strchr(text, '\n'));
        }
}

static int set_up(void **state)
{
    (void)state;
    char text[TLS_TEXT_BYTES];
    if (certificates_init(&files) != 0)
        return 1;
    const struct tls_files server = {.cert = files.cert, .key = files.key, .ca = files.ca};
    const struct tls_files client = {.ca = files.ca};
    server_context = tls_context_create(TLS_SERVER, &server, text);
    client_context = tls_context_create(TLS_CLIENT, &client, text);
    return !server_context || !client_context;
}

static int tear_down(void **state)
{
    (void)state;
    tls_context_destroy(server_context);
    tls_context_destroy(client_context);
    certificates_finish(&files);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_narrow_pipes), cmocka_unit_test(test_end_and_cut),
        cmocka_unit_test(test_pending),      cmocka_unit_test(test_wrong_host),
        cmocka_unit_test(test_no_tls),       cmocka_unit_test(test_peer),
        cmocka_unit_test(test_bad_files),    cmocka_unit_test(test_key_updates),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
