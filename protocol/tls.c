#include "protocol/tls.h"

#include <arpa/inet.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

struct tls_context {
    SSL_CTX *ctx;
    BIO_METHOD *method; /* transfers bytes by a channel's tls_io */
    enum tls_side side;
    unsigned users; /* the number of channels, plus 1 for the creator */
};

struct tls_channel {
    struct tls_context *context;
    SSL *ssl;
    struct tls_io io;
    enum tls_fault fault;
    char reason[TLS_TEXT_BYTES];
};

/* --- the transport: OpenSSL's own socket layer would raise SIGPIPE */

static int bio_moved(BIO *bio, ssize_t n, int retry)
{
    BIO_clear_retry_flags(bio);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR))
        BIO_set_flags(bio, retry | BIO_FLAGS_SHOULD_RETRY);
    return (int)n;
}

static int bio_read(BIO *bio, char *bytes, int size)
{
    const struct tls_channel *channel = BIO_get_data(bio);
    return bio_moved(bio, channel->io.read(channel->io.owner, bytes, (size_t)size), BIO_FLAGS_READ);
}

static int bio_write(BIO *bio, const char *bytes, int size)
{
    const struct tls_channel *channel = BIO_get_data(bio);
    return bio_moved(bio, channel->io.write(channel->io.owner, bytes, (size_t)size),
                     BIO_FLAGS_WRITE);
}

static long bio_control(BIO *bio, int command, long number, void *pointer)
{
    (void)bio;
    (void)number;
    (void)pointer;
    return command == BIO_CTRL_FLUSH;
}

static BIO_METHOD *make_method(void)
{
    int type = BIO_get_new_index();
    BIO_METHOD *method =
        type < 0 ? NULL : BIO_meth_new(type | BIO_TYPE_SOURCE_SINK, "sheen connection");
    if (method) {
        BIO_meth_set_read(method, bio_read);
        BIO_meth_set_write(method, bio_write);
        BIO_meth_set_ctrl(method, bio_control);
    }
    return method;
}

/* --- contexts */

static bool is_set(const char *path)
{
    return path && *path;
}

/* Returns the last error of OpenSSL's queue, and empties the queue. */
static const char *last_error(void)
{
    unsigned long code = ERR_peek_last_error();
    const char *reason = code ? ERR_reason_error_string(code) : NULL;
    if (ERR_SYSTEM_ERROR(code))
        reason = strerror(ERR_GET_REASON(code));
    ERR_clear_error();
    return reason ? reason : "unknown reason";
}

static bool fail_file(char *text, const char *what, const char *path)
{
    snprintf(text, TLS_TEXT_BYTES, "%s %.200s: %s", what, path, last_error());
    return false;
}

static bool load_own(SSL_CTX *ctx, const struct tls_files *files, char *text)
{
    if (!is_set(files->cert))
        return true;
    if (SSL_CTX_use_certificate_chain_file(ctx, files->cert) != 1)
        return fail_file(text, "certificate", files->cert);
    if (SSL_CTX_use_PrivateKey_file(ctx, files->key, SSL_FILETYPE_PEM) != 1 ||
        SSL_CTX_check_private_key(ctx) != 1)
        return fail_file(text, "key", files->key);
    return true;
}

static bool load_authority(struct tls_context *context, const struct tls_files *files, char *text)
{
    SSL_CTX *ctx = context->ctx;
    bool server = context->side == TLS_SERVER;
    if (is_set(files->ca)) {
        if (SSL_CTX_load_verify_file(ctx, files->ca) != 1)
            return fail_file(text, "authority", files->ca);
        STACK_OF(X509_NAME) *names = server ? SSL_load_client_CA_file(files->ca) : NULL;
        if (server && !names)
            return fail_file(text, "authority", files->ca);
        SSL_CTX_set_client_CA_list(ctx, names);
    } else if (!server) {
        SSL_CTX_set_default_verify_paths(ctx);
    }
    int mode = server && !is_set(files->ca) ? SSL_VERIFY_NONE : SSL_VERIFY_PEER;
    if (files->needs_client_cert)
        mode |= SSL_VERIFY_FAIL_IF_NO_PEER_CERT;
    SSL_CTX_set_verify(ctx, mode, NULL);
    return true;
}

/* Is the list issued by one of the authorities in the store? If not, no certificate would find its
 * list. */
static bool is_by_authority(X509_CRL *crl, const STACK_OF(X509_OBJECT) * objects)
{
    for (int i = 0; i < sk_X509_OBJECT_num(objects); i++) {
        X509 *authority = X509_OBJECT_get0_X509(sk_X509_OBJECT_value(objects, i));
        if (authority &&
            X509_NAME_cmp(X509_get_subject_name(authority), X509_CRL_get_issuer(crl)) == 0 &&
            X509_CRL_verify(crl, X509_get0_pubkey(authority)) == 1)
            return true;
    }
    ERR_clear_error();
    return false;
}

/* Loads the revocation lists, after the authorities. */
static bool load_revoked(SSL_CTX *ctx, const struct tls_files *files, char *text)
{
    if (!is_set(files->crl))
        return true;
    X509_STORE *store = SSL_CTX_get_cert_store(ctx);
    X509_LOOKUP *lookup = X509_STORE_add_lookup(store, X509_LOOKUP_file());
    if (!lookup || X509_load_crl_file(lookup, files->crl, X509_FILETYPE_PEM) <= 0)
        return fail_file(text, "revocation list", files->crl);
    const STACK_OF(X509_OBJECT) *objects = X509_STORE_get0_objects(store);
    for (int i = 0; i < sk_X509_OBJECT_num(objects); i++) {
        X509_CRL *crl = X509_OBJECT_get0_X509_CRL(sk_X509_OBJECT_value(objects, i));
        if (crl && !is_by_authority(crl, objects)) {
            snprintf(text, TLS_TEXT_BYTES, "revocation list %.200s: it is by another authority",
                     files->crl);
            return false;
        }
    }
    return X509_STORE_set_flags(store, X509_V_FLAG_CRL_CHECK) == 1 ||
           fail_file(text, "revocation list", files->crl);
}

static bool set_up(struct tls_context *context)
{
    SSL_CTX *ctx = context->ctx;
    SSL_CTX_set_mode(ctx, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                              SSL_MODE_RELEASE_BUFFERS);
    /* Without this, a peer that sends KeyUpdates without end keeps a read from ever returning. */
    SSL_CTX_clear_mode(ctx, SSL_MODE_AUTO_RETRY);
    SSL_CTX_set_session_cache_mode(ctx, SSL_SESS_CACHE_OFF);
    return SSL_CTX_set_min_proto_version(ctx, TLS1_3_VERSION) == 1 &&
           SSL_CTX_set_num_tickets(ctx, 0) == 1 && SSL_CTX_set_max_early_data(ctx, 0) == 1;
}

struct tls_context *tls_context_create(enum tls_side side, const struct tls_files *files,
                                       char text[static TLS_TEXT_BYTES])
{
    if (is_set(files->cert) != is_set(files->key)) {
        snprintf(text, TLS_TEXT_BYTES, "a certificate and its key come together");
        return NULL;
    }
    struct tls_context *context = calloc(1, sizeof *context);
    if (!context) {
        snprintf(text, TLS_TEXT_BYTES, "no memory for TLS");
        return NULL;
    }
    ERR_clear_error();
    context->side = side;
    context->users = 1;
    context->method = make_method();
    context->ctx = SSL_CTX_new(side == TLS_SERVER ? TLS_server_method() : TLS_client_method());
    bool ok = context->method && context->ctx && set_up(context);
    if (!ok)
        snprintf(text, TLS_TEXT_BYTES, "TLS cannot be used: %s", last_error());
    if (!ok || !load_own(context->ctx, files, text) || !load_authority(context, files, text) ||
        !load_revoked(context->ctx, files, text)) {
        tls_context_destroy(context);
        return NULL;
    }
    return context;
}

void tls_context_destroy(struct tls_context *context)
{
    if (!context || --context->users > 0)
        return;
    SSL_CTX_free(context->ctx);
    BIO_meth_free(context->method);
    free(context);
}

/* --- channels */

static bool expect_host(SSL *ssl, const char *host)
{
    unsigned char address[16];
    bool is_address =
        inet_pton(AF_INET, host, address) == 1 || inet_pton(AF_INET6, host, address) == 1;
    if (is_address)
        return X509_VERIFY_PARAM_set1_ip_asc(SSL_get0_param(ssl), host) == 1;
    /* SSL_set_tlsext_host_name() is this call with a cast; OpenSSL copies the name. */
    return SSL_set1_host(ssl, host) == 1 &&
           SSL_ctrl(ssl, SSL_CTRL_SET_TLSEXT_HOSTNAME, TLSEXT_NAMETYPE_host_name,
                    (void *)(uintptr_t)host) == 1;
}

struct tls_channel *tls_channel_create(struct tls_context *context, const struct tls_io *io,
                                       const char *host)
{
    struct tls_channel *channel = calloc(1, sizeof *channel);
    SSL *ssl = SSL_new(context->ctx);
    BIO *bio = BIO_new(context->method);
    if (!channel || !ssl || !bio || (host && !expect_host(ssl, host))) {
        BIO_free(bio);
        SSL_free(ssl);
        free(channel);
        return NULL;
    }
    context->users++;
    *channel = (struct tls_channel){.context = context, .ssl = ssl, .io = *io};
    BIO_set_data(bio, channel);
    BIO_set_init(bio, 1);
    SSL_set_bio(ssl, bio, bio);
    context->side == TLS_SERVER ? SSL_set_accept_state(ssl) : SSL_set_connect_state(ssl);
    return channel;
}

void tls_channel_destroy(struct tls_channel *channel)
{
    if (!channel)
        return;
    SSL_free(channel->ssl);
    tls_context_destroy(channel->context);
    free(channel);
}

/* The fault of the last error in OpenSSL's queue, which is not emptied. */
static enum tls_fault last_fault(void)
{
    int reason = ERR_GET_REASON(ERR_peek_last_error());
    if (reason == SSL_R_CERTIFICATE_VERIFY_FAILED)
        return TLS_PEER_UNTRUSTED;
    bool is_alert = reason > SSL_AD_REASON_OFFSET;
    return is_alert || reason == SSL_R_UNEXPECTED_EOF_WHILE_READING ? TLS_PEER_GONE : TLS_NO_TLS;
}

/* The result of an OpenSSL call that did not return 1. */
static enum tls_result explain(struct tls_channel *channel, int code)
{
    int number = errno;
    switch (SSL_get_error(channel->ssl, code)) {
    case SSL_ERROR_WANT_READ:
        return TLS_WANTS_READ;
    case SSL_ERROR_WANT_WRITE:
        return TLS_WANTS_WRITE;
    case SSL_ERROR_ZERO_RETURN:
        return TLS_ENDED;
    case SSL_ERROR_SYSCALL:
        snprintf(channel->reason, sizeof channel->reason, "%s",
                 number ? strerror(number) : "the connection broke");
        channel->fault = TLS_PEER_GONE;
        break;
    default: {
        channel->fault = last_fault();
        long verdict = SSL_get_verify_result(channel->ssl);
        const char *reason = last_error();
        if (verdict != X509_V_OK)
            snprintf(channel->reason, sizeof channel->reason, "%s: %s", reason,
                     X509_verify_cert_error_string(verdict));
        else
            snprintf(channel->reason, sizeof channel->reason, "%s", reason);
    }
    }
    return TLS_FAILED;
}

enum tls_result tls_read(struct tls_channel *channel, void *bytes, size_t size, size_t *moved)
{
    *moved = 0;
    if (channel->fault)
        return TLS_FAILED;
    ERR_clear_error();
    errno = 0;
    int code = SSL_read_ex(channel->ssl, bytes, size, moved);
    return code == 1 ? TLS_MOVED : explain(channel, code);
}

enum tls_result tls_write(struct tls_channel *channel, const void *bytes, size_t size,
                          size_t *moved)
{
    *moved = 0;
    if (channel->fault)
        return TLS_FAILED;
    ERR_clear_error();
    errno = 0;
    int code = SSL_write_ex(channel->ssl, bytes, size, moved);
    return code == 1 ? TLS_MOVED : explain(channel, code);
}

size_t tls_pending(const struct tls_channel *channel)
{
    return channel->fault ? 0 : (size_t)SSL_pending(channel->ssl);
}

void tls_end(struct tls_channel *channel)
{
    ERR_clear_error();
    if (!channel->fault && SSL_is_init_finished(channel->ssl))
        SSL_shutdown(channel->ssl);
    ERR_clear_error();
}

static bool print_name(const X509_NAME *name, char text[static TLS_NAME_BYTES])
{
    BIO *printed = BIO_new(BIO_s_mem());
    char *bytes = NULL;
    long length = 0;
    if (printed && X509_NAME_print_ex(printed, name, 0, XN_FLAG_RFC2253) >= 0)
        length = BIO_get_mem_data(printed, &bytes);
    bool ok = length > 0 && length < TLS_NAME_BYTES;
    if (ok)
        memcpy(text, bytes, (size_t)length);
    text[ok ? length : 0] = 0;
    BIO_free(printed);
    return ok;
}

/* Hashes the public key of the certificate that issued the peer's; of the peer's own if that is
 * self-signed. */
static bool hash_issuer_key(const struct tls_channel *channel, uint8_t *hash)
{
    const STACK_OF(X509) *chain = SSL_get0_verified_chain(channel->ssl);
    int n = chain ? sk_X509_num(chain) : 0;
    unsigned length = 0;
    return n > 0 &&
           X509_pubkey_digest(sk_X509_value(chain, n > 1 ? 1 : 0), EVP_sha256(), hash, &length) &&
           length == TLS_KEY_HASH_BYTES;
}

bool tls_peer(const struct tls_channel *channel, struct tls_peer *peer)
{
    const X509 *cert = SSL_get0_peer_certificate(channel->ssl);
    struct tm expires = {0};
    bool ok = cert && print_name(X509_get_subject_name(cert), peer->subject) &&
              hash_issuer_key(channel, peer->issuer_key) &&
              ASN1_TIME_to_tm(X509_get0_notAfter(cert), &expires) == 1;
    if (ok) {
        print_name(X509_get_issuer_name(cert), peer->issuer);
        peer->expires_s = timegm(&expires);
    }
    ERR_clear_error();
    return ok;
}

bool tls_still_trusts(const struct tls_context *context, const struct tls_channel *channel,
                      char text[static TLS_TEXT_BYTES])
{
    X509 *cert = SSL_get0_peer_certificate(channel->ssl);
    if (!cert)
        return true;
    X509_STORE_CTX *verdict = X509_STORE_CTX_new();
    bool ok = verdict &&
              X509_STORE_CTX_init(verdict, SSL_CTX_get_cert_store(context->ctx), cert,
                                  SSL_get_peer_cert_chain(channel->ssl)) == 1 &&
              X509_STORE_CTX_set_default(verdict, context->side == TLS_SERVER ? "ssl_client"
                                                                              : "ssl_server") == 1;
    if (!ok)
        snprintf(text, TLS_TEXT_BYTES, "no memory to check a certificate");
    else if (!(ok = X509_verify_cert(verdict) == 1))
        snprintf(text, TLS_TEXT_BYTES, "%s",
                 X509_verify_cert_error_string(X509_STORE_CTX_get_error(verdict)));
    X509_STORE_CTX_free(verdict);
    ERR_clear_error();
    return ok;
}

bool tls_has_begun(const struct tls_channel *channel)
{
    return !SSL_in_before(channel->ssl);
}

const char *tls_reason(const struct tls_channel *channel)
{
    return channel->reason;
}

enum tls_fault tls_fault(const struct tls_channel *channel)
{
    return channel->fault;
}
