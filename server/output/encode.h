/* Turns a rendered frame into the bytes that the client asked for. The pool's threads encode it;
 * EXR and TIFF files are encoded by a worker process.
 * Thread: the loop's, for all functions here. */
#ifndef SHEEN_OUTPUT_ENCODE_H
#define SHEEN_OUTPUT_ENCODE_H

#include "protocol/codec.h"
#include "protocol/message.h"
#include "server/scene/frame.h"
#include "server/output/jpeg.h"
#include "server/threads/pool.h"
#include "server/threads/workers.h"

/* What a frame is encoded to. */
struct encode_format {
    sheen_Encoding encoding;
    struct jpeg_options jpeg; /* for JPEG */
};

/* What a request that has been checked (message_check_render()) asks for. */
struct encode_format encode_format_of(const sheen_Render *render);

/* The bytes of a frame's DATA messages, in pieces that follow one another. */
struct encoded_piece {
    const uint8_t *bytes;
    size_t size;
};
struct encoded {
    size_t n_pieces;
    struct encoded_piece *pieces;
    uint64_t size; /* of all pieces */

    struct frame frame; /* RAW: the planes themselves */
    uint8_t **blocks;   /* what the pieces lie in, if not in the frame */
    size_t n_blocks;
    struct block_cache *block_cache; /* the frame's: where all of it comes from */

    unsigned *unsent;                  /* counted down at the end; may be NULL */
    void (*released)(void *memory_of); /* what its memory was charged to; may be NULL */
    void *memory_of;
};

/* The context of a pool's threads: the encoders that each needs for itself. */
extern const struct pool_context encode_context;

/* What encoding a frame takes at most, beside its planes. */
uint64_t encode_bytes(const struct codec_layout *layout, const struct encode_format *format);

/* Takes *frame over in any case and zeroes it. finished() gets the bytes, or NULL and why; it may
 * be called before this returns. `layout` fits the frame, and has what the encoding asks for
 * (message_check_render()); `attributes` stay until finished(). */
void encode_start(struct pool *pool, struct workers *workers, struct frame *frame,
                  const struct codec_layout *layout, const struct encode_format *format,
                  enum pool_urgency urgency, const struct image_attribute *attributes,
                  size_t n_attributes,
                  void (*finished)(void *owner, struct encoded *encoded, const struct error *error),
                  void *owner);

void encoded_destroy(struct encoded *encoded); /* NULL is safe */

#endif
