/* What the files of sessions share: session.c has the protocol's order, session_access.c who the
 * client is, session_watch.c what clients may not do too long or too much of. Private to them.
 * Thread: the loop's. */
#ifndef SHEEN_SERVICE_SESSION_INSIDE_H
#define SHEEN_SERVICE_SESSION_INSIDE_H

#include "server/service/session.h"

/* --- session.c */

/* The connection cannot go on: answers what came before, says why, and closes. */
void session_refuse(struct session *session, uint32_t seq, sheen_ErrorCode code, const char *format,
                    ...) __attribute__((format(printf, 4, 5)));

/* --- session_access.c */

/* A stranger learns nothing, not even what is wrong; the log does. Closes. */
void session_turn_away(struct session *session, const char *why);
/* A client behind TLS says who it is. False when it has been turned away. */
bool session_admit(struct session *session, const sheen_Hello *hello);

/* --- session_watch.c */

/* A line in the log, and one more in the statistics. */
void session_log_disconnect(struct session *session, const char *reason);

/* Another answer is to be sent: not when what is unsent is over the hard limit of its class. Then
 * the client is disconnected. */
bool session_may_send(struct session *session);

/* Everything that a client has not sent or not read for too long. */
void session_check_limits(struct session *session, uint64_t now_us);

#endif
