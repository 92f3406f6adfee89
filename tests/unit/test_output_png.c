/* PNG files of frames: libpng reads all pixels and texts, zlib the whole stream, and checksums are
 * computed again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <png.h>
#include <zlib.h>

#include "tests/unit/encoders_at_once.h"
#include "tests/unit/png_file.h"

static const struct image_attribute METADATA[] = {
    {"sheen:version", "1.2.3"},
    {"sheen:camera", "eye=1,2,3 fov=35"},
    {"sheen:show", ""},
};
#define N_METADATA (sizeof METADATA / sizeof *METADATA)

static struct png_encoder *encoder;

static int setup(void **state)
{
    (void)state;
    encoder = png_encoder_create();
    return encoder ? 0 : -1;
}

static int teardown(void **state)
{
    (void)state;
    png_encoder_destroy(encoder);
    png_encoder_destroy(NULL);
    return 0;
}

/* --- pictures */

static uint32_t random_state = 1;

static uint32_t random_bits(void)
{
    random_state ^= random_state << 13;
    random_state ^= random_state >> 17;
    random_state ^= random_state << 5;
    return random_state;
}

typedef void painter(uint32_t x, uint32_t y, uint8_t rgba[4]);

static void paint_flat(uint32_t x, uint32_t y, uint8_t rgba[4])
{
    (void)x;
    (void)y;
    memcpy(rgba, "\x20\x80\xf0", 3);
}

static void paint_stripes(uint32_t x, uint32_t y, uint8_t rgba[4])
{
    memset(rgba, (x * x + y * y) / 2000 % 2 ? 255 : 0, 3);
}

static void paint_smooth(uint32_t x, uint32_t y, uint8_t rgba[4])
{
    rgba[0] = (uint8_t)(x / 3 + y / 5);
    rgba[1] = (uint8_t)(x / 5 + y / 7);
    rgba[2] = (uint8_t)(255 - x / 4);
}

static void paint_noise(uint32_t x, uint32_t y, uint8_t rgba[4])
{
    (void)x;
    (void)y;
    uint32_t n = random_bits();
    memcpy(rgba, &n, 4);
}

static painter *const PAINTERS[] = {paint_flat, paint_stripes, paint_smooth, paint_noise};
enum { N_PAINTERS = sizeof PAINTERS / sizeof *PAINTERS };

static uint8_t *make_picture(painter *paint, uint32_t width, uint32_t height, bool is_opaque)
{
    uint8_t *rgba = malloc((size_t)4 * width * height);
    assert_non_null(rgba);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint8_t *pixel = rgba + 4 * ((size_t)y * width + x);
            pixel[3] = (uint8_t)(y / 2);
            paint(x, y, pixel);
            if (is_opaque)
                pixel[3] = 255;
        }
    if (!is_opaque)
        rgba[4 * (random_bits() % ((size_t)width * height)) + 3] = 254;
    return rgba;
}

/* --- libpng */

struct reader {
    const uint8_t *at;
    size_t left;
    png_structp png;
    png_infop info;
};

static void refuse(png_structp png, png_const_charp text)
{
    (void)png;
    fail_msg("libpng: %s", text); /* warnings count as errors */
}

static void read_bytes(png_structp png, png_bytep bytes, size_t n)
{
    struct reader *reader = png_get_io_ptr(png);
    assert_true(n <= reader->left);
    memcpy(bytes, reader->at, n);
    reader->at += n;
    reader->left -= n;
}

/* Reads everything except the pixels. The caller calls finish_reading(). */
static void start_reading(struct reader *reader, const uint8_t *file, size_t size)
{
    *reader = (struct reader){.at = file, .left = size};
    reader->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, refuse, refuse);
    reader->info = png_create_info_struct(reader->png);
    png_set_read_fn(reader->png, reader, read_bytes);
    png_set_crc_action(reader->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_set_user_limits(reader->png, 1 << 20, 1 << 20);
    png_read_info(reader->png, reader->info);
}

static void finish_reading(struct reader *reader)
{
    png_read_end(reader->png, NULL);
    assert_int_equal(reader->left, 0);
    png_destroy_read_struct(&reader->png, &reader->info, NULL);
}

/* Compares the pixels, with alpha only where the file has it. */
static void check_pixels(const uint8_t *file, size_t size, const uint8_t *rgba, uint32_t width,
                         uint32_t height, bool is_opaque)
{
    struct reader reader;
    start_reading(&reader, file, size);
    assert_int_equal(png_get_image_width(reader.png, reader.info), width);
    assert_int_equal(png_get_image_height(reader.png, reader.info), height);
    assert_int_equal(png_get_bit_depth(reader.png, reader.info), 8);
    assert_int_equal(png_get_color_type(reader.png, reader.info),
                     is_opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGB_ALPHA);
    assert_int_equal(png_get_interlace_type(reader.png, reader.info), PNG_INTERLACE_NONE);
    const size_t step = is_opaque ? 3 : 4;
    uint8_t *row = malloc(step * width);
    assert_non_null(row);
    for (uint32_t y = 0; y < height; y++) {
        png_read_row(reader.png, row, NULL);
        for (uint32_t x = 0; x < width; x++)
            if (memcmp(row + step * x, rgba + 4 * ((size_t)y * width + x), step) != 0)
                fail_msg("%u x %u: pixel (%u, %u)", width, height, x, y);
    }
    free(row);
    finish_reading(&reader);
}

/* --- the compressed stream */

static uint32_t get_u32(const uint8_t *bytes)
{
    return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* The stored rows; the caller frees them. Expects that the data of all IDAT chunks are one zlib
 * stream with the right checksum and nothing behind it, and that all chunks have the right CRCs. */
static uint8_t *stored_rows(const uint8_t *file, size_t size, size_t n_bytes)
{
    uint8_t *rows = malloc(n_bytes + 1);
    assert_non_null(rows);
    z_stream stream = {.next_out = rows, .avail_out = (uInt)n_bytes + 1};
    int state = Z_OK;
    assert_int_equal(inflateInit(&stream), Z_OK);
    for (size_t at = 8; at < size;) {
        const size_t length = get_u32(file + at);
        assert_true(length <= size - at - 12);
        assert_int_equal(crc32(0, file + at + 4, (uInt)length + 4),
                         get_u32(file + at + 8 + length));
        if (memcmp(file + at + 4, "IDAT", 4) == 0) {
            stream.next_in = (uint8_t *)(uintptr_t)(file + at + 8);
            stream.avail_in = (uInt)length;
            assert_int_equal(state, Z_OK);
            state = inflate(&stream, Z_SYNC_FLUSH);
            assert_int_equal(stream.avail_in, 0);
        }
        at += 12 + length;
    }
    assert_int_equal(state, Z_STREAM_END);
    assert_int_equal(stream.total_out, n_bytes);
    inflateEnd(&stream);
    return rows;
}

static void check_file(const uint8_t *rgba, uint32_t width, uint32_t height, bool is_opaque)
{
    size_t size;
    uint8_t *file = png_file(encoder, rgba, width, height, METADATA, N_METADATA, &size);
    check_pixels(file, size, rgba, width, height, is_opaque);
    free(stored_rows(file, size, height * (1 + (is_opaque ? 3 : 4) * (size_t)width)));
    free(file);
}

/* --- tests */

static void test_what_comes_back(void **state)
{
    (void)state;
    /* One pixel; a column; strips of 32 rows, with a row less and a row more; wide pictures with
     * strips of two rows and of one. */
    static const uint32_t sizes[][2] = {{1, 1},     {1, 700},   {3, 2},     {4096, 31}, {4096, 32},
                                        {4096, 33}, {4096, 65}, {65500, 3}, {65536, 5}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int p = 0; p < 2 * N_PAINTERS; p++) {
            const uint32_t width = sizes[s][0], height = sizes[s][1];
            uint8_t *rgba = make_picture(PAINTERS[p / 2], width, height, p % 2);
            check_file(rgba, width, height, p % 2);
            free(rgba);
        }
}

/* Random sizes, and pictures composed of parts of all kinds. */
static void test_random_pictures(void **state)
{
    (void)state;
    random_state = 14;
    for (int i = 0; i < 120; i++) {
        const uint32_t width = 1 + random_bits() % (i % 4 ? 90 : 3000);
        const uint32_t height = 1 + random_bits() % (i % 4 ? 3000 : 90);
        const bool is_opaque = random_bits() % 2;
        uint8_t *rgba = make_picture(PAINTERS[random_bits() % N_PAINTERS], width, height, true);
        for (int piece = 0; piece < 4; piece++) {
            painter *paint = PAINTERS[random_bits() % N_PAINTERS];
            const uint32_t left = random_bits() % width, top = random_bits() % height;
            for (uint32_t y = top; y < height; y++)
                for (uint32_t x = left; x < width; x++)
                    paint(x, y, rgba + 4 * ((size_t)y * width + x));
        }
        for (size_t pixel = 0; pixel < (size_t)width * height; pixel++)
            if (is_opaque)
                rgba[4 * pixel + 3] = 255;
        if (!is_opaque)
            rgba[4 * (random_bits() % ((size_t)width * height)) + 3] = 0;
        check_file(rgba, width, height, is_opaque);
        free(rgba);
    }
}

/* Noise gives the largest files. png_file() and a sanitizer find writes beyond the bound. */
static void test_noise_keeps_to_the_bound(void **state)
{
    (void)state;
    const uint32_t width = 333, height = 500;
    struct strip_layout layout;
    png_layout_init(&layout, width, height);
    size_t size;
    uint8_t *rgba = make_picture(paint_noise, width, height, false);
    uint8_t *file = png_file(encoder, rgba, width, height, NULL, 0, &size);
    assert_true(size > (size_t)4 * width * height);
    assert_true(size < layout.n * layout.bound + png_head_bound(NULL, 0));
    free(file);
    free(rgba);
}

/* Too small a buffer is an error and nothing is written beyond its end; the encoder works
 * afterwards. */
static void test_no_room(void **state)
{
    (void)state;
    const uint32_t width = 100, height = 100;
    uint8_t *rgba = make_picture(paint_noise, width, height, true);
    struct strip_layout layout;
    png_layout_init(&layout, width, height);
    const size_t bound = layout.bound;
    uint8_t *row = malloc(png_row_bytes(&layout));
    for (layout.bound = 64; layout.bound < 3 * (size_t)width * height; layout.bound += 997) {
        uint8_t *bytes = malloc(layout.bound);
        struct png_strip strip;
        struct error error = {0};
        assert_true(row && bytes && layout.bound < bound);
        assert_false(
            png_strip_encode(encoder, &layout, 0, rgba, false, row, bytes, &strip, &error));
        assert_int_equal(error.kind, ERROR_SERVER);
        assert_non_null(strstr(error.text, "100 x 100"));
        free(bytes);
    }
    free(row);
    check_file(rgba, width, height, true);
    free(rgba);
}

/* Stripes are stored unfiltered, smooth colours as differences; each strip chooses separately. */
static void test_filters(void **state)
{
    (void)state;
    const uint32_t width = 1280, height = 300;
    struct strip_layout layout;
    png_layout_init(&layout, width, height);
    assert_int_equal(layout.rows, 102);
    uint8_t *rgba = make_picture(paint_stripes, width, height, true);
    for (uint32_t y = layout.rows; y < 2 * layout.rows; y++)
        for (uint32_t x = 0; x < width; x++)
            paint_smooth(x, y, rgba + 4 * ((size_t)y * width + x));
    size_t size;
    uint8_t *file = png_file(encoder, rgba, width, height, NULL, 0, &size);
    uint8_t *rows = stored_rows(file, size, height * (1 + 3 * (size_t)width));
    for (uint32_t y = 0; y < height; y++)
        if (rows[y * (1 + 3 * (size_t)width)] != (y / layout.rows == 1))
            fail_msg("row %u", y);
    free(rows);
    free(file);
    free(rgba);
}

static void test_texts(void **state)
{
    (void)state;
    static const uint8_t rgba[4] = {1, 2, 3, 4};
    char *value = malloc(100001);
    assert_non_null(value);
    memset(value, 'v', 100000);
    value[100000] = 0;
    const struct image_attribute long_metadata[] = {METADATA[0], {"n", value}, METADATA[1]};
    const struct image_attribute *const metadata[] = {METADATA, long_metadata, NULL};
    for (int i = 0; i < 3; i++) {
        const size_t n = metadata[i] ? N_METADATA : 0;
        size_t size;
        uint8_t *file = png_file(encoder, rgba, 1, 1, metadata[i], n, &size);
        struct reader reader;
        png_textp texts = NULL;
        int n_texts = 0, intent = -1;
        start_reading(&reader, file, size);
        png_get_text(reader.png, reader.info, &texts, &n_texts);
        assert_int_equal(n_texts, n);
        for (size_t t = 0; t < n; t++) {
            assert_string_equal(texts[t].key, metadata[i][t].name);
            assert_string_equal(texts[t].text, metadata[i][t].value);
        }
        assert_true(png_get_sRGB(reader.png, reader.info, &intent));
        assert_int_equal(intent, PNG_sRGB_INTENT_PERCEPTUAL);
        uint8_t pixel[4];
        png_read_row(reader.png, pixel, NULL);
        assert_memory_equal(pixel, rgba, 4);
        finish_reading(&reader);
        free(file);
    }
    free(value);
}

/* Metadata whose lengths differ by a few bytes have the same bound, so that the memory of one file
 * is used for the next. */
static void test_metadata_of_about_one_length(void **state)
{
    (void)state;
    const struct image_attribute longer = {METADATA[1].name, "eye=1.25,2,3.0625 fov=35"};
    assert_int_equal(png_head_bound(&METADATA[1], 1), png_head_bound(&longer, 1));
}

static uint8_t *encode_png(const uint8_t *rgba, int n, size_t *size)
{
    struct png_encoder *own = png_encoder_create();
    uint8_t *file = NULL;
    assert_non_null(own);
    for (int i = 0; i < n; i++) {
        free(file);
        file = png_file(own, rgba, AT_ONCE_WIDTH, AT_ONCE_HEIGHT, METADATA, N_METADATA, size);
    }
    png_encoder_destroy(own);
    return file;
}

static void test_two_encoders_at_once(void **state)
{
    (void)state;
    uint8_t *const rgba[2] = {
        make_picture(paint_smooth, AT_ONCE_WIDTH, AT_ONCE_HEIGHT, true),
        make_picture(paint_stripes, AT_ONCE_WIDTH, AT_ONCE_HEIGHT, true),
    };
    expect_same_at_once(encode_png, rgba);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_comes_back),
        cmocka_unit_test(test_random_pictures),
        cmocka_unit_test(test_noise_keeps_to_the_bound),
        cmocka_unit_test(test_no_room),
        cmocka_unit_test(test_filters),
        cmocka_unit_test(test_texts),
        cmocka_unit_test(test_metadata_of_about_one_length),
        cmocka_unit_test(test_two_encoders_at_once),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
