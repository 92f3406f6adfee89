/* The limits that both sides of the protocol know, in one table. README.md lists them for people.
 *
 * A receiver checks them before it allocates or reads; a message beyond a limit is answered by an
 * ERROR that names the limit. Constants only. */
#ifndef SHEEN_PROTOCOL_LIMITS_H
#define SHEEN_PROTOCOL_LIMITS_H

#include <stdint.h>

/* The largest bodies in bytes, by message type. They leave room for fields of later minor versions;
 * message.c checks at compile time that those of version 1.0 fit. */
#define PROTOCOL_MAX_SMALL_BODY_BYTES 2048u    /* all other types */
#define PROTOCOL_MAX_LARGE_BODY_BYTES 8192u    /* MODEL_INFO: warnings; those with lights */
#define PROTOCOL_MAX_CHUNK_BYTES (256u * 1024) /* UPLOAD_CHUNK */
#define PROTOCOL_MAX_DATA_BYTES (1024u * 1024) /* DATA */

/* Uploads and frames. */
#define PROTOCOL_MAX_UPLOAD_BYTES (1024ull * 1024 * 1024) /* one model or image file */
#define PROTOCOL_MAX_FRAME_BYTES (4096ull * 1024 * 1024)  /* one frame: its planes or its file */
#define PROTOCOL_MAX_SIZE_PX 65536u /* width and height; the device's limit may be lower */
#define PROTOCOL_MAX_JPEG_PX 65500u /* width and height of a JPEG file: libjpeg's limit */

/* The range of a daemon's memory budget, which a client chooses for its private daemon. The least is what
 * the daemon itself takes that draws on processors, and a little more; a daemon that draws by a driver
 * needs more, and says how much. */
#define PROTOCOL_DAEMON_BYTES (32ull * 1024 * 1024)
#define PROTOCOL_LEAST_MEMORY_MIB 36 /* a plain number, so that help texts can name it */
#define PROTOCOL_LEAST_MEMORY_BYTES (PROTOCOL_LEAST_MEMORY_MIB * 1024ull * 1024)
#define PROTOCOL_MOST_MEMORY_BYTES (UINT64_MAX / 4) /* so that sums of a few do not overflow */

/* The native device of a daemon: its threads, and its instruction sets. */
#define PROTOCOL_MOST_NATIVE_THREADS 64
#define PROTOCOL_NATIVE_ISAS "auto", "v2", "v3", "v4"

/* Unanswered requests of one connection. For a peer of minor version 0 the first number holds, and
 * further requests stay in the socket's buffer. For others HELLO_OK grants a number, and more
 * requests break the protocol. */
#define PROTOCOL_MAX_IN_FLIGHT 4u
#define PROTOCOL_MAX_CREDITS 64u

/* Limits of ranges that are used outside of checks, too; ranges.h has all ranges. */
#define PROTOCOL_MAX_SURFACE_LEVEL 6
/* Largest magnitude; its square is finite in double precision. */
#define PROTOCOL_MAX_COORDINATE 1e30
#define PROTOCOL_MAX_LIGHTS 8
#define PROTOCOL_MAX_LINES 16 /* lines of one pattern */

/* A strip of an ENCODING_ZSTD frame has this many bytes of a plane, or one row if that is more. */
#define PROTOCOL_STRIP_BYTES (512u * 1024)

#endif
