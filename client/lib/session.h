/* The inside of a session: one connection and the messages on it. Only libsheen's own files include
 * this.
 *
 * Functions that return a status fill in *error unless they return SHEEN_OK.
 * Thread: one at a time, as sheen.h says. */
#ifndef SHEEN_CLIENT_SESSION_H
#define SHEEN_CLIENT_SESSION_H

#include "client/lib/connection.h"
#include "client/lib/private_daemon.h"
#include "client/lib/sheen.h"
#include "protocol/codec.h"
#include "protocol/messages/message.h"

/* A request in flight: its frame has not been received yet. */
struct session_pending {
    uint32_t seq;
    unsigned n_retries;
    bool undecoded;      /* its planes are not decoded */
    sheen_Render render; /* as sent, in case it must be sent again */
};

/* The message that is being read. The part that has come is kept here until the rest can be
 * read. */
struct session_input {
    uint8_t head[MESSAGE_HEADER_BYTES];
    struct message_header header; /* valid if has_header */
    bool has_header;              /* the header is complete, and the body is not read to its end */
    size_t n_got;                 /* bytes received of the header, or, after it, of the body */
    uint8_t body[MESSAGE_BUFFER_BYTES];
};

/* The DATA of an answer, as far as it was received. */
struct session_data {
    uint8_t *bytes; /* buffer of `capacity` bytes */
    size_t capacity, n_received;
};

/* A frame whose FRAME message was read, but not yet all of its DATA. */
struct session_answer {
    bool is_open;
    uint32_t seq; /* number of a request that is still pending */
    sheen_Frame body;
    struct codec_layout layout;
    struct session_data data; /* body.data_bytes are expected */
};

struct sheen_session {
    struct connection connection;
    struct private_daemon daemon;
    bool share;  /* uploads are for all clients */
    bool broken; /* a fatal status occurred; only sheen_close() is allowed */
    /* Number of the latest message; of the latest request for a frame. */
    uint32_t last_seq, last_sent;
    size_t n_pending;
    struct session_pending pending[SHEEN_MAX_IN_FLIGHT]; /* oldest first */
    sheen_HelloOk hello;
    struct codec_decoder *decoder; /* NULL until the first zstd frame */
    struct session_input input;
    struct session_answer answer;
    uint8_t output[MESSAGE_BUFFER_BYTES]; /* buffer of the message that is being written */
};

/* Marks the session as broken if the status is fatal, and lets a dead private daemon explain its
 * end. Returns the status that *error then has. */
enum sheen_status session_fail(struct sheen_session *session, enum sheen_status status,
                               struct sheen_error *error);

/* The index in `pending` of the request with this number; n_pending if there is none. */
size_t session_find_pending(const struct sheen_session *session, uint32_t seq);

/* SHEEN_LOST_SERVER for a broken session, SHEEN_BAD_ARGUMENT for NULL, else SHEEN_OK. */
enum sheen_status session_check(const struct sheen_session *session, struct sheen_error *error);

/* Sends a message with the next number, which is stored in *seq. */
enum sheen_status session_send(struct sheen_session *session, uint8_t type, const void *body,
                               uint32_t *seq, struct sheen_error *error);
/* As session_send(), with a given number: that of a request that was answered but not carried
 * out. */
enum sheen_status session_send_again(struct sheen_session *session, uint8_t type, const void *body,
                                     uint32_t seq, struct sheen_error *error);
/* Sends raw bytes as the body of a type without a body struct. */
enum sheen_status session_send_raw(struct sheen_session *session, uint8_t type, uint32_t seq,
                                   const uint8_t *bytes, uint32_t n_bytes,
                                   struct sheen_error *error);

/* If the connection must not wait and no more bytes are there, the reading functions below return
 * SHEEN_AGAIN; the same call later continues where it stopped. */

/* Reads the next header other than PROGRESS. PROGRESS is reported to `progress`, which may be NULL.
 * The caller must read the body of header->length bytes; until then this is the next header. */
enum sheen_status session_next(struct sheen_session *session, const struct sheen_progress *progress,
                               struct message_header *header, struct sheen_error *error);

/* Reads a body into the type's struct and checks it. */
enum sheen_status session_read_body(struct sheen_session *session,
                                    const struct message_header *header, void *body,
                                    struct sheen_error *error);
/* Reads a body of plain bytes, header->length of them, into `bytes`. */
enum sheen_status session_read_raw(struct sheen_session *session,
                                   const struct message_header *header, uint8_t *bytes,
                                   struct sheen_error *error);
/* Reads the body of an ERROR and returns its status. */
enum sheen_status session_read_error(struct sheen_session *session,
                                     const struct message_header *header,
                                     struct sheen_error *error);
/* Returns SHEEN_BAD_ARGUMENT: the daemon's version cannot do `what` ("find breaks"). */
enum sheen_status session_too_old(struct sheen_error *error, const char *what);
/* Returns SHEEN_BAD_PEER with a text that names the message type and what is wrong. */
enum sheen_status session_bad_peer(struct sheen_session *session, struct sheen_error *error,
                                   uint8_t type, const char *what);

/* Reads the next header other than PROGRESS, which must be `type` and answer request `seq`. An
 * ERROR is returned as its status; any other type or number is SHEEN_BAD_PEER. The caller must read
 * the body of header->length bytes. */
enum sheen_status session_expect(struct sheen_session *session, uint32_t seq, uint8_t type,
                                 const struct sheen_progress *progress,
                                 struct message_header *header, struct sheen_error *error);

/* session_expect(), then reads the body into the type's struct and checks it. */
enum sheen_status session_receive(struct sheen_session *session, uint32_t seq, uint8_t type,
                                  const struct sheen_progress *progress, void *body,
                                  struct sheen_error *error);

#endif
