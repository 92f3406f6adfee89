/* A session serves one connected client: handshake, upload, requests, limits. It knows its
 * connection (server/net) and its requests (server/frame).
 *
 * Only this folder enforces the order of messages that the protocol demands. A client that breaks
 * the protocol gets an ERROR and is disconnected; every other failure is an ERROR reply to one
 * request.
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_H
#define SHEEN_SESSION_SESSION_H

#include "server/session/session_state.h"

/* Call it at each tick, before session_tick() of all sessions: counts host->overdue_ticks. */
void session_host_tick(struct session_host *host, uint64_t now_us);

/* Takes a seat for one more connection of an identity. False with ERROR_SERVER when the identity
 * has as many connections as it may, or when memory is short. The caller owns the seat until
 * session_create(). */
bool session_take_seat(struct session_host *host, const struct identity *identity,
                       struct session_seat *seat, struct error *error);
void session_leave_seat(struct session_seat *seat);

/* Starts a session on a connected socket. Takes over the socket and the seat, on failure too. A
 * client that proves its identity by HELLO (CLIENT_TLS) comes with a zeroed seat. Copies *client.
 * NULL with ERROR_SERVER on failure. */
struct session *session_create(struct session_host *host, int fd,
                               const struct session_client *client, struct session_seat seat,
                               struct error *error);
/* Closes the connection at once. Requests in flight continue without a client and free
 * themselves. */
void session_destroy(struct session *session);

/* Call it after each batch of events: sends replies that are due and delivers messages that were
 * held back. False when the connection is closed: then destroy the session. */
bool session_settle(struct session *session);
/* Call it regularly: enforces deadlines and limits, and sends progress messages. */
void session_tick(struct session *session, uint64_t now_us);
/* Closes the connection if the rules of access do not admit the client any more. `changed`: the
 * rules were reloaded, so certificates are verified again too. */
void session_check_access(struct session *session, bool changed);

#endif
