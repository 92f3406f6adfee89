/* Functions that the files of this folder share. Private to them.
 *
 * session.c           a session's life, and its messages
 * session_input.c     the order of messages, and memory for long ones
 * session_reply.c     how replies leave
 * session_requests.c  what each request asks for
 * session_stats.c     the reply to STATS_QUERY
 * session_access.c    who the client is
 * session_limits.c    limits of time and of unsent output
 *
 * Thread: the loop's. */
#ifndef SHEEN_SESSION_SESSION_INTERNAL_H
#define SHEEN_SESSION_SESSION_INTERNAL_H

#include "server/session/session_state.h"

/* --- session.c */

/* Ends the connection: sends the replies that are owed, then an ERROR with this text, and closes. A
 * client that is not admitted is disconnected without a message. */
void session_refuse(struct session *session, uint32_t seq, sheen_ErrorCode code, const char *format,
                    ...) __attribute__((format(printf, 4, 5)));

/* --- session_input.c */

/* Checks that a message of this type and number may come now. Returns NULL, or what is wrong. */
const char *session_find_disorder(const struct session *session,
                                  const struct message_header *header);
void session_refuse_disorder(struct session *session, const struct message_header *header,
                             const char *disorder);
/* The make_room() of conn_handler: charges the memory that a long message needs. When there is
 * none, the request is answered with an ERROR (try again later). */
bool session_make_room(void *owner, const struct message_header *header, size_t bytes);
/* session_trim_input() frees the memory for long messages if no message is in it;
 * session_release_input() refunds it after the connection is finished. */
void session_trim_input(struct session *session);
void session_release_input(struct session *session);

/* --- session_reply.c */

/* The events by which requests report their results; their owner is the session. */
extern const struct request_events session_request_events;

/* Both fill in a reply that is owed. */
void session_reply(struct session *session, struct reply *reply, uint8_t type, const void *body);
void session_reply_error(struct session *session, struct reply *reply, sheen_ErrorCode code,
                         const char *text);
/* True while the connection has not sent an interactive frame completely: the next one has to
 * wait. */
bool session_is_sending(const struct session *session);

/* Adds a reply that is owed. NULL when memory is short; then the connection is closed. */
struct reply *session_expect_reply(struct session *session, uint32_t seq);
/* As session_expect_reply(), for a request that asks for a frame of this class. */
struct reply *session_expect_frame(struct session *session, uint32_t seq,
                                   enum request_class request_class);
/* Answer a request at once. */
void session_reply_now(struct session *session, uint32_t seq, uint8_t type, const void *body);
void session_reply_error_now(struct session *session, uint32_t seq, sheen_ErrorCode code,
                             const char *text);

/* --- session_requests.c: each function handles one decoded message and answers it */

void session_upload_begin(struct session *session, uint32_t seq, const sheen_UploadBegin *begin);
void session_upload_chunk(struct session *session, uint32_t seq, const uint8_t *body,
                          size_t length);
void session_query(struct session *session, uint32_t seq, const sheen_ModelQuery *query);
void session_render(struct session *session, uint32_t seq, sheen_Render *render);
/* A request of computed numbers, of this type. */
void session_compute(struct session *session, uint32_t seq, uint8_t type,
                     const union compute_asked *asked);

/* --- session_stats.c */

void session_reply_stats(struct session *session, uint32_t seq);

/* --- session_access.c */

/* Counts a client that has not identified itself as a stranger. If there are too many, another one
 * is disconnected. */
void session_be_stranger(struct session *session);
/* Stops counting the client as a stranger. Does nothing if it is not counted. */
void session_end_stranger(struct session *session, enum stranger_end end);
/* Gives the admitted client its seat; from here on it may make requests. */
void session_sit_down(struct session *session, const struct session_seat *seat);
/* Disconnects a client that is not admitted without a message, so that it learns nothing. The log
 * gets the reason. */
void session_turn_away(struct session *session, const char *why);
/* Admits a TLS client by its certificate or by the token in HELLO. False when it was disconnected
 * or refused. */
bool session_admit(struct session *session, uint32_t seq, const sheen_Hello *hello);

/* --- session_limits.c */

/* Logs and counts that the daemon disconnects the client. */
void session_log_disconnect(struct session *session, const char *reason);

/* May another reply be sent? If the unsent output exceeds the hard limit of its class, disconnects
 * the client and returns false. */
bool session_may_send(struct session *session);

/* Disconnects a client that has not sent or read something for too long. */
void session_check_limits(struct session *session, uint64_t now_us);

#endif
