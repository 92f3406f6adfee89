/* Decides which clients are admitted, and gives each an identity.
 *
 * Unix socket    users that the socket file's permissions let in; if there are allow-lists, only users
 *               on them whose id the kernel shows (user_namespace.h)
 * loopback TCP  every process of this machine, all with one identity
 * TLS           a client with a certificate of --client-ca or a token of --tokens
 *
 * Thread: the loop's. */
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
    /* allow-lists; both empty: the socket file's permissions decide. */
    struct access_ids uids, gids;
    char tls_cert[ACCESS_PATH_BYTES], tls_key[ACCESS_PATH_BYTES]; /* "": no TLS */
    char client_ca[ACCESS_PATH_BYTES], tokens[ACCESS_PATH_BYTES];
    char tls_crl[ACCESS_PATH_BYTES]; /* "": no revocation list */
};

/* A client that has been admitted. */
struct identity {
    char name[IDENTITY_NAME_BYTES]; /* "uid:1000", "cert:CN=anna", "token:farm", "tcp", "private" */
    char issuer[TLS_NAME_BYTES];    /* issuer of the certificate; "" without one */
    uint8_t owner[OWNER_BYTES];     /* owner of the client's uploads; unique to this identity */
    int64_t expires_s;              /* when the identity expires, Unix seconds; 0: never */
    bool by_token;
    uint8_t token_hash[TOKEN_HASH_BYTES];
};

struct access;

/* Reads certificates and tokens, and which user ids the kernel can show. NULL with ERROR_REQUEST,
 * which names the option or the file. */
struct access *access_create(const struct access_options *options, struct error *error);
void access_destroy(struct access *access); /* NULL is safe */

/* Can TLS clients be served and identified? If not, ERROR_REQUEST says which option to set. */
bool access_can_tls(const struct access *access, struct error *error);
/* True if there is an allow-list: then the file of a Unix socket may be open to all users. */
bool access_has_list(const struct access *access);

/* Admits a new connection of a Unix or loopback TCP listener and fills in *identity. False with
 * ERROR_REQUEST and the reason. */
bool access_admit_local(const struct access *access, int fd, enum address_kind kind,
                        struct identity *identity, struct error *error);
/* The identity of a plain TCP client whose address a balancer announces. */
void access_admit_proxied(const struct peer *peer, struct identity *identity);
/* The identity of a private daemon's only client. */
void access_admit_private(struct identity *identity);
/* Starts TLS on a new connection. */
bool access_start_tls(const struct access *access, struct conn *conn, struct error *error);
/* Admits a TLS client after its HELLO; `token` is the token in HELLO, or NULL. False with the
 * reason in *error. */
bool access_admit_tls(const struct access *access, const struct conn *conn, const char *token,
                      struct identity *identity, struct error *error);

/* May an admitted client stay? No if its identity has expired, or if its token was removed from the
 * file or changed. Updates identity->expires_s from the file. */
bool access_still_admits(const struct access *access, struct identity *identity,
                         struct error *error);
/* Is the client's certificate, if it has one, valid by these rules too? This verifies a signature,
 * so call it once after a reload, not at every tick. */
bool access_still_trusts(const struct access *access, const struct conn *conn, struct error *error);

#endif
