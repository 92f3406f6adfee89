#include "server/base/log.h"
#include "server/session/session.h"
#include "server/session/session_internal.h"

void session_turn_away(struct session *session, const char *why)
{
    log_event(LOG_WARN, "client turned away", log_number("session", session->id),
              log_text("peer", session->client.peer), log_text("text", why));
    session->end = END_CREDENTIALS;
    session->refused = true;
    conn_close(&session->conn);
}

bool session_admit(struct session *session, const sheen_Hello *hello)
{
    struct error error = {0};
    struct identity *identity = &session->client.identity;
    if (!access_admit_tls(session->host->access, &session->conn,
                          hello->has_token ? hello->token : NULL, identity, &error)) {
        session_turn_away(session, error.text);
        return false;
    }
    session->admitted = true;
    session->host->n_strangers--;
    log_event(LOG_INFO, "client admitted", log_number("session", session->id),
              log_text("identity", identity->name));
    return true;
}

void session_check_access(struct session *session, bool changed)
{
    struct error error = {0};
    struct session_client *client = &session->client;
    const struct access *access = session->host->access;
    struct conn *conn = &session->conn;
    bool ok = true;
    if (conn->state == CONN_CLOSED || !session->admitted)
        return;
    if (client->kind == CLIENT_UNIX)
        ok = access_admit_local(access, conn->source.fd, ADDRESS_UNIX, &client->identity, &error);
    else if (client->kind == CLIENT_TLS)
        ok = access_still_admits(access, &client->identity, &error) &&
             (!changed || access_still_trusts(access, conn, &error));
    if (!ok)
        session_turn_away(session, error.text);
}
