/* TLS 1.3, as both sides of the protocol use it: no older version, no resumption and no early data,
 * so that every connection authenticates anew. Bytes are transferred by two functions of the owner;
 * this code makes no socket call, does not block and raises no signal.
 * Thread: a context may be shared by channels of one thread; a channel is used by one thread at a
 * time. */
#ifndef SHEEN_PROTOCOL_TLS_H
#define SHEEN_PROTOCOL_TLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#define TLS_TEXT_BYTES 400
#define TLS_NAME_BYTES 256 /* bytes of a subject's name; a longer one is refused */
#define TLS_KEY_HASH_BYTES 32

enum tls_side { TLS_SERVER, TLS_CLIENT };

/* PEM files; NULL or "": none. A server needs cert and key; with `ca` it asks for client
 * certificates, which must be issued by that authority. A client verifies the server's certificate
 * against `ca`, else against the authorities that the system trusts, and presents cert and key if
 * asked. With `crl` (lists of revoked certificates), a peer's certificate is accepted only if its
 * authority has a list that has not expired and does not contain the certificate. */
struct tls_files {
    const char *cert, *key, *ca, *crl;
    bool needs_client_cert; /* server: the handshake refuses a client without a certificate */
};

struct tls_context;
struct tls_channel;

/* Reads the files. NULL with one line in `text`, which names the file. */
struct tls_context *tls_context_create(enum tls_side side, const struct tls_files *files,
                                       char text[static TLS_TEXT_BYTES]);
void tls_context_destroy(struct tls_context *context); /* channels may outlive it; NULL is safe */

/* The transport of a channel: as read(2) and write(2), with -1 and EAGAIN when nothing can be
 * transferred now. */
struct tls_io {
    ssize_t (*read)(void *owner, void *bytes, size_t size);
    ssize_t (*write)(void *owner, const void *bytes, size_t size);
    void *owner;
};

enum tls_result {
    TLS_MOVED,
    TLS_WANTS_READ, /* nothing was transferred: call again when the transport can be read */
    TLS_WANTS_WRITE,
    TLS_ENDED, /* the peer has announced that it sends no more */
    TLS_FAILED,
};

/* Makes a channel. `host` is the name or IP address that the server's certificate must have, for
 * clients; NULL for servers. The handshake happens during the first reads and writes. *io is
 * copied. NULL when memory is short. */
struct tls_channel *tls_channel_create(struct tls_context *context, const struct tls_io *io,
                                       const char *host);
void tls_channel_destroy(struct tls_channel *channel); /* NULL is safe */

enum tls_result tls_read(struct tls_channel *channel, void *bytes, size_t size, size_t *moved);
/* After WANTS_* the same bytes must be passed again; they may have moved. */
enum tls_result tls_write(struct tls_channel *channel, const void *bytes, size_t size,
                          size_t *moved);
/* The bytes that tls_read() can return without reading from the transport. */
size_t tls_pending(const struct tls_channel *channel);
/* Announces to the peer that nothing more will be sent, if that can be sent now. */
void tls_end(struct tls_channel *channel);

/* The peer's certificate, which the handshake has verified. */
struct tls_peer {
    /* Names in the form of RFC 2253; issuer is "" if it is too long. */
    char subject[TLS_NAME_BYTES], issuer[TLS_NAME_BYTES];
    /* SHA-256 of the issuer's public key, which distinguishes two authorities with the same
     * name. */
    uint8_t issuer_key[TLS_KEY_HASH_BYTES];
    int64_t expires_s; /* end of validity, Unix seconds */
};

/* Gets the peer's certificate. False if it presented none, or one whose subject is missing or too
 * long. */
bool tls_peer(const struct tls_channel *channel, struct tls_peer *peer);
/* Would a handshake with this context accept the peer's certificate today? True if the peer
 * presented none. If not, `text` has the reason. */
bool tls_still_trusts(const struct tls_context *context, const struct tls_channel *channel,
                      char text[static TLS_TEXT_BYTES]);
/* True if the first message of the peer's handshake has come. */
bool tls_has_begun(const struct tls_channel *channel);
/* Why the channel failed, as text; "" if it has not failed. */
const char *tls_reason(const struct tls_channel *channel);

/* Which side caused a failure. */
enum tls_fault {
    TLS_NO_FAULT,
    TLS_PEER_GONE,      /* the peer closed or sent an alert; it may have rejected our certificate */
    TLS_PEER_UNTRUSTED, /* this side rejected the peer's certificate */
    TLS_NO_TLS,         /* the peer does not speak TLS 1.3 */
};
enum tls_fault tls_fault(const struct tls_channel *channel);

#endif
