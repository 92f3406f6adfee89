/* TLS 1.3 as both sides speak it: nothing older, no resumption, no early data, so that every
 * connection proves anew who it is. Bytes move through the owner's two functions: no socket call is
 * made here, nothing blocks, and no signal is raised that those do not raise.
 * Thread: a context may be shared by channels of one thread; a channel belongs to one at a time. */
#ifndef SHEEN_PROTOCOL_TLS_H
#define SHEEN_PROTOCOL_TLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define TLS_TEXT_BYTES 400
#define TLS_NAME_BYTES 256 /* of a subject; a longer one is refused */
#define TLS_KEY_HASH_BYTES 32

enum tls_side { TLS_SERVER, TLS_CLIENT };

/* PEM files; NULL or "" for none. A server needs cert and key, and with `ca` it asks for client
 * certificates, which must then be by that authority. A client checks the server's against `ca`,
 * else against what the system trusts, and shows cert and key when asked. With `crl`, lists of
 * revoked certificates, a peer's certificate needs a list of its authority that has not expired and
 * that does not name it. */
struct tls_files {
    const char *cert, *key, *ca, *crl;
    bool needs_client_cert; /* server: a client without a certificate is refused by the handshake */
};

struct tls_context;
struct tls_channel;

/* Reads the files. NULL with one line in `text` that names the file. */
struct tls_context *tls_context_create(enum tls_side side, const struct tls_files *files,
                                       char text[static TLS_TEXT_BYTES]);
void tls_context_destroy(struct tls_context *context); /* channels may outlive it; NULL is safe */

/* As read(2) and write(2): -1 with errno EAGAIN when nothing moves now. */
struct tls_io {
    ssize_t (*read)(void *owner, void *bytes, size_t size);
    ssize_t (*write)(void *owner, const void *bytes, size_t size);
    void *owner;
};

enum tls_result {
    TLS_MOVED,
    TLS_WANTS_READ, /* nothing moved: again once there is something to read */
    TLS_WANTS_WRITE,
    TLS_ENDED, /* the peer has said that it sends no more */
    TLS_FAILED,
};

/* `host` is whose certificate a client expects, a name or an IP address; NULL for a server. NULL
 * without memory. The handshake happens in the first reads and writes. */
struct tls_channel *tls_channel_create(struct tls_context *context, const struct tls_io *io,
                                       const char *host);
void tls_channel_destroy(struct tls_channel *channel); /* NULL is safe */

enum tls_result tls_read(struct tls_channel *channel, void *bytes, size_t size, size_t *moved);
/* After WANTS_* the same bytes must be given again, from wherever they then lie. */
enum tls_result tls_write(struct tls_channel *channel, const void *bytes, size_t size,
                          size_t *moved);
/* Bytes that have been taken from the peer and that tls_read() gives without reading more. */
size_t tls_pending(const struct tls_channel *channel);
/* Says that nothing more is sent, if it can be said now. */
void tls_end(struct tls_channel *channel);

/* The other side's certificate, which the handshake has checked. */
struct tls_peer {
    char subject[TLS_NAME_BYTES],
        issuer[TLS_NAME_BYTES];             /* names as in RFC 2253; issuer "" if it is
                                                             too long */
    uint8_t issuer_key[TLS_KEY_HASH_BYTES]; /* SHA-256 of its issuer's public key, which tells two
                                               authorities of one name apart */
    int64_t expires_s;                      /* Unix seconds */
};

/* False when it showed none, or one without a subject or with one that is too long. */
bool tls_peer(const struct tls_channel *channel, struct tls_peer *peer);
/* Would a handshake with this context take the peer's certificate today? True when the peer showed
 * none. If not, `text` says why. */
bool tls_still_trusts(const struct tls_context *context, const struct tls_channel *channel,
                      char text[static TLS_TEXT_BYTES]);
/* Has the first message of the peer's handshake come? */
bool tls_has_begun(const struct tls_channel *channel);
/* Why the channel has failed, in words; "" when it has not. */
const char *tls_reason(const struct tls_channel *channel);

/* On whose side a failure is to be looked for. */
enum tls_fault {
    TLS_NO_FAULT,
    TLS_PEER_GONE,      /* it closed, or sent an alert: it may not take what this side shows */
    TLS_PEER_UNTRUSTED, /* this side does not take its certificate */
    TLS_NO_TLS,         /* what it sent is no TLS of this version */
};
enum tls_fault tls_fault(const struct tls_channel *channel);

#endif
