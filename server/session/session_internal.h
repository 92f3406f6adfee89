/* What the files of sessions share: session.c has a session's life and its messages,
 * session_input.c their order and the room for long ones,
 * session_reply.c how replies leave, session_requests.c what each request asks for,
 * session_stats.c the answer to STATS_QUERY, session_access.c who the client is, session_limits.c
 * what clients may not do too long or too much of. Private to them. Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_INTERNAL_H
#define SHEEN_SESSION_SESSION_INTERNAL_H

#include "server/session/session_state.h"

/* --- session.c */

/* The connection cannot go on: answers what came before, says why, and closes. */
void session_refuse(struct session *session, uint32_t seq, sheen_ErrorCode code, const char *format,
                    ...) __attribute__((format(printf, 4, 5)));

/* --- session_input.c */

/* NULL, or what is wrong with a message of this type and number now. */
const char *session_find_disorder(const struct session *session,
                                  const struct message_header *header);
void session_refuse_disorder(struct session *session, const struct message_header *header,
                             const char *disorder);
/* conn_handler's. When there is no memory the request has its answer: try again later. */
bool session_make_room(void *owner, const struct message_header *header, size_t bytes);
/* Gives the room of long messages back, if there is none in it; once the conn is finished. */
void session_trim_input(struct session *session);
void session_release_input(struct session *session);

/* --- session_reply.c */

/* How requests tell what becomes of them; their owner is the session. */
extern const struct request_events session_request_events;

/* The reply is ready. */
void session_reply(struct session *session, struct reply *reply, uint8_t type, const void *body);
void session_reply_error(struct session *session, struct reply *reply, sheen_ErrorCode code,
                         const char *text);
/* An interactive frame of the session is on its way to the socket: the next has to wait. */
bool session_is_sending(const struct session *session);

/* Owes the request an answer. NULL without memory; the connection is closed then. */
struct reply *session_expect_reply(struct session *session, uint32_t seq,
                                   enum request_class request_class);
/* Answers at once what takes no time. */
void session_reply_now(struct session *session, uint32_t seq, uint8_t type, const void *body);
void session_reply_error_now(struct session *session, uint32_t seq, sheen_ErrorCode code,
                             const char *text);

/* --- session_requests.c: one message each, decoded, in its turn; each is answered */

void session_upload_begin(struct session *session, uint32_t seq, const sheen_UploadBegin *begin);
void session_upload_chunk(struct session *session, uint32_t seq, const uint8_t *body,
                          size_t length);
void session_query(struct session *session, uint32_t seq, const sheen_ModelQuery *query);
void session_render(struct session *session, uint32_t seq, sheen_Render *render);

/* --- session_stats.c */

void session_reply_stats(struct session *session, uint32_t seq);

/* --- session_access.c */

/* Not admitted yet: another stranger may have to leave for this one. */
void session_be_stranger(struct session *session);
/* Does nothing for one who is none any more. */
void session_end_stranger(struct session *session, enum stranger_end end);
/* The admitted client's seat, from where it may ask. */
void session_sit_down(struct session *session, const struct session_seat *seat);
/* A stranger learns nothing, not even what is wrong; the log does. Closes. */
void session_turn_away(struct session *session, const char *why);
/* A client behind TLS says who it is. False when it has been turned away or refused. */
bool session_admit(struct session *session, uint32_t seq, const sheen_Hello *hello);

/* --- session_limits.c */

/* A line in the log, and one more in the statistics. */
void session_log_disconnect(struct session *session, const char *reason);

/* Another answer is to be sent: not when what is unsent is over the hard limit of its class. Then
 * the client is disconnected. */
bool session_may_send(struct session *session);

/* Everything that a client has not sent or not read for too long. */
void session_check_limits(struct session *session, uint64_t now_us);

#endif
