/* server/image: pictures in every format are written and read again (JPEG and PNG are only read),
 * repeated writing gives the same bytes, and other files are refused. */
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "server/image/image.h"
#include "tests/unit/jpeg_file.h"
#include "tests/unit/png_file.h"

enum { WIDTH = 67, HEIGHT = 131 }; /* odd, and more rows than one strip has */

struct picture {
    uint8_t colour[HEIGHT][WIDTH][4];
    float position[HEIGHT][WIDTH][3];
    uint32_t face[HEIGHT][WIDTH];
};

static const struct image_attribute ATTRIBUTES[] = {
    {"sheen:version", "1.2.3"},
    {"sheen:camera", "eye=1,2,3 fov=35"},
};

static struct picture *picture_create(void)
{
    struct picture *p = malloc(sizeof *p);
    assert_non_null(p);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint8_t c[4] = {(uint8_t)(3 * x), (uint8_t)y, (uint8_t)(x ^ y), (uint8_t)(255 - y)};
            memcpy(p->colour[y][x], c, 4);
            for (int i = 0; i < 3; i++)
                p->position[y][x][i] = (float)(x * 1e-3 + y * 1e3 + i);
            p->face[y][x] = x == 0 ? UINT32_MAX : (uint32_t)(y * WIDTH + x);
        }
    return p;
}

static size_t colour_channels(const struct picture *p, struct image_channel channels[4])
{
    static const char *const names[] = {"R", "G", "B", "A"};
    for (int i = 0; i < 4; i++)
        channels[i] =
            (struct image_channel){names[i], IMAGE_UINT8, &p->colour[0][0][i], 4, WIDTH * 4};
    return 4;
}

static uint8_t *encode(enum image_format format, const struct image_channel *channels, size_t n,
                       size_t *size)
{
    uint8_t *bytes;
    struct error error = {0};
    if (!image_encode(format, WIDTH, HEIGHT, channels, n, ATTRIBUTES, 2, &bytes, size, &error))
        fail_msg("%s", error.text);
    return bytes;
}

static uint8_t *encode_colour(enum image_format format, size_t *size)
{
    struct picture *p = picture_create();
    struct image_channel channels[4];
    uint8_t *bytes = encode(format, channels, colour_channels(p, channels), size);
    free(p);
    return bytes;
}

static uint8_t *encode_jpeg(size_t *size)
{
    struct picture *p = picture_create();
    struct jpeg_encoder *encoder = jpeg_encoder_create();
    assert_non_null(encoder);
    uint8_t *bytes = jpeg_file(encoder, p->colour[0][0], WIDTH, HEIGHT, ATTRIBUTES, 2, size);
    jpeg_encoder_destroy(encoder);
    free(p);
    return bytes;
}

static uint8_t *encode_png(size_t *size)
{
    struct picture *p = picture_create();
    struct png_encoder *encoder = png_encoder_create();
    assert_non_null(encoder);
    uint8_t *bytes = png_file(encoder, p->colour[0][0], WIDTH, HEIGHT, ATTRIBUTES, 2, size);
    png_encoder_destroy(encoder);
    free(p);
    return bytes;
}

static uint8_t *encode_tiff(size_t *size)
{
    return encode_colour(IMAGE_TIFF, size);
}

static uint8_t *encode_exr(size_t *size)
{
    return encode_colour(IMAGE_EXR, size);
}

static bool contains(const uint8_t *bytes, size_t size, const void *what, size_t n)
{
    return memmem(bytes, size, what, n) != NULL;
}

static void expect_refused(const void *bytes, size_t size, const char *name, enum error_kind kind,
                           const char *words)
{
    struct image image;
    struct error error = {0};
    assert_false(image_decode(&image, bytes, size, name, 16384, &error));
    assert_null(image.pixels);
    if (error.kind != kind || !strstr(error.text, words) || !strstr(error.text, name))
        fail_msg("kind %d, '%s' wants '%s'", error.kind, error.text, words);
    assert_null(strchr(error.text, '\n'));
}

/* The formulas, written independently of protocol/srgb.h. */
static double light_of(uint8_t value)
{
    double v = value / 255.0;
    return v > 0.04045 ? exp(2.4 * log((v + 0.055) / 1.055)) : v / 12.92;
}

/* The pixels are linear light, premultiplied by alpha, as these colours are displayed. */
static void expect_light(const struct image *image, const uint8_t (*colour)[4], double tolerance)
{
    assert_true(image->is_float);
    const float(*pixel)[4] = image->pixels;
    for (size_t i = 0; i < (size_t)image->width_px * image->height_px; i++) {
        double alpha = colour[i][3] / 255.0;
        assert_true(fabs((double)pixel[i][3] - alpha) <= tolerance);
        for (int k = 0; k < 3; k++)
            assert_true(fabs((double)pixel[i][k] - alpha * light_of(colour[i][k])) <= tolerance);
    }
}

static void test_lossless_round_trip(void **state)
{
    (void)state;
    static uint8_t *(*const encoders[])(size_t * size) = {encode_png, encode_tiff};
    struct picture *p = picture_create();
    for (size_t f = 0; f < 2; f++) {
        size_t size;
        uint8_t *bytes = encoders[f](&size);
        struct image image;
        struct error error = {0};
        struct image measured;
        if (!image_measure(&measured, bytes, size, "no-ending", 16384, &error) ||
            !image_decode(&image, bytes, size, "no-ending", 16384, &error))
            fail_msg("%s", error.text);
        assert_null(measured.pixels);
        assert_true(image.width_px == WIDTH && image.height_px == HEIGHT);
        assert_true(measured.width_px == WIDTH && measured.height_px == HEIGHT);
        assert_true(measured.is_float && image.is_float); /* transparent */
        assert_false(image_measure(&measured, bytes, size, "wide", WIDTH - 1, &error));
        assert_true(contains((uint8_t *)error.text, strlen(error.text), "wide: ", 6));
        expect_light(&image, p->colour[0], 1e-6);
        assert_true(contains(bytes, size, "1.2.3", 5));
        assert_true(contains(bytes, size, "sheen:camera", 12));
        image_finish(&image);
        free(bytes);
    }
    free(p);
}

static void test_exr_types(void **state)
{
    (void)state;
    struct picture *p = picture_create();
    struct image_channel c[8];
    size_t n = colour_channels(p, c);
    static const char *const names[] = {"P.X", "P.Y", "P.Z"};
    for (int i = 0; i < 3; i++)
        c[n++] =
            (struct image_channel){names[i], IMAGE_FLOAT, &p->position[0][0][i], 12, WIDTH * 12};
    c[n++] = (struct image_channel){"ptex.face", IMAGE_UINT32, p->face, 4, WIDTH * 4};
    size_t size;
    uint8_t *bytes = encode(IMAGE_EXR, c, n, &size);
    /* A channel list has each channel's name, a zero byte, and its type: 0 UINT, 1 HALF, 2
     * FLOAT. */
    assert_true(contains(bytes, size, "R\0\1\0\0\0", 6));
    assert_true(contains(bytes, size, "P.X\0\2\0\0\0", 8));
    assert_true(contains(bytes, size, "ptex.face\0\0\0\0\0", 14));
    assert_true(contains(bytes, size, "sheen:version", 13));

    struct image image;
    struct error error = {0};
    if (!image_decode(&image, bytes, size, "x.exr", 16384, &error))
        fail_msg("%s", error.text);
    expect_light(&image, p->colour[0], 0x1p-11);
    image_finish(&image);
    free(bytes);

    /* Single precision is read back bit by bit. */
    struct image_channel position[] = {c[4], c[5], c[6]};
    position[0].name = "R", position[1].name = "G", position[2].name = "B";
    bytes = encode(IMAGE_EXR, position, 3, &size);
    assert_true(image_decode(&image, bytes, size, "x.exr", 16384, &error));
    const float *got = image.pixels;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        assert_memory_equal(got + 4 * i, &p->position[0][0][0] + 3 * i, 12);
        assert_true(got[4 * i + 3] == 1.0f);
    }
    image_finish(&image);
    free(bytes);
    free(p);
}

static void test_same_bytes_at_any_time(void **state)
{
    (void)state;
    static uint8_t *(*const encoders[])(size_t * size) = {encode_png, encode_exr, encode_tiff};
    uint8_t *first[3];
    size_t first_size[3];
    for (size_t f = 0; f < 3; f++)
        first[f] = encoders[f](&first_size[f]);
    for (time_t start = time(NULL); time(NULL) < start + 2;)
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    char year[8];
    time_t now = time(NULL);
    strftime(year, sizeof year, "%Y:", localtime(&now));
    for (size_t f = 0; f < 3; f++) {
        size_t size;
        uint8_t *again = encoders[f](&size);
        assert_int_equal(size, first_size[f]);
        assert_memory_equal(again, first[f], size);
        assert_false(contains(again, size, year, strlen(year)));
        free(again);
        free(first[f]);
    }
}

static void test_grey_and_missing_alpha(void **state)
{
    (void)state;
    static const char grey[] = "P5\n2 1\n255\n\x10\xf0";
    struct image image;
    struct error error = {0};
    if (!image_decode(&image, grey, sizeof grey - 1, "grey.pgm", 16384, &error))
        fail_msg("%s", error.text);
    assert_memory_equal(image.pixels, "\x10\x10\x10\xff\xf0\xf0\xf0\xff", 8);
    image_finish(&image);
}

static void test_no_image(void **state)
{
    (void)state;
    char text[4096];
    memset(text, 'v', sizeof text);
    static const char *const names[] = {"cage.obj", "lie.png",          "lie.null",
                                        "lie.tga",  "../../etc/passwd", "film.avi"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        expect_refused(text, sizeof text, names[i], ERROR_IMAGE,
                       ": it is not an image format that is read: " IMAGE_READ_FORMATS);
    expect_refused("", 0, "empty.png", ERROR_IMAGE, "empty");
    static const char huge[] = "P6\n100000 100000\n255\nabc";
    expect_refused(huge, sizeof huge - 1, "huge.ppm", ERROR_IMAGE, "100000 x 100000");
    static const char bomb[] = "P6\n16384 16385\n255\nabc";
    expect_refused(bomb, sizeof bomb - 1, "bomb.ppm", ERROR_IMAGE, "16384 x 16385");
    static const char bytes[] = "PF\n16384 16384\n-1\nabc";
    expect_refused(bytes, sizeof bytes - 1, "bytes.pfm", ERROR_IMAGE, "bytes");
}

/* Only the bytes by which a format is recognised, and less than these. */
static void test_signatures(void **state)
{
    (void)state;
    static const struct {
        const char *format, *bytes;
        size_t size;
    } cases[] = {
        {"png", "\x89PNG\r\n\x1a\n", 8},
        {"jpeg", "\xff\xd8\xff", 3},
        {"openexr", "\x76\x2f\x31\x01", 4},
        {"tiff", "II\x2a\0", 4},
        {"tiff", "MM\0\x2a", 4},
        {"tiff", "II\x2b\0", 4},
        {"tiff", "MM\0\x2b", 4},
        {"hdr", "#?RADIANCE", 10},
        {"hdr", "#?RGBE", 6},
        {"gif", "GIF87a", 6},
        {"gif", "GIF89a", 6},
        {"webp", "RIFF\0\0\0\0WEBP", 12},
        {"bmp", "BM", 2},
        {"pnm", "P1\n", 3},
        {"pnm", "P6 ", 3},
        {"pnm", "PF\r", 3},
        {"targa", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\0", 18},
        {"targa", "\0\1\x09\0\0\2\0\x18\0\0\0\0\1\0\1\0\x08\0", 18},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        for (size_t size = 1; size <= cases[i].size; size++) {
            /* exactly this size, so that a sanitizer finds a read beyond the end */
            uint8_t *part = malloc(size);
            struct image image;
            struct error error = {0};
            assert_non_null(part);
            memcpy(part, cases[i].bytes, size);
            assert_false(image_decode(&image, part, size, "a", 16384, &error));
            bool known = !strstr(error.text, "not an image format");
            if (known != (size == cases[i].size) || (known && !strstr(error.text, cases[i].format)))
                fail_msg("%zu bytes of %s: %s", size, cases[i].format, error.text);
            free(part);
        }
    static const char *const bad[] = {
        "\0\0\1\0\0\0\0\0\0\0\0\0\1\0\1\0\x08\0", /* uses a colour map that is missing */
        "\0\2\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\0", "\0\0\4\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\0",
        "\0\0\2\0\0\0\0\0\0\0\0\0\0\0\1\0\x20\0", "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\0\0\x20\0",
        "\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x21\0"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        expect_refused(bad[i], 18, "b", ERROR_IMAGE, "not an image format");
}

/* A file cut off at any byte is refused or, if the format allows it, decoded, but never a crash. A
 * cut in the middle of the pixels must be refused. */
static void test_truncated(void **state)
{
    (void)state;
    static uint8_t *(*const encoders[])(size_t * size) = {encode_png, encode_exr, encode_tiff,
                                                          encode_jpeg};
    static const char *const names[] = {"cut.png", "cut.exr", "cut.tif", "cut.jpg"};
    for (size_t f = 0; f < 4; f++) {
        size_t size;
        uint8_t *bytes = encoders[f](&size);
        for (size_t cut = 1; cut < size; cut += 1 + size / 61) {
            /* exactly this size, so that a sanitizer finds a read beyond the end */
            uint8_t *part = malloc(cut);
            assert_non_null(part);
            memcpy(part, bytes, cut);
            struct image image;
            struct error error = {0};
            if (image_decode(&image, part, cut, names[f], 16384, &error))
                image_finish(&image);
            else
                assert_true(strstr(error.text, names[f]) != NULL);
            free(part);
        }
        expect_refused(bytes, size / 2, names[f], ERROR_IMAGE, names[f]);
        free(bytes);
    }
}

static void test_planes_a_format_cannot_hold(void **state)
{
    (void)state;
    struct picture *p = picture_create();
    struct image_channel c[5];
    size_t n = colour_channels(p, c);
    c[n++] = (struct image_channel){"P.X", IMAGE_FLOAT, p->position, 12, WIDTH * 12};
    uint8_t *bytes;
    size_t size;
    struct error error = {0};
    assert_false(image_encode(IMAGE_TIFF, WIDTH, HEIGHT, c, n, NULL, 0, &bytes, &size, &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
    assert_non_null(strstr(error.text, "P.X"));
    assert_null(bytes);
    assert_false(image_encode(IMAGE_TIFF, WIDTH, HEIGHT, c, 2, NULL, 0, &bytes, &size, &error));
    assert_false(image_encode(IMAGE_TIFF, 0, HEIGHT, c, 4, NULL, 0, &bytes, &size, &error));
    free(p);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lossless_round_trip),
        cmocka_unit_test(test_exr_types),
        cmocka_unit_test(test_same_bytes_at_any_time),
        cmocka_unit_test(test_grey_and_missing_alpha),
        cmocka_unit_test(test_no_image),
        cmocka_unit_test(test_signatures),
        cmocka_unit_test(test_truncated),
        cmocka_unit_test(test_planes_a_format_cannot_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
