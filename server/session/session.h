/* One client: its handshake, its upload, its requests, its limits.
 *
 * The protocol's rules for the order of messages are held here and nowhere else. A client that
 * breaks the protocol is told so and disconnected; every other failure is an ERROR answer to one
 * request. Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_H
#define SHEEN_SESSION_SESSION_H

#include "server/session/session_state.h"

/* How long the drain has gone on beyond drain-timeout, in microseconds; 0: it has not. */
uint64_t session_host_overdue_us(const struct session_host *host, uint64_t now_us);

/* A seat for one more connection of an identity. ERROR_SERVER when it has as many as it may, or
 * without memory. */
bool session_take_seat(struct session_host *host, const struct identity *identity,
                       struct session_seat *seat, struct error *error);
void session_leave_seat(struct session_seat *seat);

/* Takes the socket over (closes it on failure), and the seat, which is zeroed for a client that shows
 * who it is by HELLO. */
struct session *session_create(struct session_host *host, int fd,
                               const struct session_client *client, struct session_seat seat,
                               struct error *error);
/* Closes at once; requests in flight end unseen. */
void session_destroy(struct session *session);

/* After every batch of events: delivers what was held back, closes what is over. False when the
 * session is closed and may be destroyed. */
bool session_settle(struct session *session);
/* Deadlines and progress. */
void session_tick(struct session *session, uint64_t now_us);
/* Closes when the client may not be here any more, by rules of access that may have changed. */
void session_check_access(struct session *session, bool changed);

#endif
