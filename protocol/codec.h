/* The data of a frame with encoding RAW or ZSTD: pixel planes as bytes in the protocol.
 *
 * A plane consists of rows, top row first, contiguous and little-endian. RAW data is the planes one
 * after another, in the order of their bits. ZSTD divides each plane into horizontal strips, each
 * of which is a zstd frame of its own, so that several threads can share the work:
 *
 *   u32 length[n_strips]   little-endian, in the order of the strips
 *   zstd frames            one for each strip, in the same order, without gaps
 *
 * Strips are ordered by plane, then from the top. Every strip of a plane has the same number of
 * rows, except that the last has the rest. Strips of float and uint32 planes are byte-shuffled
 * before compression: byte 0 of every pixel, then byte 1 of every pixel, and so on. The colour
 * plane is not.
 *
 * Thread: a layout is read-only once filled in, and may be shared; an encoder or decoder is used by
 * one thread at a time. Only codec_*_create() allocates. */
#ifndef SHEEN_PROTOCOL_CODEC_H
#define SHEEN_PROTOCOL_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CODEC_PLANES 8         /* bits 0 to 7 of Render.planes */
#define CODEC_ALL_PLANES 0xffu /* all of them */

/* The layout of a frame's planes in memory and in the protocol. */
struct codec_layout {
    uint32_t width_px, height_px;
    uint32_t planes;    /* one bit for each plane */
    uint64_t raw_bytes; /* all planes together: the size of RAW data */
    size_t n_strips;
    size_t table_bytes; /* 4 * n_strips */
};

/* One strip: rows [first_row, first_row + rows) of a plane. */
struct codec_strip {
    unsigned plane;       /* number of the plane's bit, 0 to 7 */
    uint32_t pixel_bytes; /* bytes of a pixel of this plane */
    uint32_t first_row, rows;
    size_t offset_bytes; /* offset of the strip in its plane */
    size_t raw_bytes;    /* before compression */
};

struct codec_encoder;
struct codec_decoder;

/* Bytes of one pixel of plane 0 to 7: 4, 12, 12, 12, 8, 8, 16, 4. */
uint32_t codec_pixel_bytes(unsigned plane);

/* Fills in a layout. False if width or height is not from 1 to PROTOCOL_MAX_SIZE_PX, if `planes` is
 * 0 or has unknown bits, or if the planes together exceed PROTOCOL_MAX_FRAME_BYTES or the address
 * space. */
bool codec_layout_init(struct codec_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t planes);

/* Bytes of one whole plane. */
size_t codec_plane_bytes(const struct codec_layout *layout, unsigned plane);

/* Describes strip `index`, which must be below layout->n_strips. */
struct codec_strip codec_strip_at(const struct codec_layout *layout, size_t index);

/* The largest compressed length of a strip, in bytes: the buffer to allocate for it. */
size_t codec_strip_bound(const struct codec_strip *strip);

/* Makes an encoder for frames of any allowed size. `level` is zstd's compression level, 1 (fast) to
 * 19. NULL when memory is short. */
struct codec_encoder *codec_encoder_create(int level);
void codec_encoder_destroy(struct codec_encoder *encoder); /* NULL is safe */

/* Compresses one strip of `plane_data`, the whole plane, into `bytes`, which has room for
 * codec_strip_bound() bytes (`capacity`), and returns the length. 0 only if zstd has no memory or
 * `capacity` is too small. The same input gives the same bytes. */
size_t codec_strip_encode(struct codec_encoder *encoder, const struct codec_strip *strip,
                          const void *plane_data, uint8_t *bytes, size_t capacity);

/* Writes the table of a ZSTD frame, layout->table_bytes bytes: the lengths of all strips in
 * order. */
void codec_table_encode(const struct codec_layout *layout, const uint32_t *lengths, uint8_t *bytes);

struct codec_decoder *codec_decoder_create(void); /* NULL when memory is short */
void codec_decoder_destroy(struct codec_decoder *decoder);

/* The largest possible size of ZSTD data with this layout, in bytes; refuse more. */
uint64_t codec_zstd_bound(const struct codec_layout *layout);

/* Decodes ZSTD data (table and strips) into planes[0] to planes[7], of codec_plane_bytes() bytes
 * each. Entries for planes that the layout does not have are not used. Every length is checked
 * before use. Returns NULL, or a text that says what is wrong with the data. */
const char *codec_zstd_decode(struct codec_decoder *decoder, const struct codec_layout *layout,
                              const uint8_t *bytes, size_t size, void *const planes[CODEC_PLANES]);

/* As codec_zstd_decode(), for RAW data. `size` must be layout->raw_bytes. */
const char *codec_raw_decode(const struct codec_layout *layout, const uint8_t *bytes, size_t size,
                             void *const planes[CODEC_PLANES]);

#endif
