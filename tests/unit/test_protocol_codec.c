/* Planes are packed and unpacked again; malformed data is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/limits.h"

struct packed {
    struct codec_layout layout;
    void *planes[CODEC_PLANES];
    uint8_t *bytes;
    size_t size;
};

/* Planes of a picture that compresses, but in which nothing repeats. */
static void fill(uint8_t *bytes, size_t size, unsigned seed)
{
    uint32_t x = seed * 2654435761u + 1;
    for (size_t i = 0; i < size; i++) {
        x ^= x << 13;
        x ^= x >> 17;
        x ^= x << 5;
        bytes[i] = (uint8_t)(i % 4 < 2 ? x & 15 : 7);
    }
}

static void pack(struct packed *packed, uint32_t width, uint32_t height, uint32_t planes)
{
    memset(packed, 0, sizeof(*packed));
    assert_true(codec_layout_init(&packed->layout, width, height, planes));
    for (unsigned i = 0; i < CODEC_PLANES; i++)
        if (planes & 1u << i) {
            size_t size = codec_plane_bytes(&packed->layout, i);
            packed->planes[i] = malloc(size);
            fill(packed->planes[i], size, i + 1);
        }
    size_t n = packed->layout.n_strips;
    uint32_t *lengths = calloc(n, sizeof(*lengths));
    size_t bound = packed->layout.table_bytes;
    for (size_t i = 0; i < n; i++) {
        struct codec_strip strip = codec_strip_at(&packed->layout, i);
        bound += codec_strip_bound(&strip);
    }
    assert_true(bound <= codec_zstd_bound(&packed->layout));
    packed->bytes = malloc(bound);
    packed->size = packed->layout.table_bytes;
    struct codec_encoder *encoder = codec_encoder_create(1);
    assert_non_null(encoder);
    for (size_t i = 0; i < n; i++) {
        struct codec_strip strip = codec_strip_at(&packed->layout, i);
        size_t length = codec_strip_encode(encoder, &strip, packed->planes[strip.plane],
                                           packed->bytes + packed->size, bound - packed->size);
        assert_true(length > 0);
        lengths[i] = (uint32_t)length;
        packed->size += length;
    }
    codec_table_encode(&packed->layout, lengths, packed->bytes);
    codec_encoder_destroy(encoder);
    free(lengths);
}

static void unpack_finish(struct packed *packed)
{
    for (unsigned i = 0; i < CODEC_PLANES; i++)
        free(packed->planes[i]);
    free(packed->bytes);
}

/* Unpacks into planes of exactly the right size, so that a sanitizer finds a byte too many. */
static const char *unpack(const struct packed *packed, const uint8_t *bytes, size_t size,
                          bool compare)
{
    void *planes[CODEC_PLANES] = {NULL};
    for (unsigned i = 0; i < CODEC_PLANES; i++)
        if (packed->planes[i])
            planes[i] = malloc(codec_plane_bytes(&packed->layout, i));
    uint8_t *exact = malloc(size ? size : 1);
    memcpy(exact, bytes, size);
    struct codec_decoder *decoder = codec_decoder_create();
    const char *wrong = codec_zstd_decode(decoder, &packed->layout, exact, size, planes);
    for (unsigned i = 0; i < CODEC_PLANES; i++) {
        if (compare && planes[i])
            assert_memory_equal(planes[i], packed->planes[i],
                                codec_plane_bytes(&packed->layout, i));
        free(planes[i]);
    }
    codec_decoder_destroy(decoder);
    free(exact);
    return wrong;
}

static void zstd_round_trip(void **state)
{
    (void)state;
    static const uint32_t cases[][3] = {{1, 1, 1},
                                        {2, 1, CODEC_ALL_PLANES},
                                        {641, 479, CODEC_ALL_PLANES},
                                        {1280, 720, 1},
                                        {65536, 2, 2},
                                        {3, 50000, 32}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct packed packed;
        pack(&packed, cases[i][0], cases[i][1], cases[i][2]);
        assert_null(unpack(&packed, packed.bytes, packed.size, true));
        unpack_finish(&packed);
    }
}

static void strips_cover_every_row_once(void **state)
{
    (void)state;
    struct codec_layout layout;
    assert_true(codec_layout_init(&layout, 1920, 1080, CODEC_ALL_PLANES));
    size_t next[CODEC_PLANES] = {0};
    unsigned last = 0;
    for (size_t i = 0; i < layout.n_strips; i++) {
        struct codec_strip strip = codec_strip_at(&layout, i);
        assert_true(strip.plane >= last);
        last = strip.plane;
        assert_int_equal(strip.pixel_bytes, codec_pixel_bytes(strip.plane));
        assert_int_equal(strip.offset_bytes, next[strip.plane]);
        assert_int_equal(strip.raw_bytes, (size_t)strip.rows * 1920 * strip.pixel_bytes);
        assert_true(strip.raw_bytes <= PROTOCOL_STRIP_BYTES);
        next[strip.plane] += strip.raw_bytes;
    }
    for (unsigned i = 0; i < CODEC_PLANES; i++)
        assert_int_equal(next[i], codec_plane_bytes(&layout, i));
    assert_int_equal(layout.raw_bytes, 1920ull * 1080 * 76);
}

static void layouts_are_bounded(void **state)
{
    (void)state;
    struct codec_layout layout;
    assert_false(codec_layout_init(&layout, 0, 1, 1));
    assert_false(codec_layout_init(&layout, 1, 0, 1));
    assert_false(codec_layout_init(&layout, 1, 1, 0));
    assert_false(codec_layout_init(&layout, 1, 1, CODEC_ALL_PLANES + 1));
    assert_false(codec_layout_init(&layout, 65537, 1, 1));
    assert_false(codec_layout_init(&layout, 1, UINT32_MAX, 1));
    assert_false(codec_layout_init(&layout, 65536, 65536, 63));
    assert_true(codec_layout_init(&layout, 16384, 16384, 1));
    assert_true(codec_layout_init(&layout, 65536, 16384, 1)); /* exactly 4 GiB */
    assert_false(codec_layout_init(&layout, 65536, 16385, 1));
}

static void set_length(uint8_t *bytes, size_t strip, uint32_t length)
{
    for (int i = 0; i < 4; i++)
        bytes[4 * strip + i] = (uint8_t)(length >> (8 * i));
}

static void lengths_that_lie_are_refused(void **state)
{
    (void)state;
    struct packed packed;
    pack(&packed, 640, 480, 1 | 8);
    assert_true(packed.layout.n_strips >= 4);
    uint8_t *copy = malloc(packed.size + 1);
    uint32_t first, second;
    memcpy(&first, packed.bytes, 4);
    memcpy(&second, packed.bytes + 4, 4);
    const uint32_t lies[] = {
        0,           1,          first - 1, first + 1, first + second, (uint32_t)packed.size,
        0x80000000u, UINT32_MAX, 0u - first};
    for (size_t i = 0; i < sizeof(lies) / sizeof(*lies); i++) {
        memcpy(copy, packed.bytes, packed.size);
        set_length(copy, 0, lies[i]);
        assert_non_null(unpack(&packed, copy, packed.size, false));
    }
    /* Two zstd frames in the place of one strip. */
    memcpy(copy, packed.bytes, packed.size);
    set_length(copy, 0, first + second);
    set_length(copy, 1, 0);
    assert_non_null(unpack(&packed, copy, packed.size, false));
    /* One byte more than the table's lengths add up to. */
    memcpy(copy, packed.bytes, packed.size);
    copy[packed.size] = 0;
    assert_non_null(unpack(&packed, copy, packed.size + 1, false));
    free(copy);
    unpack_finish(&packed);
}

static void truncated_data_is_refused(void **state)
{
    (void)state;
    struct packed packed;
    pack(&packed, 5, 3, 1 | 2);
    for (size_t size = 0; size < packed.size; size++)
        assert_non_null(unpack(&packed, packed.bytes, size, false));
    assert_null(unpack(&packed, packed.bytes, packed.size, true));
    unpack_finish(&packed);
}

static void damaged_strips_are_refused(void **state)
{
    (void)state;
    struct packed packed;
    pack(&packed, 16, 16, 4);
    for (size_t i = packed.layout.table_bytes; i < packed.size; i++) {
        packed.bytes[i] ^= 0x10;
        const char *wrong = unpack(&packed, packed.bytes, packed.size, false);
        packed.bytes[i] ^= 0x10;
        if (!wrong) /* a change in a bit that zstd ignores must not change a pixel */
            assert_null(unpack(&packed, packed.bytes, packed.size, true));
    }
    unpack_finish(&packed);
}

static void strips_of_another_size_are_refused(void **state)
{
    (void)state;
    struct packed small, large;
    pack(&small, 16, 15, 1);
    pack(&large, 16, 17, 1);
    assert_non_null(unpack(&large, small.bytes, small.size, false));
    assert_non_null(unpack(&small, large.bytes, large.size, false));
    unpack_finish(&small);
    unpack_finish(&large);
}

static void raw_data(void **state)
{
    (void)state;
    struct codec_layout layout;
    uint8_t bytes[24], colour[8], light[16];
    void *const planes[CODEC_PLANES] = {[0] = colour, [4] = light};
    fill(bytes, sizeof(bytes), 1);
    assert_true(codec_layout_init(&layout, 2, 1, 1 | 16));
    assert_null(codec_raw_decode(&layout, bytes, 24, planes));
    assert_memory_equal(colour, bytes, 8);
    assert_memory_equal(light, bytes + 8, 16);
    assert_non_null(codec_raw_decode(&layout, bytes, 23, planes));
    assert_non_null(codec_raw_decode(&layout, bytes, 25, planes));
}

static void an_encoder_stays_within_its_buffer(void **state)
{
    (void)state;
    struct codec_layout layout;
    uint8_t plane[64 * 64 * 4], bytes[sizeof(plane) + 200];
    assert_true(codec_layout_init(&layout, 64, 64, 1));
    fill(plane, sizeof(plane), 3);
    struct codec_strip strip = codec_strip_at(&layout, 0);
    struct codec_encoder *encoder = codec_encoder_create(1);
    assert_int_equal(codec_strip_encode(encoder, &strip, plane, bytes, 100), 0);
    size_t length = codec_strip_encode(encoder, &strip, plane, bytes, sizeof(bytes));
    assert_true(length > 100);
    uint8_t again[sizeof(bytes)];
    assert_int_equal(codec_strip_encode(encoder, &strip, plane, again, sizeof(again)), length);
    assert_memory_equal(bytes, again, length);
    codec_encoder_destroy(encoder);
    codec_encoder_destroy(NULL);
    codec_decoder_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zstd_round_trip),
        cmocka_unit_test(strips_cover_every_row_once),
        cmocka_unit_test(layouts_are_bounded),
        cmocka_unit_test(lengths_that_lie_are_refused),
        cmocka_unit_test(truncated_data_is_refused),
        cmocka_unit_test(damaged_strips_are_refused),
        cmocka_unit_test(strips_of_another_size_are_refused),
        cmocka_unit_test(raw_data),
        cmocka_unit_test(an_encoder_stays_within_its_buffer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
