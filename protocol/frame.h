/* The 16-byte header of every message, and the types of messages.
 *
 *   0  u32  magic   "SHEN" (0x53 0x48 0x45 0x4e in this order)
 *   4  u8   major   PROTOCOL_MAJOR
 *   5  u8   type    enum message_type
 *   6  u16  flags   MESSAGE_END on the last DATA of an answer, else 0
 *   8  u32  length  bytes that follow
 *   12 u32  seq     chosen by the client; an answer has the number of its request
 *
 * All numbers are little-endian. Pure: no allocation, no state, any thread. */
#ifndef SHEEN_PROTOCOL_FRAME_H
#define SHEEN_PROTOCOL_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PROTOCOL_MAJOR 1
#define PROTOCOL_MINOR 5
#define MESSAGE_HEADER_BYTES 16
#define MODEL_ID_BYTES 32 /* SHA-256; the first bytes of HELLO's body, at offset 16 of the stream */
#define MESSAGE_END 1u    /* flags: last DATA of an answer */

enum message_type {
    MESSAGE_HELLO = 1,        /* client: model id, then Hello */
    MESSAGE_HELLO_OK = 2,     /* server: HelloOk */
    MESSAGE_UPLOAD_BEGIN = 3, /* client: UploadBegin */
    MESSAGE_UPLOAD_CHUNK = 4, /* client: raw bytes; only the last one is answered */
    MESSAGE_UPLOAD_STATE = 5, /* server: UploadState */
    MESSAGE_MODEL_QUERY = 6,  /* client: ModelQuery */
    MESSAGE_MODEL_INFO = 7,   /* server: ModelInfo */
    MESSAGE_RENDER = 8,       /* client: Render */
    MESSAGE_FRAME = 9,        /* server: Frame; DATA follows */
    MESSAGE_DATA = 10,        /* server: raw bytes of a frame's pixels or file, or records */
    MESSAGE_PROGRESS = 11,    /* server: Progress, any number before an answer */
    MESSAGE_STATS_QUERY = 12, /* client: empty */
    MESSAGE_STATS = 13,       /* server: Stats */
    MESSAGE_ERROR = 14,       /* server: Error, instead of the answer */
    MESSAGE_SUPERSEDED = 15,  /* server: Superseded, instead of FRAME; minor version 1 */
    /* Client: empty, with the number of the request to cancel; minor version 1. */
    MESSAGE_CANCEL = 16,
    /* Computations; minor version 5. */
    MESSAGE_FIND_BREAKS = 17, /* client: FindBreaks */
    MESSAGE_BREAKS = 18,      /* server: Breaks; DATA follows if there are records */
    MESSAGE_COMPARE = 19,     /* client: Compare */
    MESSAGE_COMPARED = 20,    /* server: Compared */
    MESSAGE_TRACE_LINES = 21, /* client: TraceLines */
    MESSAGE_CURVES = 22,      /* server: Curves; DATA follows if there are records */
};
enum { MESSAGE_TYPES = MESSAGE_CURVES + 1 }; /* above every type */

struct message_header {
    uint8_t major;
    uint8_t type;
    uint16_t flags;
    uint32_t length;
    uint32_t seq;
};

enum header_error {
    HEADER_OK,
    HEADER_BAD_MAGIC,
    HEADER_BAD_MAJOR,
    HEADER_BAD_TYPE,
    HEADER_TOO_LONG
};

void message_header_encode(const struct message_header *header,
                           uint8_t bytes[static MESSAGE_HEADER_BYTES]);

/* Decodes a header and checks magic, major, type, and the length against
 * message_max_length(type). */
enum header_error message_header_decode(struct message_header *header,
                                        const uint8_t bytes[static MESSAGE_HEADER_BYTES]);

/* The largest body of a message type, in bytes; 0 also for unknown types. */
uint32_t message_max_length(uint8_t type);
const char *message_type_name(uint8_t type);
const char *header_error_text(enum header_error error);

#endif
