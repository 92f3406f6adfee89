#include "server/base/clock.h"
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
    session_end_stranger(session, STRANGER_GONE);
}

static bool is_silent(const struct stranger *stranger)
{
    const struct session *session = stranger->owner;
    return session->conn.channel && !tls_has_begun(session->conn.channel);
}

void session_be_stranger(struct session *session)
{
    struct session_host *host = session->host;
    session->is_stranger = true;
    session->stranger = (struct stranger){.peer = session->client.from,
                                          .is_exempt = session->client.is_balancer,
                                          .is_silent = is_silent,
                                          .owner = session};
    struct stranger *leaves = strangers_enter(&host->strangers, &host->limits.strangers,
                                              &session->stranger, session->start_us);
    if (leaves)
        session_turn_away(leaves->owner, "too many connections that do not say who they are: the "
                                         "oldest leaves");
}

void session_end_stranger(struct session *session, enum stranger_end end)
{
    struct session_host *host = session->host;
    if (!session->is_stranger)
        return;
    session->is_stranger = false;
    if (strangers_leave(&host->strangers, &host->limits.strangers, &session->stranger, end,
                        clock_now_us()))
        log_event(LOG_WARN,
                  "an address is turned away for a while: no client of it has credentials",
                  log_text("address", session->stranger.peer.name));
}

bool session_take_seat(struct session_host *host, const struct identity *identity,
                       struct session_seat *seat, struct error *error)
{
    *seat = (struct session_seat){client_quota_get(&host->memory->quotas, identity),
                                  party_get(&host->requests->parties, identity->owner)};
    const struct client_quota *quota = seat->quota;
    bool ok = quota && seat->party;
    if (!ok)
        error_set(error, ERROR_SERVER, "no memory for another client: try again later");
    else if (quota->n_connections >= host->limits.connections)
        ok =
            error_set(error, ERROR_SERVER, "%s has as many connections as it may (%llu): close one",
                      identity->name, (unsigned long long)host->limits.connections);
    if (ok) {
        seat->quota->n_connections++;
        return true;
    }
    client_quota_put(seat->quota);
    party_put(seat->party);
    *seat = (struct session_seat){0};
    return false;
}

void session_leave_seat(struct session_seat *seat)
{
    if (!seat->quota)
        return;
    seat->quota->n_connections--;
    client_quota_put(seat->quota);
    party_put(seat->party);
    *seat = (struct session_seat){0};
}

void session_sit_down(struct session *session, const struct session_seat *seat)
{
    session->seat = *seat;
    session->requests.quota = seat->quota;
    request_client_join(&session->requests, seat->party);
    conn_join(&session->conn, &seat->party->intake);
}

bool session_admit(struct session *session, uint32_t seq, const sheen_Hello *hello)
{
    struct error error = {0};
    struct identity *identity = &session->client.identity;
    if (!access_admit_tls(session->host->access, &session->conn,
                          hello->has_token ? hello->token : NULL, identity, &error)) {
        session_end_stranger(session, hello->has_token ? STRANGER_WRONG : STRANGER_GONE);
        session_turn_away(session, error.text);
        return false;
    }
    session->admitted = true;
    session_end_stranger(session, STRANGER_ADMITTED);
    log_event(LOG_INFO, "client admitted", log_number("session", session->id),
              log_text("identity", identity->name), log_text("issuer", identity->issuer));
    struct session_seat seat;
    if (!session_take_seat(session->host, identity, &seat, &error)) {
        session_refuse(session, seq, sheen_ErrorCode_ERROR_OVERLOADED, "%s", error.text);
        return false;
    }
    session_sit_down(session, &seat);
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
