/* Frames of a few planes. Three bytes give width, height and planes. Then follow either packed data
 * of a server that sends wrong data, or pixels that must be the same after packing and
 * unpacking. */
#include <stdlib.h>
#include <string.h>

#include "protocol/codec.h"
#include "tests/fuzz/fuzz.h"

#define MAX_SIDE_PX 48 /* more takes time and reaches no other code */

static bool allocate(const struct codec_layout *layout, void *planes[CODEC_PLANES])
{
    bool ok = true;
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        if (layout->planes & 1u << plane) {
            planes[plane] = calloc(1, codec_plane_bytes(layout, plane));
            ok &= planes[plane] != NULL;
        }
    return ok;
}

static void release(void *planes[CODEC_PLANES])
{
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        free(planes[plane]);
}

static void decode(const struct codec_layout *layout, const uint8_t *bytes, size_t size,
                   void *const planes[CODEC_PLANES])
{
    struct codec_decoder *decoder = codec_decoder_create();
    if (!decoder)
        return;
    codec_zstd_decode(decoder, layout, bytes, size, planes);
    const char *raw = codec_raw_decode(layout, bytes, size, planes);
    MUST((raw == NULL) == (size == layout->raw_bytes));
    codec_decoder_destroy(decoder);
}

/* The compressed strips of planes, one after the other behind their table; NULL if memory runs
 * out. */
static uint8_t *encode(const struct codec_layout *layout, void *const planes[CODEC_PLANES],
                       size_t *size)
{
    size_t capacity = layout->table_bytes;
    for (size_t i = 0; i < layout->n_strips; i++) {
        struct codec_strip strip = codec_strip_at(layout, i);
        capacity += codec_strip_bound(&strip);
    }
    struct codec_encoder *encoder = codec_encoder_create(1);
    uint32_t *lengths = calloc(layout->n_strips, sizeof *lengths);
    uint8_t *bytes = malloc(capacity);
    bool ok = encoder && lengths && bytes;
    *size = layout->table_bytes;
    for (size_t i = 0; ok && i < layout->n_strips; i++) {
        struct codec_strip strip = codec_strip_at(layout, i);
        lengths[i] = (uint32_t)codec_strip_encode(encoder, &strip, planes[strip.plane],
                                                  bytes + *size, capacity - *size);
        *size += lengths[i];
        ok = lengths[i] > 0;
    }
    if (ok)
        codec_table_encode(layout, lengths, bytes);
    codec_encoder_destroy(encoder);
    free(lengths);
    if (ok)
        return bytes;
    free(bytes);
    return NULL;
}

static void round_trip(const struct codec_layout *layout, const uint8_t *bytes, size_t size,
                       void *const planes[CODEC_PLANES], void *const again[CODEC_PLANES])
{
    for (unsigned plane = 0; plane < CODEC_PLANES; plane++)
        for (size_t i = 0; planes[plane] && size > 0 && i < codec_plane_bytes(layout, plane); i++)
            ((uint8_t *)planes[plane])[i] = bytes[(i * (plane + 1)) % size];
    size_t n;
    uint8_t *packed = encode(layout, planes, &n);
    struct codec_decoder *decoder = codec_decoder_create();
    if (packed && decoder) {
        MUST(n <= codec_zstd_bound(layout));
        const char *wrong = codec_zstd_decode(decoder, layout, packed, n, again);
        MUST(!wrong || fuzz_memory_failed());
        for (unsigned plane = 0; plane < CODEC_PLANES && !wrong; plane++)
            MUST(!planes[plane] ||
                 memcmp(planes[plane], again[plane], codec_plane_bytes(layout, plane)) == 0);
    }
    codec_decoder_destroy(decoder);
    free(packed);
}

void fuzz_one(const uint8_t *bytes, size_t size)
{
    struct codec_layout layout;
    void *planes[CODEC_PLANES] = {NULL}, *again[CODEC_PLANES] = {NULL};
    if (size < 4 ||
        !codec_layout_init(&layout, bytes[0] % MAX_SIDE_PX, bytes[1] % MAX_SIDE_PX, bytes[2]))
        return;
    if (allocate(&layout, planes) && allocate(&layout, again)) {
        if (bytes[3] & 1)
            round_trip(&layout, bytes + 4, size - 4, planes, again);
        else
            decode(&layout, bytes + 4, size - 4, planes);
    }
    release(planes);
    release(again);
}
