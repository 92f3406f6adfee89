/* A frame's colour as a PNG file of 8 bits: R, G and B, and alpha where any pixel is not opaque.
 * The metadata become text chunks.
 *
 * The picture is cut into horizontal strips, so that threads can share the work. Each is deflated
 * by itself to whole bytes, so that all of them are one zlib stream back to back:
 *
 *   head      signature, IHDR, sRGB, a tEXt for each attribute
 *   strips    an IDAT each
 *   tail      a last IDAT with the stream's checksum, IEND; behind the last strip
 *
 * sheend does this itself: it reads its own pixels only, and a process of its own would cost more
 * than the work. zlib is included by png.c alone. Thread: any; an encoder belongs to one at a
 * time. */
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

/* Sides are from 1 to PROTOCOL_MAX_SIZE_PX. A strip's bound holds the tail as well. */
void png_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px);

/* Is every pixel of a strip opaque? Pictures are R, G, B and A of 8 bits each, rows contiguous, top
 * first. */
bool png_strip_is_opaque(const struct strip_layout *layout, size_t index, const uint8_t *rgba);

/* The length of the buffer for one row that png_strip_encode() takes. */
size_t png_row_bytes(const struct strip_layout *layout);

struct png_strip {
    size_t size;       /* bytes written */
    uint32_t checksum; /* Adler-32 of its rows as stored: filtered, a filter's number before each */
};

/* Encodes strip `index` of a picture to `bytes`, which has room for layout->bound; `row` is scratch
 * of png_row_bytes() bytes. All strips of a file are encoded with alpha, or all without, which is
 * then left out. No heap. False: ERROR_SERVER; the encoder may be used again. The same input gives
 * the same bytes. */
bool png_strip_encode(struct png_encoder *encoder, const struct strip_layout *layout, size_t index,
                      const uint8_t *rgba, bool has_alpha, uint8_t *row, uint8_t *bytes,
                      struct png_strip *strip, struct error *error);

/* The Adler-32 of the rows of all strips up to `index`: of `before`, that of the strips before it
 * (1 before the first), and `strip`, its own (png_strip.checksum). */
uint32_t png_checksum(uint32_t before, const struct strip_layout *layout, size_t index,
                      bool has_alpha, uint32_t strip);

/* The bytes to allocate for the head: strip_head_bound() of the head's length. */
size_t png_head_bound(const struct image_attribute *attributes, size_t n_attributes);

/* Writes the head and returns its length. An attribute's name has 1 to 79 bytes. */
size_t png_head_write(const struct strip_layout *layout, bool has_alpha,
                      const struct image_attribute *attributes, size_t n_attributes,
                      uint8_t *bytes);

/* Writes the tail, with the Adler-32 of all strips, and returns its length. */
size_t png_tail_write(uint32_t checksum, uint8_t *bytes);

#endif
