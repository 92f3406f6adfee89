/* JPEG files of frames: the decoded pixels, the metadata, and requests that the library refuses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <turbojpeg.h>

#include "tests/unit/encoders_at_once.h"
#include "tests/unit/jpeg_file.h"

static const struct image_attribute METADATA[] = {
    {"sheen:version", "1.2.3"},
    {"sheen:camera", "eye=1,2,3 fov=35"},
};

static struct jpeg_encoder *encoder;

static int setup(void **state)
{
    (void)state;
    image_use_one_thread();
    encoder = jpeg_encoder_create();
    return encoder ? 0 : -1;
}

static int teardown(void **state)
{
    (void)state;
    jpeg_encoder_destroy(encoder);
    return 0;
}

/* --- pictures */

typedef void painter(uint32_t x, uint32_t y, uint8_t rgb[3]);

static void paint_grey(uint32_t x, uint32_t y, uint8_t rgb[3])
{
    memset(rgb, (int)((x + 3 * y) % 256), 3);
}

/* Smooth, through all of red, green and blue, like false colour. */
static void paint_colours(uint32_t x, uint32_t y, uint8_t rgb[3])
{
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)lround(127.5 + 127.5 * sin(0.05 * x + 0.03 * y + 2.1 * i));
}

/* Columns of one pixel, whose colours subsampling averages away. */
static void paint_columns(uint32_t x, uint32_t y, uint8_t rgb[3])
{
    (void)y;
    memcpy(rgb, x & 1 ? "\xff\0\0" : "\0\0\xff", 3);
}

static void paint_noise(uint32_t x, uint32_t y, uint8_t rgb[3])
{
    uint32_t n = (x * 73856093u) ^ (y * 19349663u);
    for (int i = 0; i < 3; i++, n = n * 1664525u + 1013904223u)
        rgb[i] = n >> 31 ? 255 : 0;
}

static uint8_t *make_picture(painter *paint, uint32_t width, uint32_t height)
{
    uint8_t *rgba = malloc((size_t)4 * width * height);
    assert_non_null(rgba);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            uint8_t *pixel = rgba + 4 * ((size_t)y * width + x);
            paint(x, y, pixel);
            pixel[3] = (uint8_t)(x * y); /* quality and subsampling are left out */
        }
    return rgba;
}

struct difference {
    int worst;
    double psnr_db; /* with three channels */
};

static struct difference compare(const uint8_t *rgba, const uint8_t *file, size_t size,
                                 uint32_t width, uint32_t height)
{
    struct image image;
    struct error error = {0};
    struct difference difference = {0};
    double sum = 0;
    if (!image_decode(&image, file, size, "x.jpg", 65536, &error))
        fail_msg("%s", error.text);
    assert_int_equal(image.width_px, width);
    assert_int_equal(image.height_px, height);
    assert_false(image.is_float);
    const uint8_t *got = image.pixels;
    for (size_t i = 0; i < (size_t)4 * width * height; i++) {
        if (i % 4 == 3) {
            assert_int_equal(got[i], 255);
            continue;
        }
        int by = abs(got[i] - rgba[i]);
        difference.worst = by > difference.worst ? by : difference.worst;
        sum += by * by;
    }
    difference.psnr_db = 10 * log10(255.0 * 255 * 3 * width * height / (sum + 1e-9));
    image_finish(&image);
    return difference;
}

/* --- tests */

static void test_what_comes_back(void **state)
{
    (void)state;
    static const struct {
        painter *paint;
        int worst;
        double psnr_db;
    } paints[] = {{paint_grey, 8, 45}, {paint_colours, 8, 42}, {paint_columns, 24, 36}};
    /* One pixel; less than a block; two strips, of which the last has one row; three strips, cut
     * off at the right. */
    static const uint32_t sizes[][2] = {{1, 1}, {17, 3}, {128, 1025}, {811, 323}};
    for (size_t p = 0; p < sizeof paints / sizeof *paints; p++)
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
            const uint32_t width = sizes[s][0], height = sizes[s][1];
            uint8_t *rgba = make_picture(paints[p].paint, width, height);
            size_t size;
            uint8_t *file = jpeg_file(encoder, rgba, width, height, METADATA, 2, &size);
            struct difference by = compare(rgba, file, size, width, height);
            if (by.worst > paints[p].worst || by.psnr_db < paints[p].psnr_db)
                fail_msg("paint %zu, %u x %u: %d, %f dB", p, width, height, by.worst, by.psnr_db);
            free(file);
            free(rgba);
        }
}

/* The whole picture as the library writes it; the caller frees it by tjFree(). */
static uint8_t *library_file(const uint8_t *rgba, uint32_t width, uint32_t height,
                             const struct jpeg_options *options, unsigned long *size)
{
    static const int samplings[] = {TJSAMP_444, TJSAMP_422, TJSAMP_420};
    unsigned char *file = NULL;
    tjhandle handle = tjInitCompress();
    assert_non_null(handle);
    assert_int_equal(tjCompress2(handle, rgba, (int)width, 0, (int)height, TJPF_RGBX, &file, size,
                                 samplings[options->subsampling], (int)options->quality,
                                 TJFLAG_ACCURATEDCT),
                     0);
    tjDestroy(handle);
    return file;
}

/* A picture that is written in strips decodes to the same pixels as one that is written at once,
 * for every option. */
static void test_options(void **state)
{
    (void)state;
    static const unsigned qualities[] = {1, 50, 95, 100};
    static const uint32_t sizes[][2] = {{1, 1}, {17, 3}, {128, 1025}, {811, 323}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        const uint32_t width = sizes[s][0], height = sizes[s][1];
        uint8_t *rgba = make_picture(paint_colours, width, height);
        for (size_t i = 0; i < 3 * sizeof qualities / sizeof *qualities; i++) {
            const struct jpeg_options options = {qualities[i / 3], (enum jpeg_subsampling)(i % 3)};
            size_t size;
            unsigned long want_size = 0;
            struct image want;
            struct error error = {0};
            uint8_t *file =
                jpeg_file_of(encoder, &options, rgba, width, height, METADATA, 2, &size);
            uint8_t *want_file = library_file(rgba, width, height, &options, &want_size);
            if (!image_decode(&want, want_file, want_size, "want.jpg", 65536, &error))
                fail_msg("%s", error.text);
            if (compare(want.pixels, file, size, width, height).worst != 0)
                fail_msg("%u x %u, quality %u, subsampling %d", width, height, options.quality,
                         options.subsampling);
            image_finish(&want);
            tjFree(want_file);
            free(file);
        }
        free(rgba);
    }
}

/* Noise gives the largest files. The buffer ends at the bound, so that a sanitizer finds writes
 * beyond it. */
static void test_noise_keeps_to_the_bound(void **state)
{
    (void)state;
    const uint32_t width = 333, height = 500;
    uint8_t *rgba = make_picture(paint_noise, width, height);
    for (int i = 0; i < 3; i++) {
        const struct jpeg_options most = {100, (enum jpeg_subsampling)i};
        size_t most_size;
        free(jpeg_file_of(encoder, &most, rgba, width, height, NULL, 0, &most_size));
    }
    struct jpeg_layout layout;
    jpeg_layout_init(&layout, width, height, &JPEG_DEFAULTS);
    size_t size;
    uint8_t *file = jpeg_file(encoder, rgba, width, height, NULL, 0, &size);
    assert_true(size > (size_t)2 * width * height);
    assert_true(size < layout.strips.n * layout.strips.bound);
    assert_true(compare(rgba, file, size, width, height).psnr_db > 25);
    free(file);
    free(rgba);
}

static void test_strips_are_restart_intervals(void **state)
{
    (void)state;
    const uint32_t width = 16384, height = 85; /* 8 rows in each strip */
    uint8_t *rgba = make_picture(paint_grey, width, height);
    struct jpeg_layout layout;
    jpeg_layout_init(&layout, width, height, &JPEG_DEFAULTS);
    assert_int_equal(layout.strips.rows, 8);
    assert_int_equal(layout.strips.n, 11);
    size_t size;
    uint8_t *file = jpeg_file(encoder, rgba, width, height, NULL, 0, &size);
    char restarts[16];
    size_t n = 0;
    const uint8_t *interval = memmem(file, size, "\xff\xdd\0\4", 4);
    assert_non_null(interval);
    assert_int_equal(interval[4] << 8 | interval[5], 16384 / 8);
    for (const uint8_t *at = interval; at + 1 < file + size; at++)
        if (at[0] == 0xff && at[1] >= 0xd0 && at[1] <= 0xd7 && n < sizeof restarts - 1)
            restarts[n++] = (char)('0' + (at[1] & 7));
    restarts[n] = 0;
    assert_string_equal(restarts, "0123456701");
    assert_memory_equal(file + size - 2, "\xff\xd9", 2);
    assert_true(compare(rgba, file, size, width, height).worst <= 8);
    free(file);
    free(rgba);
}

/* The concatenated text of all comments of a file; the caller frees it. */
static char *read_comments(const uint8_t *file, size_t size, int *n_comments)
{
    char *text = calloc(1, size);
    assert_non_null(text);
    *n_comments = 0;
    assert_memory_equal(file, "\xff\xd8\xff\xe0\0\x10JFIF", 10);
    for (size_t at = 2; file[at + 1] != 0xda;) {
        size_t length = (size_t)file[at + 2] << 8 | file[at + 3];
        assert_int_equal(file[at], 0xff);
        assert_true(at + 2 + length < size);
        if (file[at + 1] == 0xfe) {
            strncat(text, (const char *)file + at + 4, length - 2);
            ++*n_comments;
        }
        at += 2 + length;
    }
    return text;
}

static void test_metadata(void **state)
{
    (void)state;
    static const uint8_t rgba[4] = {0};
    size_t size;
    int n;
    uint8_t *file = jpeg_file(encoder, rgba, 1, 1, METADATA, 2, &size);
    char *text = read_comments(file, size, &n);
    assert_string_equal(text, "sheen:version=1.2.3\nsheen:camera=eye=1,2,3 fov=35\n");
    assert_int_equal(n, 1);
    free(text);
    free(file);
    file = jpeg_file(encoder, rgba, 1, 1, NULL, 0, &size);
    text = read_comments(file, size, &n);
    assert_int_equal(n, 0);
    free(text);
    free(file);
}

/* A segment holds at most 65533 bytes. */
static void test_long_metadata(void **state)
{
    (void)state;
    static const uint8_t rgba[4] = {10, 20, 30, 40};
    static const struct {
        size_t value_bytes;
        int n_comments;
    } cases[] = {{65530, 1}, {65531, 2}, {140000, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *value = calloc(1, cases[i].value_bytes + 1);
        assert_non_null(value);
        for (size_t k = 0; k < cases[i].value_bytes; k++)
            value[k] = (char)('a' + k % 26);
        const struct image_attribute metadata = {"n", value};
        size_t size;
        int n;
        uint8_t *file = jpeg_file(encoder, rgba, 1, 1, &metadata, 1, &size);
        char *text = read_comments(file, size, &n);
        assert_int_equal(n, cases[i].n_comments);
        assert_int_equal(strlen(text), cases[i].value_bytes + 3);
        assert_memory_equal(text, "n=", 2);
        assert_memory_equal(text + 2, value, cases[i].value_bytes);
        assert_true(compare(rgba, file, size, 1, 1).worst <= 8);
        free(text);
        free(file);
        free(value);
    }
}

/* Metadata whose lengths differ by a few bytes have the same bound, so that the memory of one file
 * is used for the next. */
static void test_metadata_of_about_one_length(void **state)
{
    (void)state;
    const struct image_attribute longer = {METADATA[1].name, "eye=1.25,2,3.0625 fov=35"};
    assert_int_equal(jpeg_head_bound(623, &METADATA[1], 1), jpeg_head_bound(623, &longer, 1));
}

/* One pixel too wide. Such a request is refused earlier. */
static void test_what_the_library_refuses(void **state)
{
    (void)state;
    const uint32_t width = 65501;
    uint8_t *rgba = make_picture(paint_grey, width, 1);
    struct jpeg_layout layout;
    jpeg_layout_init(&layout, width, 1, &JPEG_DEFAULTS);
    uint8_t *bytes = malloc(layout.strips.bound);
    assert_non_null(bytes);
    size_t start, end, size;
    struct error error = {0};
    assert_false(jpeg_strip_encode(encoder, &layout, 0, rgba, bytes, &start, &end, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    assert_non_null(strstr(error.text, "65501 x 1"));
    assert_non_null(strstr(error.text, "65500 pixels"));
    free(bytes);
    /* The encoder still works after that, up to the limit. */
    uint8_t *file = jpeg_file(encoder, rgba, width - 1, 1, NULL, 0, &size);
    assert_true(compare(rgba, file, size, width - 1, 1).worst <= 8);
    free(file);
    free(rgba);
}

static uint8_t *encode_jpeg(const uint8_t *rgba, int n, size_t *size)
{
    struct jpeg_encoder *own = jpeg_encoder_create();
    uint8_t *file = NULL;
    assert_non_null(own);
    for (int i = 0; i < n; i++) {
        free(file);
        file = jpeg_file(own, rgba, AT_ONCE_WIDTH, AT_ONCE_HEIGHT, METADATA, 2, size);
    }
    jpeg_encoder_destroy(own);
    return file;
}

static void test_two_encoders_at_once(void **state)
{
    (void)state;
    uint8_t *const rgba[2] = {
        make_picture(paint_colours, AT_ONCE_WIDTH, AT_ONCE_HEIGHT),
        make_picture(paint_noise, AT_ONCE_WIDTH, AT_ONCE_HEIGHT),
    };
    expect_same_at_once(encode_jpeg, rgba);
}

/* libjpeg-turbo would write arithmetic coding, other tables and more markers for these. */
static void test_environment(void **state)
{
    (void)state;
    static const char *const names[] = {"TJ_ARITHMETIC", "TJ_OPTIMIZE", "TJ_PROGRESSIVE",
                                        "TJ_RESTART"};
    uint8_t *rgba = make_picture(paint_colours, 100, 100);
    size_t sizes[2];
    uint8_t *files[2];
    files[0] = jpeg_file(encoder, rgba, 100, 100, METADATA, 2, &sizes[0]);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        setenv(names[i], "1", 1);
    jpeg_keep_defaults();
    files[1] = jpeg_file(encoder, rgba, 100, 100, METADATA, 2, &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(files[0], files[1], sizes[0]);
    free(files[0]);
    free(files[1]);
    free(rgba);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_what_comes_back),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_noise_keeps_to_the_bound),
        cmocka_unit_test(test_strips_are_restart_intervals),
        cmocka_unit_test(test_metadata),
        cmocka_unit_test(test_long_metadata),
        cmocka_unit_test(test_metadata_of_about_one_length),
        cmocka_unit_test(test_what_the_library_refuses),
        cmocka_unit_test(test_two_encoders_at_once),
        cmocka_unit_test(test_environment),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
