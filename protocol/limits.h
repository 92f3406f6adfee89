/* Every number that a peer can hit, in one table. README.md repeats them for people.
 *
 * A receiver checks these before it allocates or reads; going over one costs an ERROR message that
 * names the limit. Plain constants: no thread, no ownership. */
#ifndef SHEEN_PROTOCOL_LIMITS_H
#define SHEEN_PROTOCOL_LIMITS_H

#include <stdint.h>

/* Largest bodies, in bytes, by message type. Larger than what version 1.0 sends where a later minor
 * version may add fields; message.c holds at compile time that 1.0 fits. */
#define PROTOCOL_MAX_SMALL_BODY_BYTES 2048u    /* every type that is not named below */
#define PROTOCOL_MAX_LARGE_BODY_BYTES 8192u    /* MODEL_INFO: warnings; RENDER, FRAME: lights */
#define PROTOCOL_MAX_CHUNK_BYTES (256u * 1024) /* UPLOAD_CHUNK */
#define PROTOCOL_MAX_DATA_BYTES (1024u * 1024) /* DATA */

/* Uploads and frames. */
#define PROTOCOL_MAX_UPLOAD_BYTES (1024ull * 1024 * 1024) /* one model or image file */
#define PROTOCOL_MAX_FRAME_BYTES (4096ull * 1024 * 1024)  /* one frame: its planes, or its file */
#define PROTOCOL_MAX_SIZE_PX 65536u /* width and height; the device's limit is lower */
#define PROTOCOL_MAX_JPEG_PX 65500u /* the same of a JPEG file: libjpeg's limit */

/* The budget of a daemon's memory, which a client may choose for one of its own. */
#define PROTOCOL_LEAST_MEMORY_BYTES (4ull * 1024 * 1024)
#define PROTOCOL_MOST_MEMORY_BYTES (UINT64_MAX / 4) /* sums of a few stay in range */

/* Of the native device of a daemon: threads, and instruction sets. */
#define PROTOCOL_MOST_NATIVE_THREADS 64
#define PROTOCOL_NATIVE_ISAS "auto", "v2", "v3", "v4"

/* Requests sent and not yet answered, per connection. A peer of minor version 0 has the first, and
 * more is left in the socket's buffer; to others HELLO_OK grants some, and more breaks the
 * protocol. */
#define PROTOCOL_MAX_IN_FLIGHT 4u
#define PROTOCOL_MAX_CREDITS 64u

/* Ends of ranges that code besides the checks is built by; ranges.h has all of them. */
#define PROTOCOL_MAX_SURFACE_LEVEL 6
#define PROTOCOL_MAX_COORDINATE 1e30 /* absolute; squares stay finite in double */
#define PROTOCOL_MAX_LIGHTS 8
#define PROTOCOL_MAX_LINES 16 /* of one pattern */

/* Strips of an ENCODING_ZSTD frame hold this many bytes of a plane, or one row if that is more. */
#define PROTOCOL_STRIP_BYTES (512u * 1024)

#endif
