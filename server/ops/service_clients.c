/* Listeners, and the clients that come in by them. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/net/listen.h"
#include "server/ops/notify.h"
#include "server/ops/service_internal.h"

/* Closes the connection of a client that gets no session, after an error message with `text` unless
 * it is NULL. */
static void turn_away(int fd, const char *text)
{
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_OVERLOADED};
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    snprintf(error.text, sizeof error.text, "%s", text ? text : "");
    if (text && !message_encode(MESSAGE_ERROR, 0, &error, buffer, sizeof buffer, &length))
        length = 0;
    conn_turn_away(fd, buffer, length);
}

/* False with *error when there are as many clients as allowed. */
static bool has_room(const struct daemon *daemon, struct error *error)
{
    uint64_t n = daemon->sessions.n_sessions;
    return (n < daemon->limits.max_connections && n < daemon->most_clients) ||
           error_set(error, ERROR_SERVER,
                     "the daemon has as many clients as it takes: try again later");
}

static void log_turned_away(struct service *service, enum log_level level, const char *peer,
                            const struct listener *listener, const char *text)
{
    service->daemon.sessions.stats.refused++;
    log_event(level, "client turned away", log_text("peer", peer),
              log_text("listener", listener_text(listener)), log_text("text", text));
}

/* Starts a session for a new connection. A TLS client is not identified before its HELLO. */
static void welcome(struct service *service, const struct listener *listener, int fd,
                    const struct session_client *client)
{
    struct daemon *daemon = &service->daemon;
    struct session *session = NULL;
    struct session_seat seat = {0};
    struct error error = {0};
    bool stranger = client->kind == CLIENT_TLS;
    if (has_room(daemon, &error) &&
        (stranger || session_take_seat(&daemon->sessions, &client->identity, &seat, &error))) {
        session = session_create(&daemon->sessions, fd, client, seat, &error);
    } else {
        daemon->sessions.stats.errors++;
        turn_away(fd, stranger ? NULL : error.text); /* a stranger is told nothing */
    }
    if (session)
        LIST_INSERT_HEAD(&service->sessions, session, link);
    else
        log_turned_away(service, LOG_WARN, client->peer, listener, error.text);
}

/* Handles a new connection from address `from`, which the socket shows, or a balancer's PROXY
 * header (by_balancer). */
static void came_from(struct service *service, const struct listener *listener, int fd,
                      const struct sockaddr *from, bool by_balancer)
{
    struct daemon *daemon = &service->daemon;
    struct error error = {0};
    const enum address_kind kind = listener_kind(listener);
    struct session_client client = {.kind = kind == ADDRESS_UNIX  ? CLIENT_UNIX
                                            : kind == ADDRESS_TCP ? CLIENT_TCP
                                                                  : CLIENT_TLS};
    if (kind == ADDRESS_UNIX)
        peer_describe(fd, client.peer);
    else
        peer_describe_address(from, client.peer);
    client.from = peer_of_address(from);
    client.is_balancer = !by_balancer && proxy_networks_hold(&service->options.proxy_from, from);
    if (kind == ADDRESS_TLS) {
        if (client.is_balancer ||
            strangers_admits(&daemon->sessions.strangers, &client.from, clock_now_us())) {
            welcome(service, listener, fd, &client);
            return;
        }
        conn_turn_away(fd, NULL, 0);
        log_turned_away(service, LOG_DEBUG, client.peer, listener,
                        "its address has come without credentials again and again");
    } else if (access_admit_local(daemon->access, fd, kind, &client.identity, &error)) {
        if (by_balancer)
            access_admit_proxied(&client.from, &client.identity);
        welcome(service, listener, fd, &client);
    } else {
        conn_turn_away(fd, NULL, 0); /* a stranger is told nothing */
        log_turned_away(service, LOG_WARN, client.peer, listener, error.text);
    }
}

static void accepted(void *owner, const struct listener *listener, int fd)
{
    struct service *service = owner;
    struct sockaddr_storage address;
    const struct sockaddr *from = (const struct sockaddr *)&address;
    peer_address(fd, &address); /* if the peer has gone already, the address is unknown */
    if (proxy_networks_hold(&service->options.proxy_from, from))
        proxied_accept(service->proxied, listener, fd);
    else
        came_from(service, listener, fd, from, false);
}

static void header_arrived(void *owner, const struct listener *listener, int fd,
                           const struct sockaddr *from)
{
    struct sockaddr_storage address;
    peer_address(fd, &address);
    came_from(owner, listener, fd, from ? from : (const struct sockaddr *)&address, from != NULL);
}

static void header_refused(void *owner, const struct listener *listener, const char *why)
{
    log_turned_away(owner, LOG_WARN, "a balancer of --proxy-from", listener, why);
}

void service_settle_sessions(struct service *service)
{
    struct session *session = LIST_FIRST(&service->sessions);
    while (session) {
        struct session *next = LIST_NEXT(session, link);
        if (!session_settle(session)) {
            LIST_REMOVE(session, link);
            session_destroy(session);
        }
        session = next;
    }
}

bool service_rests(const struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            return true;
    return false;
}

void service_resume_listeners(struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_is_paused(service->listeners[i]))
            listener_resume(service->listeners[i]);
}

/* --- listeners */

void service_close_listeners(struct service *service)
{
    proxied_destroy(service->proxied);
    service->proxied = NULL;
    while (service->n_listeners > 0)
        listener_close(service->listeners[--service->n_listeners]);
}

bool service_has_tls(const struct service *service)
{
    for (size_t i = 0; i < service->n_listeners; i++)
        if (listener_kind(service->listeners[i]) == ADDRESS_TLS)
            return true;
    return false;
}

/* Keeps an opened listener. `listener` may be NULL: then *error is already set, and false is
 * returned. */
static bool keep_listener(struct service *service, struct listener *listener, struct error *error)
{
    if (!listener)
        return false;
    service->listeners[service->n_listeners++] = listener;
    listener_open_to_all(listener, access_has_list(service->daemon.access));
    return listener_kind(listener) != ADDRESS_TLS || access_can_tls(service->daemon.access, error);
}

/* Takes over the service manager's sockets. One named "metrics" serves metrics, one named "tls"
 * speaks TLS. */
static bool adopt_listeners(struct service *service, struct error *error)
{
    struct notify_fds fds;
    const struct listener_handler handler = {accepted, service};
    if (!notify_listen_fds(&fds, error))
        return false;
    bool ok = true;
    for (size_t i = 0; i < fds.n; i++) {
        if (!ok)
            close(fds.fd[i]);
        else if (strcmp(fds.name[i], "metrics") == 0)
            ok = monitor_adopt(service->monitor, fds.fd[i],
                               service_metrics_reach(&service->options), error);
        else if (service->n_listeners < SERVICE_MAX_LISTENERS)
            ok = keep_listener(service,
                               listener_adopt(service->daemon.loop, fds.fd[i],
                                              strcmp(fds.name[i], "tls") == 0, LISTENER_LOOPBACK,
                                              &handler, error),
                               error);
        else
            ok = error_set(error, ERROR_SERVER, "more than %d sockets from the service manager",
                           SERVICE_MAX_LISTENERS);
    }
    return ok;
}

bool service_open_listeners(struct service *service, struct error *error)
{
    const struct listener_handler handler = {accepted, service};
    struct service_listen listen = service->options.listen;
    const struct proxied_handler proxied = {header_arrived, header_refused, service};
    if (!(service->proxied = proxied_create(service->daemon.loop, &proxied)))
        return error_set(error, ERROR_SERVER, "no memory for the daemon");
    if (!adopt_listeners(service, error))
        return false;
    if (listen.n == 0 && service->n_listeners == 0) {
        listen.n = 1;
        if (!listener_default(&listen.address[0], error))
            return false;
    }
    for (size_t i = 0; i < listen.n; i++) {
        if (service->n_listeners == SERVICE_MAX_LISTENERS)
            return error_set(error, ERROR_SERVER, "at most %d addresses to listen on",
                             SERVICE_MAX_LISTENERS);
        if (!keep_listener(service,
                           listener_open(service->daemon.loop, &listen.address[i],
                                         LISTENER_LOOPBACK, &handler, error),
                           error))
            return false;
    }
    const struct service_listen *metrics = &service->options.metrics;
    return metrics->n == 0 || monitor_listen(service->monitor, &metrics->address[0],
                                             service_metrics_reach(&service->options), error);
}

void service_list_addresses(const struct service *service, char *text, size_t capacity)
{
    size_t used = 0;
    text[0] = 0;
    for (size_t i = 0; i < service->n_listeners && used < capacity; i++)
        used += (size_t)snprintf(text + used, capacity - used, "%s%s", i ? ", " : "",
                                 listener_text(service->listeners[i]));
}

bool service_open_session(struct service *service, int fd, struct error *error)
{
    struct daemon *daemon = &service->daemon;
    struct session_client client = {.kind = CLIENT_PRIVATE, .peer = "private"};
    access_admit_private(&client.identity);
    struct session_seat seat;
    if (!session_take_seat(&daemon->sessions, &client.identity, &seat, error))
        return false;
    struct session *session = session_create(&daemon->sessions, fd, &client, seat, error);
    if (session)
        LIST_INSERT_HEAD(&service->sessions, session, link);
    return session != NULL;
}
