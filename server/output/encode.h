/* Turns a rendered frame into the bytes that the client asked for. RAW needs no work; ZSTD, PNG and
 * JPEG are encoded in strips by the threads of a pool; EXR and TIFF files are written by a worker
 * process. This header knows frames and encodings; it knows no client and no connection.
 * Thread: the loop's, for all functions here. */
#ifndef SHEEN_OUTPUT_ENCODE_H
#define SHEEN_OUTPUT_ENCODE_H

#include "protocol/codec.h"
#include "protocol/messages/message.h"
#include "server/scene/frame.h"
#include "server/output/jpeg.h"
#include "server/threads/pool.h"
#include "server/threads/workers.h"

/* The encoding of a frame and its options. */
struct encode_format {
    sheen_Encoding encoding;
    struct jpeg_options jpeg; /* for JPEG */
};

/* The format that a render request asks for. The request has passed message_check_render(). */
struct encode_format encode_format_of(const sheen_Render *render);

/* The payload of a frame's DATA messages: the pieces, one after another. */
struct encoded_piece {
    const uint8_t *bytes;
    size_t size;
};
struct encoded {
    size_t n_pieces;
    struct encoded_piece *pieces;
    uint64_t size; /* of all pieces */

    struct frame frame; /* RAW: owns the planes, which are the pieces; else empty */
    uint8_t **blocks;   /* own the bytes of the pieces that do not lie in `frame` */
    size_t n_blocks;
    struct block_cache *block_cache; /* the frame's; all memory of this struct is taken from it */

    unsigned *unsent;                  /* decremented by encoded_destroy(); may be NULL */
    void (*released)(void *memory_of); /* called by encoded_destroy() with memory_of, to refund the
                                        * memory; may be NULL */
    void *memory_of;
};

/* The context that a pool must be created with if encode_start() uses it: the zstd, JPEG and PNG
 * encoders of each thread. */
extern const struct pool_context encode_context;

/* An upper bound of the memory that encoding a frame takes in addition to its planes, in bytes. */
uint64_t encode_bytes(const struct codec_layout *layout, const struct encode_format *format);

/* Starts to encode a frame. Takes the ownership of *frame and zeroes it, also on failure. `layout`
 * describes the frame's planes, among which are those that the encoding needs
 * (message_check_render()). `attributes` are the metadata of a file; they must stay valid until
 * finished() is called.
 *
 * finished() is called exactly once, on the loop's thread: with the encoded bytes, which it then
 * owns, or with NULL and the error (ERROR_SERVER when memory is short). It may be called before
 * encode_start() returns. */
void encode_start(struct pool *pool, struct workers *workers, struct frame *frame,
                  const struct codec_layout *layout, const struct encode_format *format,
                  enum pool_urgency urgency, const struct image_attribute *attributes,
                  size_t n_attributes,
                  void (*finished)(void *owner, struct encoded *encoded, const struct error *error),
                  void *owner);

/* Bytes that need no encoding, as one piece. Takes the ownership of `bytes`, which are of `block_cache`. NULL when
 * memory is short; the caller keeps the bytes. */
struct encoded *encoded_of(struct block_cache *block_cache, uint8_t *bytes, size_t size);
void encoded_destroy(struct encoded *encoded); /* NULL is safe */

#endif
