/* Encodes a frame's colour plane as a PNG file with 8 bits a channel: R, G, B, and alpha if any
 * pixel is not opaque. The metadata become text chunks.
 *
 * The picture is cut into horizontal strips so that several threads can encode it. The deflated
 * data of each strip end at a whole byte, so that the strips, one after another, are a single zlib
 * stream:
 *
 *   head      signature, IHDR, sRGB, one tEXt for each attribute
 *   strips    one IDAT each
 *   tail      a last IDAT with the checksum of the stream, then IEND; stored behind the last strip
 *
 * sheend calls zlib in its own process: it encodes only pixels that it has drawn itself, and a
 * worker process would cost more time than the encoding. Only png.c includes zlib. Thread: any; an
 * encoder is used by one thread at a time. */
#ifndef SHEEN_OUTPUT_PNG_H
#define SHEEN_OUTPUT_PNG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/image/image.h"
#include "server/output/strips.h"

struct png_encoder;

struct png_encoder *png_encoder_create(void);          /* NULL when memory is short */
void png_encoder_destroy(struct png_encoder *encoder); /* NULL is safe */

/* Both sides are from 1 to PROTOCOL_MAX_SIZE_PX. layout->bound leaves room for the tail behind a
 * strip. */
void png_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px);

/* True if every pixel of a strip has alpha 255. `rgba` is the whole picture: 8 bits each of R, G, B
 * and A, contiguous rows, top row first. */
bool png_strip_is_opaque(const struct strip_layout *layout, size_t index, const uint8_t *rgba);

/* The length in bytes of the buffer `row` that png_strip_encode() needs. */
size_t png_row_bytes(const struct strip_layout *layout);

struct png_strip {
    size_t size;       /* bytes written */
    uint32_t checksum; /* Adler-32 of the strip's rows as stored: each a filter byte, then the
                        * filtered pixels */
};

/* Encodes strip `index` of the picture `rgba` into `bytes`, which has room for layout->bound. `row`
 * is scratch memory of png_row_bytes() bytes. has_alpha must be the same for all strips of a file.
 * Takes no memory from the heap. The same input gives the same bytes. On failure returns false with
 * ERROR_SERVER; the encoder stays usable. */
bool png_strip_encode(struct png_encoder *encoder, const struct strip_layout *layout, size_t index,
                      const uint8_t *rgba, bool has_alpha, uint8_t *row, uint8_t *bytes,
                      struct png_strip *strip, struct error *error);

/* Combines checksums: returns the Adler-32 of strips 0 to `index`. `before` is that of the strips
 * before `index` (1 if there are none), `strip` that of strip `index` alone
 * (png_strip.checksum). */
uint32_t png_checksum(uint32_t before, const struct strip_layout *layout, size_t index,
                      bool has_alpha, uint32_t strip);

/* The number of bytes to allocate for the head: its length rounded up by strip_head_bound(). */
size_t png_head_bound(const struct image_attribute *attributes, size_t n_attributes);

/* Writes the head and returns its length in bytes. The name of an attribute has 1 to 79 bytes. */
size_t png_head_write(const struct strip_layout *layout, bool has_alpha,
                      const struct image_attribute *attributes, size_t n_attributes,
                      uint8_t *bytes);

/* Writes the tail and returns its length in bytes. `checksum` is the Adler-32 of all strips. */
size_t png_tail_write(uint32_t checksum, uint8_t *bytes);

#endif
