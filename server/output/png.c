#include "server/output/png.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define RGBA_BYTES 4
#define RGB_BYTES 3

/* A chunk: the length of its data, its type, the data, a CRC of type and data. */
#define CHUNK_HEAD_BYTES 8
#define CHUNK_BYTES (CHUNK_HEAD_BYTES + 4)
#define SIGNATURE_BYTES 8
#define IHDR_BYTES 13
#define SRGB_BYTES 1
#define CHECKSUM_BYTES 4
#define TAIL_BYTES (CHUNK_BYTES + CHECKSUM_BYTES + CHUNK_BYTES)
#define STREAM_HEAD_BYTES 2 /* of zlib */
/* an empty block that compressBound() does not count, and some to spare */
#define FLUSH_BYTES 16

/* Raw deflate with the library's own window and memory. */
#define WINDOW_BITS (-15)
#define MEMORY_LEVEL 8

/* How rows are stored: unchanged, or as the difference of each byte to that of the pixel to its
 * left. */
enum filter { FILTER_NONE = 0, FILTER_SUB = 1 };

/* How long zlib searches for an earlier place with the same bytes; the members are deflateTune()'s
 * arguments. Measured on pictures of 1280x720 without alpha, relative to OpenImageIO's files (SUB,
 * level 4, with alpha): pictures of lines in two colours take 0.58 to 0.98 of the size with NONE at
 * level 1, and more with SUB. Pictures of smooth colours take 0.94 to 1.03 of the size with SUB and
 * the search below. At level 1 they take up to 1.25 of the size, and with runs of one byte alone
 * (Z_RLE) up to 1.20. A search as short that looks for a longer repetition at the next byte (lazy) is
 * what they gain by: with 8 for lazy and twice the chain they took 1 to 5 % more bytes and 15 % more
 * time. A file of 26 KB took 1.23: each strip begins anew. */
#define LEVEL 1
struct search {
    int good, lazy, nice, chain;
};
static const struct search SEARCHES[] = {
    [FILTER_NONE] = {4, 4, 8, 4}, /* zlib's own at level 1 */
    [FILTER_SUB] = {4, 32, 32, 4},
};

/* The filter of a strip is chosen by this many rows in its middle. */
#define SAMPLE_ROWS 4

struct png_encoder {
    z_stream stream;
};

struct png_encoder *png_encoder_create(void)
{
    struct png_encoder *encoder = calloc(1, sizeof *encoder);
    if (encoder && deflateInit2(&encoder->stream, LEVEL, Z_DEFLATED, WINDOW_BITS, MEMORY_LEVEL,
                                Z_DEFAULT_STRATEGY) != Z_OK) {
        free(encoder);
        encoder = NULL;
    }
    return encoder;
}

void png_encoder_destroy(struct png_encoder *encoder)
{
    if (!encoder)
        return;
    deflateEnd(&encoder->stream);
    free(encoder);
}

static size_t channels(bool has_alpha)
{
    return has_alpha ? RGBA_BYTES : RGB_BYTES;
}

static size_t stored_row_bytes(const struct strip_layout *layout, bool has_alpha)
{
    return 1 + channels(has_alpha) * layout->width_px; /* the filter's number comes first */
}

void png_layout_init(struct strip_layout *layout, uint32_t width_px, uint32_t height_px)
{
    strip_layout_init(layout, width_px, height_px, 1);
    layout->bound = STREAM_HEAD_BYTES + CHUNK_BYTES + TAIL_BYTES + FLUSH_BYTES +
                    compressBound(strip_rows(layout, 0) * stored_row_bytes(layout, true));
}

bool png_strip_is_opaque(const struct strip_layout *layout, size_t index, const uint8_t *rgba)
{
    const uint8_t *pixels = strip_pixels(layout, index, rgba);
    const size_t row_bytes = (size_t)RGBA_BYTES * layout->width_px;
    for (uint32_t y = 0; y < strip_rows(layout, index); y++, pixels += row_bytes) {
        unsigned all = 0xff;
        for (size_t i = RGBA_BYTES - 1; i < row_bytes; i += RGBA_BYTES)
            all &= pixels[i];
        if (all != 0xff)
            return false;
    }
    return true;
}

/* --- rows */

size_t png_row_bytes(const struct strip_layout *layout)
{
    return stored_row_bytes(layout, true);
}

/* Subtracts four bytes from four others, each by itself (modulo 256). */
static uint32_t subtract_bytes(uint32_t a, uint32_t b)
{
    const uint32_t high = 0x80808080u;
    return ((a | high) - (b & ~high)) ^ ((a ^ ~b) & high);
}

/* Writes a row as it is stored. Without alpha the next pixel overwrites the fourth byte of each
 * pixel; the fourth byte of the last pixel falls into the room that a row with alpha needs. */
static void store_row(uint8_t *row, const uint8_t *rgba, uint32_t width_px, bool has_alpha,
                      enum filter filter)
{
    const size_t step = channels(has_alpha);
    const uint32_t left_counts = filter == FILTER_SUB ? UINT32_MAX : 0;
    uint32_t left = 0;
    *row++ = (uint8_t)filter;
    if (has_alpha && filter == FILTER_NONE) {
        memcpy(row, rgba, (size_t)RGBA_BYTES * width_px);
        return;
    }
    for (uint32_t x = 0; x < width_px; x++, row += step) {
        uint32_t pixel;
        memcpy(&pixel, rgba + (size_t)RGBA_BYTES * x, sizeof pixel);
        const uint32_t stored = subtract_bytes(pixel, left & left_counts);
        memcpy(row, &stored, sizeof stored);
        left = pixel;
    }
}

/* Deflates rows of a picture as a stream of their own. True if all of it fits the stream's
 * output. */
static bool deflate_rows(z_stream *stream, const struct strip_layout *layout, const uint8_t *rgba,
                         uint32_t n_rows, bool has_alpha, enum filter filter,
                         const struct search *search, int flush, uint8_t *row, uint32_t *checksum)
{
    const size_t row_bytes = stored_row_bytes(layout, has_alpha);
    *checksum = (uint32_t)adler32(0, NULL, 0);
    if (deflateReset(stream) != Z_OK || /* before, since it sets the level's search */
        deflateTune(stream, search->good, search->lazy, search->nice, search->chain) != Z_OK)
        return false;
    for (uint32_t y = 0; y < n_rows; y++, rgba += (size_t)RGBA_BYTES * layout->width_px) {
        const int how = y + 1 < n_rows ? Z_NO_FLUSH : flush;
        store_row(row, rgba, layout->width_px, has_alpha, filter);
        *checksum = (uint32_t)adler32(*checksum, row, (uInt)row_bytes);
        stream->next_in = row;
        stream->avail_in = (uInt)row_bytes;
        if (deflate(stream, how) != (how == Z_FINISH ? Z_STREAM_END : Z_OK) ||
            stream->avail_in > 0 || stream->avail_out == 0)
            return false;
    }
    return true;
}

/* --- strips */

static uint8_t *put_u32(uint8_t *bytes, size_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> (24 - 8 * i));
    return bytes + 4;
}

/* Completes a chunk whose data already stand at `bytes` + CHUNK_HEAD_BYTES. Returns the chunk's
 * end. */
static uint8_t *close_chunk(uint8_t *bytes, const char type[4], size_t size)
{
    put_u32(bytes, size);
    memcpy(bytes + 4, type, 4);
    return put_u32(bytes + CHUNK_HEAD_BYTES + size,
                   crc32(crc32(0, NULL, 0), bytes + 4, (uInt)(4 + size)));
}

/* Chooses the filter with which a sample of the strip becomes smaller by the shorter search. `bytes` is scratch
 * memory. */
static bool choose_filter(z_stream *stream, const struct strip_layout *layout, const uint8_t *rgba,
                          uint32_t n_rows, bool has_alpha, uint8_t *row, uint8_t *bytes,
                          size_t room, enum filter *filter)
{
    const uint32_t n = n_rows < SAMPLE_ROWS ? n_rows : SAMPLE_ROWS;
    const uint8_t *middle = rgba + (size_t)RGBA_BYTES * layout->width_px * ((n_rows - n) / 2);
    size_t sizes[2];
    uint32_t ignored;
    for (int f = FILTER_NONE; f <= FILTER_SUB; f++) {
        stream->next_out = bytes;
        stream->avail_out = (uInt)room;
        if (!deflate_rows(stream, layout, middle, n, has_alpha, (enum filter)f,
                          &SEARCHES[FILTER_NONE], Z_SYNC_FLUSH, row, &ignored))
            return false;
        sizes[f] = stream->total_out;
    }
    *filter = sizes[FILTER_SUB] < sizes[FILTER_NONE] ? FILTER_SUB : FILTER_NONE;
    return true;
}

bool png_strip_encode(struct png_encoder *encoder, const struct strip_layout *layout, size_t index,
                      const uint8_t *rgba, bool has_alpha, uint8_t *row, uint8_t *bytes,
                      struct png_strip *strip, struct error *error)
{
    static const uint8_t stream_head[STREAM_HEAD_BYTES] = {0x78, 0x01}; /* window, fast */
    z_stream *stream = &encoder->stream;
    const uint8_t *pixels = strip_pixels(layout, index, rgba);
    const uint32_t n_rows = strip_rows(layout, index);
    const int flush = index + 1 < layout->n ? Z_SYNC_FLUSH : Z_FINISH;
    uint8_t *data = bytes + CHUNK_HEAD_BYTES, *end = data;
    enum filter filter;
    if (index == 0)
        end = mempcpy(data, stream_head, sizeof stream_head);
    const size_t room = layout->bound - CHUNK_BYTES - TAIL_BYTES - (size_t)(end - data);
    if (choose_filter(stream, layout, pixels, n_rows, has_alpha, row, end, room, &filter)) {
        stream->next_out = end;
        stream->avail_out = (uInt)room;
        if (deflate_rows(stream, layout, pixels, n_rows, has_alpha, filter, &SEARCHES[filter],
                         flush, row, &strip->checksum)) {
            end += stream->total_out;
            strip->size = (size_t)(close_chunk(bytes, "IDAT", (size_t)(end - data)) - bytes);
            return true;
        }
    }
    return error_set(error, ERROR_SERVER,
                     "a PNG file of %u x %u pixels cannot be written: zlib failed: try again later",
                     layout->width_px, layout->height_px);
}

uint32_t png_checksum(uint32_t before, const struct strip_layout *layout, size_t index,
                      bool has_alpha, uint32_t strip)
{
    const size_t bytes = strip_rows(layout, index) * stored_row_bytes(layout, has_alpha);
    return (uint32_t)adler32_combine(before, strip, (z_off_t)bytes);
}

/* --- head and tail */

size_t png_head_bound(const struct image_attribute *attributes, size_t n_attributes)
{
    size_t bytes = SIGNATURE_BYTES + CHUNK_BYTES + IHDR_BYTES + CHUNK_BYTES + SRGB_BYTES;
    for (size_t i = 0; i < n_attributes; i++)
        bytes += CHUNK_BYTES + strlen(attributes[i].name) + 1 + strlen(attributes[i].value);
    return strip_head_bound(bytes);
}

/* tEXt: the name, a 0, and the value without a 0. */
static uint8_t *write_text(uint8_t *at, const struct image_attribute *attribute)
{
    const size_t name = strlen(attribute->name) + 1, value = strlen(attribute->value);
    memcpy(at + CHUNK_HEAD_BYTES, attribute->name, name);
    memcpy(at + CHUNK_HEAD_BYTES + name, attribute->value, value);
    return close_chunk(at, "tEXt", name + value);
}

size_t png_head_write(const struct strip_layout *layout, bool has_alpha,
                      const struct image_attribute *attributes, size_t n_attributes, uint8_t *bytes)
{
    static const uint8_t signature[SIGNATURE_BYTES] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    uint8_t *at = mempcpy(bytes, signature, sizeof signature);
    uint8_t *data = put_u32(put_u32(at + CHUNK_HEAD_BYTES, layout->width_px), layout->height_px);
    data[0] = 8;                 /* bits */
    data[1] = has_alpha ? 6 : 2; /* the kind of colour */
    memset(data + 2, 0, 3);      /* deflate, the five filters, no interlacing */
    at = close_chunk(at, "IHDR", IHDR_BYTES);
    at[CHUNK_HEAD_BYTES] = 0; /* perceptual rendering */
    at = close_chunk(at, "sRGB", SRGB_BYTES);
    for (size_t i = 0; i < n_attributes; i++)
        at = write_text(at, &attributes[i]);
    return (size_t)(at - bytes);
}

size_t png_tail_write(uint32_t checksum, uint8_t *bytes)
{
    put_u32(bytes + CHUNK_HEAD_BYTES, checksum);
    uint8_t *at = close_chunk(bytes, "IDAT", CHECKSUM_BYTES);
    return (size_t)(close_chunk(at, "IEND", 0) - bytes);
}
