#include "protocol/codec.h"

#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "protocol/limits.h"
#include "protocol/ranges.h"

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "planes travel as they lie in memory: sheen runs on little-endian machines"
#endif

#define MAX_PIXEL_BYTES 12u
/* One row of the widest plane may be larger than a usual strip. */
#define MAX_ROW_BYTES (PROTOCOL_MAX_SIZE_PX * MAX_PIXEL_BYTES)
#define MAX_STRIP_BYTES                                                                            \
    (MAX_ROW_BYTES > PROTOCOL_STRIP_BYTES ? MAX_ROW_BYTES : PROTOCOL_STRIP_BYTES)

struct codec_encoder {
    ZSTD_CCtx *zstd;
    uint8_t *shuffled; /* MAX_STRIP_BYTES */
};

struct codec_decoder {
    ZSTD_DCtx *zstd;
    uint8_t *shuffled; /* MAX_STRIP_BYTES */
};

uint32_t codec_pixel_bytes(unsigned plane)
{
    static const uint8_t bytes[CODEC_PLANES] = {4, 12, 12, 12, 8, 8, 16, 4};
    return bytes[plane];
}

static uint32_t rows_per_strip(const struct codec_layout *layout, unsigned plane)
{
    uint32_t row_bytes = layout->width_px * codec_pixel_bytes(plane);
    uint32_t rows = PROTOCOL_STRIP_BYTES / row_bytes;
    return rows > 0 ? rows : 1;
}

static size_t strips_of_plane(const struct codec_layout *layout, unsigned plane)
{
    uint32_t rows = rows_per_strip(layout, plane);
    return (layout->height_px + rows - 1) / rows;
}

bool codec_layout_init(struct codec_layout *layout, uint32_t width_px, uint32_t height_px,
                       uint32_t planes)
{
    if (!range_holds(&RANGES[RANGE_SIDE], width_px) ||
        !range_holds(&RANGES[RANGE_SIDE], height_px) || planes == 0 || planes & ~CODEC_ALL_PLANES)
        return false;
    *layout = (struct codec_layout){.width_px = width_px, .height_px = height_px, .planes = planes};
    /* Width and height are at most 2^16, and a pixel's planes below 2^7 bytes: 64 bits cannot
     * overflow. */
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        if (planes & 1u << plane) {
            layout->raw_bytes += (uint64_t)width_px * height_px * codec_pixel_bytes(plane);
            layout->n_strips += strips_of_plane(layout, plane);
        }
    layout->table_bytes = 4 * layout->n_strips;
    return layout->raw_bytes <= PROTOCOL_MAX_FRAME_BYTES && layout->raw_bytes <= SIZE_MAX / 2;
}

size_t codec_plane_bytes(const struct codec_layout *layout, unsigned plane)
{
    return (size_t)layout->width_px * layout->height_px * codec_pixel_bytes(plane);
}

struct codec_strip codec_strip_at(const struct codec_layout *layout, size_t index)
{
    unsigned plane = 0;
    for (;; plane++) {
        if (!(layout->planes & 1u << plane))
            continue;
        size_t n = strips_of_plane(layout, plane);
        if (index < n)
            break;
        index -= n;
    }
    uint32_t rows = rows_per_strip(layout, plane);
    uint32_t first = (uint32_t)index * rows;
    uint32_t left = layout->height_px - first;
    size_t row_bytes = (size_t)layout->width_px * codec_pixel_bytes(plane);
    uint32_t n_rows = left < rows ? left : rows;
    return (struct codec_strip){
        .plane = plane,
        .pixel_bytes = codec_pixel_bytes(plane),
        .first_row = first,
        .rows = n_rows,
        .offset_bytes = first * row_bytes,
        .raw_bytes = n_rows * row_bytes,
    };
}

size_t codec_strip_bound(const struct codec_strip *strip)
{
    return ZSTD_compressBound(strip->raw_bytes);
}

uint64_t codec_zstd_bound(const struct codec_layout *layout)
{
    /* compressBound() adds at most 1/256 and 64 bytes, which includes the checksum. */
    return layout->table_bytes + layout->raw_bytes + layout->raw_bytes / 256 +
           (uint64_t)layout->n_strips * 128;
}

static bool is_shuffled(unsigned plane)
{
    return plane != 0; /* colour compresses better unshuffled */
}

struct codec_encoder *codec_encoder_create(int level)
{
    struct codec_encoder *encoder = calloc(1, sizeof(*encoder));
    if (!encoder)
        return NULL;
    encoder->zstd = ZSTD_createCCtx();
    encoder->shuffled = malloc(MAX_STRIP_BYTES);
    if (!encoder->zstd || !encoder->shuffled ||
        ZSTD_isError(ZSTD_CCtx_setParameter(encoder->zstd, ZSTD_c_compressionLevel, level)) ||
        ZSTD_isError(ZSTD_CCtx_setParameter(encoder->zstd, ZSTD_c_checksumFlag, 1))) {
        codec_encoder_destroy(encoder);
        return NULL;
    }
    return encoder;
}

void codec_encoder_destroy(struct codec_encoder *encoder)
{
    if (!encoder)
        return;
    ZSTD_freeCCtx(encoder->zstd);
    free(encoder->shuffled);
    free(encoder);
}

size_t codec_strip_encode(struct codec_encoder *encoder, const struct codec_strip *strip,
                          const void *plane_data, uint8_t *bytes, size_t capacity)
{
    const uint8_t *raw = (const uint8_t *)plane_data + strip->offset_bytes;
    if (is_shuffled(strip->plane)) {
        size_t n_pixels = strip->raw_bytes / strip->pixel_bytes;
        for (size_t i = 0; i < n_pixels; i++)
            for (size_t byte = 0; byte < strip->pixel_bytes; byte++)
                encoder->shuffled[byte * n_pixels + i] = raw[i * strip->pixel_bytes + byte];
        raw = encoder->shuffled;
    }
    size_t length = ZSTD_compress2(encoder->zstd, bytes, capacity, raw, strip->raw_bytes);
    return ZSTD_isError(length) ? 0 : length;
}

void codec_table_encode(const struct codec_layout *layout, const uint32_t *lengths, uint8_t *bytes)
{
    memcpy(bytes, lengths, layout->table_bytes);
}

struct codec_decoder *codec_decoder_create(void)
{
    struct codec_decoder *decoder = calloc(1, sizeof(*decoder));
    if (!decoder)
        return NULL;
    decoder->zstd = ZSTD_createDCtx();
    decoder->shuffled = malloc(MAX_STRIP_BYTES);
    if (!decoder->zstd || !decoder->shuffled) {
        codec_decoder_destroy(decoder);
        return NULL;
    }
    return decoder;
}

void codec_decoder_destroy(struct codec_decoder *decoder)
{
    if (!decoder)
        return;
    ZSTD_freeDCtx(decoder->zstd);
    free(decoder->shuffled);
    free(decoder);
}

static const char *decode_strip(struct codec_decoder *decoder, const struct codec_strip *strip,
                                const uint8_t *bytes, size_t length, uint8_t *plane)
{
    if (ZSTD_getFrameContentSize(bytes, length) != strip->raw_bytes)
        return "a strip does not announce its own size";
    if (ZSTD_findFrameCompressedSize(bytes, length) != length)
        return "a strip is not one zstd frame of the length in the table";
    uint8_t *raw = plane + strip->offset_bytes;
    uint8_t *target = is_shuffled(strip->plane) ? decoder->shuffled : raw;
    if (ZSTD_decompressDCtx(decoder->zstd, target, strip->raw_bytes, bytes, length) !=
        strip->raw_bytes)
        return "a strip is damaged";
    if (target != raw) {
        size_t n_pixels = strip->raw_bytes / strip->pixel_bytes;
        for (size_t i = 0; i < n_pixels; i++)
            for (size_t byte = 0; byte < strip->pixel_bytes; byte++)
                raw[i * strip->pixel_bytes + byte] = target[byte * n_pixels + i];
    }
    return NULL;
}

const char *codec_zstd_decode(struct codec_decoder *decoder, const struct codec_layout *layout,
                              const uint8_t *bytes, size_t size, void *const planes[CODEC_PLANES])
{
    if (size < layout->table_bytes)
        return "the data ends within the table of strip lengths";
    size_t position = layout->table_bytes;
    for (size_t i = 0; i < layout->n_strips; i++) {
        uint32_t length;
        memcpy(&length, bytes + 4 * i, sizeof(length));
        if (length > size - position)
            return "the table of strip lengths goes past the end of the data";
        const struct codec_strip strip = codec_strip_at(layout, i);
        const char *wrong =
            decode_strip(decoder, &strip, bytes + position, length, planes[strip.plane]);
        if (wrong)
            return wrong;
        position += length;
    }
    return position == size ? NULL : "bytes are left over after the last strip";
}

const char *codec_raw_decode(const struct codec_layout *layout, const uint8_t *bytes, size_t size,
                             void *const planes[CODEC_PLANES])
{
    if (size != layout->raw_bytes)
        return "the data is not as long as its planes";
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++) {
        if (!(layout->planes & 1u << plane))
            continue;
        size_t n = codec_plane_bytes(layout, plane);
        memcpy(planes[plane], bytes, n);
        bytes += n;
    }
    return NULL;
}
