/* The inside of a session: one connection and the messages on it.
 *
 * Thread: one at a time, as sheen.h says. Only the files of libsheen include this. */
#ifndef SHEEN_CLIENT_SESSION_H
#define SHEEN_CLIENT_SESSION_H

#include "client/lib/connection.h"
#include "client/lib/private_daemon.h"
#include "client/lib/sheen.h"
#include "protocol/codec.h"
#include "protocol/message.h"

/* A request whose frame has not been received. */
struct session_pending {
    uint32_t seq;
    unsigned n_retries;
    bool undecoded;      /* its planes stay as they come */
    sheen_Render render; /* as sent: it may have to be sent again */
};

/* The message that is being read. What has come of it stays here while there is no more to read. */
struct session_input {
    uint8_t head[MESSAGE_HEADER_BYTES];
    struct message_header header; /* once has_header */
    bool has_header;              /* and the body has not been read whole */
    size_t n_got;                 /* bytes of the header, or after it of the body */
    uint8_t body[MESSAGE_BUFFER_BYTES];
};

/* A frame whose FRAME has been read and whose DATA has not, or not all. */
struct session_answer {
    bool is_open;
    uint32_t seq; /* of a request that is pending still */
    sheen_Frame body;
    struct codec_layout layout;
    uint8_t *data; /* of `capacity`; body.data_bytes in the end */
    size_t capacity, n_received;
};

struct sheen_session {
    struct connection connection;
    struct private_daemon daemon;
    bool share;                   /* what it uploads */
    bool broken;                  /* after a fatal status; only sheen_close() is left */
    uint32_t last_seq, last_sent; /* of all messages, of requests for frames */
    size_t n_pending;
    struct session_pending pending[SHEEN_MAX_IN_FLIGHT]; /* oldest first */
    sheen_HelloOk hello;
    struct codec_decoder *decoder; /* NULL until the first zstd frame */
    struct session_input input;
    struct session_answer answer;
    uint8_t output[MESSAGE_BUFFER_BYTES]; /* the message that is being written */
};

/* Marks the session broken if the status is fatal, lets a dead private daemon explain itself, and
 * returns the status that is then in *error. */
enum sheen_status session_fail(struct sheen_session *session, enum sheen_status status,
                               struct sheen_error *error);

/* The place of the pending request of this number; n_pending when there is none. */
size_t session_find_pending(const struct sheen_session *session, uint32_t seq);

/* SHEEN_LOST_SERVER for a broken session, SHEEN_BAD_ARGUMENT for NULL, else SHEEN_OK. */
enum sheen_status session_check(const struct sheen_session *session, struct sheen_error *error);

/* Sends a message with the next sequence number, which is written to *seq. */
enum sheen_status session_send(struct sheen_session *session, uint8_t type, const void *body,
                               uint32_t *seq, struct sheen_error *error);
/* The same with a number that has been used: of a request that was answered without being done. */
enum sheen_status session_send_again(struct sheen_session *session, uint8_t type, const void *body,
                                     uint32_t seq, struct sheen_error *error);
/* Sends raw bytes of a type that has no body struct. */
enum sheen_status session_send_raw(struct sheen_session *session, uint8_t type, uint32_t seq,
                                   const uint8_t *bytes, uint32_t n_bytes,
                                   struct sheen_error *error);

/* The functions below that read say SHEEN_AGAIN where the connection must not wait and has no more
 * to read now; the same call goes on later where it ended. */

/* Reads the next header that is not PROGRESS (which is reported to `progress`, which may be NULL).
 * The body, header->length bytes, is the caller's to read; until he has, it is the next header. */
enum sheen_status session_next(struct sheen_session *session, const struct sheen_progress *progress,
                               struct message_header *header, struct sheen_error *error);

/* Reads a body and checks it into the type's struct. */
enum sheen_status session_read_body(struct sheen_session *session,
                                    const struct message_header *header, void *body,
                                    struct sheen_error *error);
/* Reads a body of plain bytes, header->length of them, to `bytes`. */
enum sheen_status session_read_raw(struct sheen_session *session,
                                   const struct message_header *header, uint8_t *bytes,
                                   struct sheen_error *error);
/* Reads the body of an ERROR and turns it into its status. */
enum sheen_status session_read_error(struct sheen_session *session,
                                     const struct message_header *header,
                                     struct sheen_error *error);
/* SHEEN_BAD_PEER, by a message of this type. */
enum sheen_status session_bad_peer(struct sheen_session *session, struct sheen_error *error,
                                   uint8_t type, const char *what);

/* Reads the next header, which must answer request `seq`, passing over PROGRESS. An ERROR becomes
 * its status; another type or number is SHEEN_BAD_PEER. The body, header->length bytes, is the
 * caller's to read. */
enum sheen_status session_expect(struct sheen_session *session, uint32_t seq, uint8_t type,
                                 const struct sheen_progress *progress,
                                 struct message_header *header, struct sheen_error *error);

/* session_expect(), then body and its checks into the type's struct. */
enum sheen_status session_receive(struct sheen_session *session, uint32_t seq, uint8_t type,
                                  const struct sheen_progress *progress, void *body,
                                  struct sheen_error *error);

#endif
