/* Opening and closing a session. */
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client/lib/session.h"
#include "client/lib/sized.h"
#include "client/lib/status.h"

/* The timeout until the daemon's greeting has come. */
static uint32_t connect_timeout_ms(const struct sheen_connect_options *options)
{
    return options->connect_timeout_ms ? options->connect_timeout_ms : options->timeout_ms;
}

static enum sheen_status start_private(struct sheen_session *session,
                                       const struct sheen_connect_options *options,
                                       struct sheen_error *error)
{
    int peer_fd;
    enum sheen_status status =
        connection_pair(&session->connection, &peer_fd, connect_timeout_ms(options), error);
    if (status)
        return status;
    status = private_daemon_start(&session->daemon, peer_fd, options, error);
    close(peer_fd);
    return status;
}

static enum sheen_status open_address(struct sheen_session *session,
                                      const struct sheen_connect_options *options,
                                      struct sheen_error *error)
{
    struct address address;
    char text[ADDRESS_TEXT_BYTES];
    const char *chosen = options->device                ? "device"
                         : options->native_isa          ? "native ISA"
                         : options->native_threads      ? "number of native threads"
                         : options->memory_budget_bytes ? "memory budget"
                                                        : NULL;
    if (chosen)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "a %s is chosen for a private daemon; the one at %s has its own", chosen,
                          options->address);
    if (!address_parse(&address, options->address, text))
        return status_set(error, SHEEN_BAD_ARGUMENT, "%s", text);
    if (address.kind != ADDRESS_UNIX && address.port == 0)
        return status_set(error, SHEEN_BAD_ARGUMENT,
                          "address '%s' has port 0; a server has a port from 1 to 65535",
                          options->address);
    const struct tls_files files = {.cert = options->cert, .key = options->key, .ca = options->ca};
    return connection_open(&session->connection, &address, &files, connect_timeout_ms(options),
                           error);
}

/* A hint about a failed handshake; NULL if there is none. A daemon does not tell a client that it
 * has not admitted why it closes. */
static const char *handshake_hint(const struct connection *connection)
{
    if (connection->kind == ADDRESS_TCP)
        return "if that port speaks TLS, write tls: for tcp:";
    if (connection->kind != ADDRESS_TLS)
        return NULL;
    switch (tls_fault(connection->channel)) {
    case TLS_PEER_UNTRUSTED:
        return "this client does not trust the server: see --ca, and whether the certificate is "
               "good today and for the host that the address names";
    case TLS_NO_TLS:
        return "that port may not speak TLS 1.3: see sheend's --listen";
    default:
        return "it may not know this client: see --cert and --key, or --token-file, and the days "
               "they are good for";
    }
}

static enum sheen_status explain_loss(const struct connection *connection, enum sheen_status status,
                                      struct sheen_error *error)
{
    const char *hint = handshake_hint(connection);
    char text[sizeof(error->text)];
    if (status != SHEEN_LOST_SERVER || !error || !hint)
        return status;
    snprintf(text, sizeof(text), "%s", error->text);
    return status_set(error, status, "%.400s; %s", text, hint);
}

static enum sheen_status shake_hands(struct sheen_session *session,
                                     const struct sheen_connect_options *options,
                                     struct sheen_error *error)
{
    sheen_Hello hello = {.minor = PROTOCOL_MINOR, .client = "libsheen " SHEEN_VERSION};
    bool tls = session->connection.channel != NULL;
    if (tls && options->token) { /* a token must not be readable on the way */
        hello.has_token = true;
        if (strlen(options->token) >= sizeof(hello.token))
            return status_set(error, SHEEN_BAD_ARGUMENT, "the token is longer than %zu bytes",
                              sizeof(hello.token) - 1);
        memcpy(hello.token, options->token, strlen(options->token) + 1);
    }
    size_t length = 0;
    session->last_seq = 1;
    if (!message_hello_encode(session->last_seq, options->model_id, &hello, session->output,
                              sizeof(session->output), &length))
        return status_set(error, SHEEN_BAD_ARGUMENT, "HELLO does not fit its buffer");
    enum sheen_status status =
        connection_write(&session->connection, session->output, length, error);
    if (status)
        status = session_fail(session, status, error);
    else
        status = session_receive(session, session->last_seq, MESSAGE_HELLO_OK, NULL,
                                 &session->hello, error);
    return explain_loss(&session->connection, status, error);
}

enum sheen_status sheen_connect(struct sheen_session **session,
                                const struct sheen_connect_options *options,
                                struct sheen_error *error)
{
    struct sheen_connect_options whole = SHEEN_CONNECT_DEFAULTS;
    if (!session)
        return status_set(error, SHEEN_BAD_ARGUMENT, "session is NULL");
    *session = NULL;
    enum sheen_status status = sized_take(&whole, sizeof(whole), options, "options", error);
    if (status)
        return status;
    struct sheen_session *made = calloc(1, sizeof(*made));
    if (!made)
        return status_set(error, SHEEN_NO_MEMORY, "no memory for a session");
    made->connection.fd = -1;
    made->daemon.stderr_fd = -1;
    made->share = whole.share;
    status = whole.address ? open_address(made, &whole, error) : start_private(made, &whole, error);
    if (!status)
        status = shake_hands(made, &whole, error);
    if (status) {
        sheen_close(made);
        return status;
    }
    made->connection.timeout_ms = whole.timeout_ms;
    *session = made;
    return SHEEN_OK;
}

void sheen_close(struct sheen_session *session)
{
    if (!session)
        return;
    connection_finish(&session->connection);
    private_daemon_finish(&session->daemon);
    codec_decoder_destroy(session->decoder);
    free(session->answer.data.bytes);
    free(session);
}

enum sheen_status sheen_get_server(const struct sheen_session *session, struct sheen_server *server,
                                   struct sheen_error *error)
{
    enum sheen_status status = session ? sized_check(server, "server", error)
                                       : status_set(error, SHEEN_BAD_ARGUMENT, "session is NULL");
    if (status)
        return status;
    const struct sheen_server whole = {
        .version = session->hello.server,
        .device = session->hello.device,
        .driver = session->hello.driver,
        .software = session->hello.software,
        .max_width_px = session->hello.max_width_px,
        .max_height_px = session->hello.max_height_px,
        .max_upload_bytes = session->hello.max_upload_bytes,
        .max_in_flight = session->hello.credits,
    };
    sized_give(server, &whole, sizeof(whole));
    return SHEEN_OK;
}

int sheen_descriptor(const struct sheen_session *session, short *events)
{
    bool is_good = session && !session->broken;
    short wants = is_good && session->connection.wants ? session->connection.wants : POLLIN;
    if (events)
        *events = is_good ? wants : 0;
    return is_good ? session->connection.fd : -1;
}
