/* The data of a frame whose encoding is RAW or ZSTD: planes of pixels as bytes on the wire.
 *
 * A plane is rows top first, tightly packed, little-endian. RAW is the planes one after the other
 * in the order of their bits. ZSTD cuts every plane into horizontal strips and every strip is one
 * zstd frame of its own, so that threads can share the work:
 *
 *   u32 length[n_strips]     little-endian, in the order of the strips
 *   the strips' zstd frames  back to back in the same order
 *
 * Strips are ordered by plane bit, then from the top; a strip has `rows_per_strip` rows of its
 * plane (the last one what is left). Strips of float and uint32 planes are byte-shuffled before
 * compression: byte 0 of every pixel, then byte 1 of every pixel, and so on. Colour is not.
 *
 * Thread: the layout is read-only once filled in and may be shared; an encoder or a decoder belongs
 * to one thread at a time. Nothing allocates but codec_*_create(). */
#ifndef SHEEN_PROTOCOL_CODEC_H
#define SHEEN_PROTOCOL_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CODEC_PLANES 8         /* bits 0 to 7 of Render.planes */
#define CODEC_ALL_PLANES 0xffu /* all of them */

/* How a frame's planes lie in memory and on the wire. */
struct codec_layout {
    uint32_t width_px, height_px;
    uint32_t planes;    /* bits */
    uint64_t raw_bytes; /* all planes together: the size of RAW data */
    size_t n_strips;
    size_t table_bytes; /* 4 * n_strips */
};

/* One strip: rows [first_row, first_row + rows) of a plane. */
struct codec_strip {
    unsigned plane;       /* its bit's number, 0 to 7 */
    uint32_t pixel_bytes; /* of this plane */
    uint32_t first_row, rows;
    size_t offset_bytes; /* of the strip in its plane */
    size_t raw_bytes;    /* before compression */
};

struct codec_encoder;
struct codec_decoder;

/* Bytes of one pixel of plane number 0 to 7: 4, 12, 12, 12, 8, 8, 16, 4. */
uint32_t codec_pixel_bytes(unsigned plane);

/* False when width or height is not 1 to PROTOCOL_MAX_SIZE_PX, planes is empty or has unknown bits,
 * or the planes together are over PROTOCOL_MAX_FRAME_BYTES (or the address space). */
bool codec_layout_init(struct codec_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t planes);

/* Bytes of one whole plane of this layout. */
size_t codec_plane_bytes(const struct codec_layout *layout, unsigned plane);

/* Strip `index`, below layout->n_strips. */
struct codec_strip codec_strip_at(const struct codec_layout *layout, size_t index);

/* Largest compressed length of a strip: what to allocate for it. */
size_t codec_strip_bound(const struct codec_strip *strip);

/* For strips of frames up to PROTOCOL_MAX_SIZE_PX wide. `level` is zstd's, 1 (fast) to 19.
 * NULL when memory is short. */
struct codec_encoder *codec_encoder_create(int level);
void codec_encoder_destroy(struct codec_encoder *encoder); /* NULL is safe */

/* Compresses one strip of `plane_data` (the whole plane) into `bytes` of codec_strip_bound() bytes
 * and returns its length; 0 only when zstd has no memory or `capacity` is too small. The same input
 * gives the same bytes. */
size_t codec_strip_encode(struct codec_encoder *encoder, const struct codec_strip *strip,
                          const void *plane_data, uint8_t *bytes, size_t capacity);

/* Writes layout->table_bytes bytes: the lengths of all strips in order. */
void codec_table_encode(const struct codec_layout *layout, const uint32_t *lengths, uint8_t *bytes);

struct codec_decoder *codec_decoder_create(void); /* NULL when memory is short */
void codec_decoder_destroy(struct codec_decoder *decoder);

/* Largest sensible size of ZSTD data of this layout; more is a lie. */
uint64_t codec_zstd_bound(const struct codec_layout *layout);

/* Unpacks ZSTD data (table and strips) into planes[0..7] of codec_plane_bytes() each; those of
 * planes the layout lacks are not touched. Every length is checked before use. Returns NULL, or a
 * text that says what is wrong with the data. */
const char *codec_zstd_decode(struct codec_decoder *decoder, const struct codec_layout *layout,
                              const uint8_t *bytes, size_t size, void *const planes[CODEC_PLANES]);

/* The same for RAW data: size must be layout->raw_bytes. */
const char *codec_raw_decode(const struct codec_layout *layout, const uint8_t *bytes, size_t size,
                             void *const planes[CODEC_PLANES]);

#endif
