/* Which clients are admitted, and under which identity.
 *
 * Unix socket: a user that the socket's file lets in; where there are allow-lists, a user on them
 * that the daemon can tell from others (user_namespace.h). Loopback TCP: every process of this
 * machine, all with one identity. TLS: a client that shows a certificate of --client-ca or a token
 * of --tokens. Thread: the loop's. */
#ifndef SHEEN_NET_ACCESS_H
#define SHEEN_NET_ACCESS_H

#include <stddef.h>
#include <stdint.h>

#include "protocol/address.h"
#include "protocol/tls.h"
#include "server/base/error.h"
#include "server/base/owner.h"
#include "server/net/conn.h"
#include "server/net/peer.h"
#include "server/net/tokens.h"

#define ACCESS_PATH_BYTES 512
#define ACCESS_MAX_IDS 64
#define IDENTITY_NAME_BYTES 272

struct access_ids {
    size_t n;
    uint64_t id[ACCESS_MAX_IDS];
};

struct access_options {
    struct access_ids uids, gids; /* both empty: the socket file's permissions decide */
    char tls_cert[ACCESS_PATH_BYTES], tls_key[ACCESS_PATH_BYTES]; /* "": no TLS */
    char client_ca[ACCESS_PATH_BYTES], tokens[ACCESS_PATH_BYTES];
    char tls_crl[ACCESS_PATH_BYTES]; /* "": no certificate is looked for in a list */
};

/* A client that has been admitted. */
struct identity {
    char name[IDENTITY_NAME_BYTES]; /* "uid:1000", "cert:CN=anna", "token:farm", "tcp", "private" */
    char issuer[TLS_NAME_BYTES];    /* of the certificate; "" without one */
    uint8_t owner[OWNER_BYTES];     /* what its uploads belong to: tells all identities apart */
    int64_t expires_s;              /* Unix seconds; 0: never */
    bool by_token;
    uint8_t token_hash[TOKEN_HASH_BYTES];
};

struct access;

/* Reads certificates, tokens, and which users the kernel can show. ERROR_REQUEST names the option
 * or the file. */
struct access *access_create(const struct access_options *options, struct error *error);
void access_destroy(struct access *access); /* NULL is safe */

/* Can TLS clients be served and told apart? ERROR_REQUEST says what to set. */
bool access_can_tls(const struct access *access, struct error *error);
/* Is there an allow-list, so that the file of a Unix socket lets everybody try? */
bool access_has_list(const struct access *access);

/* A fresh connection of a Unix or loopback TCP listener. ERROR_REQUEST says why it is not admitted.
 */
bool access_admit_local(const struct access *access, int fd, enum address_kind kind,
                        struct identity *identity, struct error *error);
/* A client of plain TCP whose address a balancer tells. */
void access_admit_proxied(const struct peer *peer, struct identity *identity);
/* A private daemon's one client. */
void access_admit_private(struct identity *identity);
/* Puts TLS under a fresh conn. */
bool access_start_tls(const struct access *access, struct conn *conn, struct error *error);
/* A client's HELLO has come over TLS; `token` is the one in it, or NULL. */
bool access_admit_tls(const struct access *access, const struct conn *conn, const char *token,
                      struct identity *identity, struct error *error);

/* May an admitted client stay? Not after the expiry, nor when the client's token is no longer in the
 * file or has changed there. Takes a new expiry over from the file. */
bool access_still_admits(const struct access *access, struct identity *identity,
                         struct error *error);
/* Is the certificate that the client showed, if any, good by these rules too? To check it costs a
 * verification of its signature, so callers ask once after a reload and not at every tick. */
bool access_still_trusts(const struct access *access, const struct conn *conn, struct error *error);

#endif
