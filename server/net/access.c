#include "server/net/access.h"

#include <errno.h>
#include <openssl/sha.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>

#include "server/base/plain_file.h"
#include "server/net/conn_tls.h"
#include "server/net/user_namespace.h"

#define MAX_GROUPS 1024

struct access {
    struct access_options options;
    struct tls_context *tls; /* NULL: none */
    struct tokens *tokens;   /* NULL: none */
    struct user_namespace users, groups;
};

/* --- reading */

/* Checks the key file's permissions: whoever can read the key can pose as the daemon. */
static bool check_key_file(const char *path, struct error *error)
{
    struct stat file;
    if (stat(path, &file) < 0)
        return error_set(error, ERROR_REQUEST, "cannot read %s: %s", path, strerror(errno));
    return (file.st_mode & 07) == 0 ||
           error_set(error, ERROR_REQUEST,
                     "%s may be read or written by everybody: take that away (chmod o= %s)", path,
                     path);
}

static bool read_tls(struct access *access, struct error *error)
{
    const struct access_options *options = &access->options;
    const struct tls_files files = {.cert = options->tls_cert,
                                    .key = options->tls_key,
                                    .ca = options->client_ca,
                                    .crl = options->tls_crl,
                                    .needs_client_cert = *options->client_ca && !*options->tokens};
    char text[TLS_TEXT_BYTES];
    bool wanted = *options->tls_cert || *options->tls_key;
    if (!*options->tls_cert != !*options->tls_key)
        return error_set(error, ERROR_REQUEST, "tls-cert and tls-key come together");
    if (*options->tls_crl && !*options->client_ca)
        return error_set(error, ERROR_REQUEST,
                         "tls-crl lists certificates of --client-ca, which is missing");
    if (!wanted)
        return true;
    const char *const paths[] = {files.cert, files.key, files.ca, files.crl};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++)
        if (*paths[i] && !plain_file_check(paths[i], error))
            return false;
    if (!check_key_file(options->tls_key, error))
        return false;
    access->tls = tls_context_create(TLS_SERVER, &files, text);
    return access->tls || error_set(error, ERROR_REQUEST, "%s", text);
}

struct access *access_create(const struct access_options *options, struct error *error)
{
    struct access *access = calloc(1, sizeof *access);
    if (!access) {
        error_set(error, ERROR_SERVER, "no memory for the rules of access");
        return NULL;
    }
    access->options = *options;
    access->users = user_namespace_read(USER_NAMESPACE_USERS);
    access->groups = user_namespace_read(USER_NAMESPACE_GROUPS);
    bool ok = read_tls(access, error);
    if (ok && *options->tokens)
        ok = (access->tokens = tokens_read(options->tokens, error)) != NULL;
    if (!ok) {
        access_destroy(access);
        return NULL;
    }
    return access;
}

void access_destroy(struct access *access)
{
    if (!access)
        return;
    tls_context_destroy(access->tls);
    tokens_destroy(access->tokens);
    free(access);
}

bool access_can_tls(const struct access *access, struct error *error)
{
    if (!access->tls)
        return error_set(error, ERROR_REQUEST,
                         "a tls: address needs --tls-cert and --tls-key, and --client-ca or "
                         "--tokens to tell who may come in");
    return *access->options.client_ca || access->tokens ||
           error_set(error, ERROR_REQUEST,
                     "a tls: address needs --client-ca (certificates of clients) or --tokens to "
                     "tell who may come in");
}

bool access_has_list(const struct access *access)
{
    return access->options.uids.n + access->options.gids.n > 0;
}

/* --- who he is */

static void identify(struct identity *identity, const char *kind, const char *name)
{
    *identity = (struct identity){.expires_s = 0};
    snprintf(identity->name, sizeof identity->name, "%s%s", kind, name);
    SHA256((const unsigned char *)identity->name, strlen(identity->name), identity->owner);
}

/* The identity includes the issuer: two authorities may certify the same name for different
 * people. */
static void identify_certificate(struct identity *identity, const struct tls_peer *peer)
{
    identify(identity, "cert:", peer->subject);
    identity->expires_s = peer->expires_s;
    snprintf(identity->issuer, sizeof identity->issuer, "%s", peer->issuer);
    uint8_t both[2 * OWNER_BYTES];
    memcpy(both, identity->owner, OWNER_BYTES);
    memcpy(both + OWNER_BYTES, peer->issuer_key, OWNER_BYTES);
    SHA256(both, sizeof both, identity->owner);
}

static bool is_listed(const struct access_ids *ids, uint64_t id)
{
    for (size_t i = 0; i < ids->n; i++)
        if (ids->id[i] == id)
            return true;
    return false;
}

/* True if the group is on the list. An id that may stand for several groups is not. */
static bool is_listed_group(const struct access *access, gid_t group)
{
    return !user_namespace_hides(&access->groups, group) && is_listed(&access->options.gids, group);
}

/* True if any of the groups that the peer had when it connected is on the list. */
static bool has_listed_group(const struct access *access, int fd, gid_t primary)
{
    gid_t groups[MAX_GROUPS];
    socklen_t size = sizeof groups;
    if (is_listed_group(access, primary))
        return true;
    if (getsockopt(fd, SOL_SOCKET, SO_PEERGROUPS, groups, &size) < 0)
        return false;
    for (size_t i = 0; i < size / sizeof *groups; i++)
        if (is_listed_group(access, groups[i]))
            return true;
    return false;
}

bool access_admit_local(const struct access *access, int fd, enum address_kind kind,
                        struct identity *identity, struct error *error)
{
    struct ucred peer;
    socklen_t size = sizeof peer;
    char number[24];
    if (kind != ADDRESS_UNIX) {
        identify(identity, "tcp", "");
        return true;
    }
    if (getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) < 0)
        return error_set(error, ERROR_REQUEST, "SO_PEERCRED: %s", strerror(errno));
    if (user_namespace_hides(&access->users, peer.uid))
        return error_set(error, ERROR_REQUEST,
                         "its user is %lu, as are all users that the daemon's user namespace does "
                         "not map: run sheend where they are mapped (a systemd unit without "
                         "PrivateUsers=), or let them in by tls: and tokens",
                         (unsigned long)peer.uid);
    if (access_has_list(access) && !is_listed(&access->options.uids, peer.uid) &&
        !has_listed_group(access, fd, peer.gid))
        return error_set(error, ERROR_REQUEST, "user %lu is in neither allow-uid nor allow-gid",
                         (unsigned long)peer.uid);
    snprintf(number, sizeof number, "%lu", (unsigned long)peer.uid);
    identify(identity, "uid:", number);
    return true;
}

void access_admit_proxied(const struct peer *peer, struct identity *identity)
{
    identify(identity, "tcp:", peer->name);
}

void access_admit_private(struct identity *identity)
{
    identify(identity, "private", "");
}

bool access_start_tls(const struct access *access, struct conn *conn, struct error *error)
{
    return access->tls
               ? conn_start_tls(conn, access->tls, error)
               : error_set(error, ERROR_SERVER, "TLS has been taken from the configuration");
}

bool access_admit_tls(const struct access *access, const struct conn *conn, const char *token,
                      struct identity *identity, struct error *error)
{
    struct tls_peer peer;
    if (conn_tls_peer(conn, &peer)) {
        identify_certificate(identity, &peer);
        return access_still_admits(access, identity, error);
    }
    if (!token || !*token)
        return error_set(error, ERROR_REQUEST,
                         "neither a certificate with a subject nor a token was shown");
    const struct token *found = access->tokens ? tokens_find(access->tokens, token) : NULL;
    if (!found)
        return error_set(error, ERROR_REQUEST, "the token is not one of the daemon's");
    identify(identity, "token:", found->name);
    identity->expires_s = found->expires_s;
    identity->by_token = true;
    memcpy(identity->token_hash, found->hash, sizeof identity->token_hash);
    return access_still_admits(access, identity, error);
}

bool access_still_admits(const struct access *access, struct identity *identity,
                         struct error *error)
{
    if (identity->by_token) {
        const char *name = identity->name + strlen("token:");
        const struct token *now = access->tokens ? tokens_find_name(access->tokens, name) : NULL;
        if (!now || memcmp(now->hash, identity->token_hash, sizeof now->hash) != 0)
            return error_set(error, ERROR_REQUEST, "%s has been taken back", identity->name);
        identity->expires_s = now->expires_s;
    }
    return identity->expires_s == 0 || time(NULL) < identity->expires_s ||
           error_set(error, ERROR_REQUEST, "%s has expired", identity->name);
}

bool access_still_trusts(const struct access *access, const struct conn *conn, struct error *error)
{
    char text[TLS_TEXT_BYTES];
    return !access->tls || !conn->channel || tls_still_trusts(access->tls, conn->channel, text) ||
           error_set(error, ERROR_REQUEST, "%s", text);
}
