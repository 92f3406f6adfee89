/* Semi-sharp creases whose rounding is narrower than a pixel, about as wide, and wider. A pixel
 * there shows the mean over its area, as many exact samples give it. The native device draws the
 * samples, because a software GL device takes many times as long; test_native_frames compares
 * frames of one sample a pixel of both devices. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "protocol/srgb.h"
#include "server/render/gl/device.h"
#include "server/render/native/device.h"
#include "server/render/renderer.h"
#include "tests/unit/cage_tables.h"

enum { WIDTH = 96, HEIGHT = 64, SIDE = 8 }; /* SIDE x SIDE samples a pixel */

/* What draws pixels, and what draws samples. */
enum { PIXELS, SAMPLES, N_DEVICES };

struct scene {
    struct limit_tables tables;
    struct renderer *renderer[N_DEVICES];
    struct renderer_model *model[N_DEVICES];
};

/* A sheet of n x n unit quads, folded every `ridge` quads along creases: rounded over 2^-sharpness
 * of a quad on either side. */
static void scene_init(struct scene *scene, int n, int ridge, double sharpness)
{
    struct error error = {0};
    static char text[1 << 19];
    size_t used = 0;
#define ADD(...) used += (size_t)snprintf(text + used, sizeof text - used, __VA_ARGS__)
    for (int y = 0; y <= n; y++)
        for (int x = 0; x <= n; x++)
            ADD("v %d %d %g\n", x - n / 2, y - n / 2, -0.7 * abs(x % (2 * ridge) - ridge));
    for (int k = 0; k < n * n; k++) {
        int a = k / n * (n + 1) + k % n + 1;
        ADD("f %d %d %d %d\n", a, a + 1, a + n + 2, a + n + 1);
    }
    for (int y = 0; y < n; y++)
        for (int x = ridge; x < n; x += ridge)
            ADD("t crease 2/1/0 %d %d %g\n", y * (n + 1) + x, (y + 1) * (n + 1) + x, sharpness);
#undef ADD
    *scene = (struct scene){0};
    build(text, used, &scene->tables);
    const struct renderer_device *devices[N_DEVICES] = {&gl_device, &native_renderer_device};
    for (int i = 0; i < N_DEVICES; i++) {
        const struct renderer_options options = {.device = i == PIXELS ? "auto" : NULL};
        scene->renderer[i] = renderer_create(devices[i], &options, &error);
        if (!scene->renderer[i])
            fail_msg("%s", error.text);
        scene->model[i] = renderer_model_create(scene->renderer[i], &scene->tables, &error);
        assert_non_null(scene->model[i]);
    }
}

static void scene_finish(struct scene *scene)
{
    for (int i = 0; i < N_DEVICES; i++) {
        renderer_model_destroy(scene->renderer[i], scene->model[i]);
        renderer_destroy(scene->renderer[i]);
    }
    limit_tables_finish(&scene->tables);
}

/* The ridge from above at an angle, with `quad_px` pixels for each quad; the middle of it, width x
 * height such pixels. With `scale` above 1, that many times the pixels, one sample each. */
static struct frame render(const struct scene *scene, uint32_t width, uint32_t height,
                           double quad_px, uint32_t scale)
{
    struct error error = {0};
    const struct frame_request request = {
        .width_px = width * scale,
        .height_px = height * scale,
        .camera = {.kind = CAMERA_ORTHOGRAPHIC,
                   .eye = {0.1, -1, 80},
                   .up = {0.35, 1, 0},
                   .ortho_height = height / quad_px},
        .lines = {.family = LINES_ZEBRA},
        .n_lights = 1,
        .lights = {{.u = {1, 0, 0},
                    .v = {0, 1, 0},
                    .pattern = {.kind = PATTERN_STRIPES,
                                .count = 12,
                                .duty = 0.5,
                                .opacity = 1,
                                .foreground = {1, 1, 1, 1},
                                .background = {0, 0, 0, 1}}}},
        .miss = {0, 0, 0, 1},
        .empty = {0.5, 0.5, 0.5, 1},
        .planes = PLANE_COLOUR,
        .unfiltered = scale > 1,
    };
    struct frame frame;
    int i = scale > 1 ? SAMPLES : PIXELS;
    if (!renderer_render(scene->renderer[i], scene->model[i], &request, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

/* The mean error over the pixels that show a ridge, in 1/255, and the largest error. */
static void compare(const struct scene *scene, double quad_px, double *mean, double *largest)
{
    struct frame shown = render(scene, WIDTH, HEIGHT, quad_px, 1);
    struct frame sampled = render(scene, WIDTH, HEIGHT, quad_px, SIDE);
    const uint8_t(*colour)[4] = shown.plane[0], (*sample)[4] = sampled.plane[0];
    double sum = 0;
    size_t n = 0;
    *largest = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) {
        double truth = 0;
        int least = 255, most = 0;
        for (size_t k = 0; k < SIDE * SIDE; k++) {
            size_t x = i % WIDTH * SIDE + k % SIDE, y = i / WIDTH * SIDE + k / SIDE;
            int value = sample[y * WIDTH * SIDE + x][0];
            truth += srgb_to_linear(value / 255.0) / (SIDE * SIDE);
            least = value < least ? value : least;
            most = value > most ? value : most;
        }
        if (least == most)
            continue;
        double off = fabs(colour[i][0] - 255 * srgb_from_linear(truth));
        sum += off;
        n++;
        *largest = fmax(*largest, off);
    }
    assert_true(n > HEIGHT);
    *mean = sum / (double)n;
    frame_finish(&shown);
    frame_finish(&sampled);
}

static void expect(const struct scene *scene, double quad_px, double most_mean, double most)
{
    double mean, largest;
    compare(scene, quad_px, &mean, &largest);
    if (!(mean < most_mean && largest < most))
        fail_msg("%.1f px a quad: mean error %.2f, largest %.1f", quad_px, mean, largest);
}

/* Rounded over a sixteenth of a quad, from 0.7 px on. From 1 px on no side of the rounding counts
 * as a border. */
static void test_ridge(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, 8, 4, 4);
    for (double quad_px = 11.2; quad_px < 100; quad_px *= 1.25)
        expect(&scene, quad_px, 5, quad_px < 16 ? 60 : 15);
    scene_finish(&scene);
}

static void test_many_ridges(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, 8, 1, 2);
    for (double quad_px = 5; quad_px < 32; quad_px *= 1.6)
        expect(&scene, quad_px, 6, 80);
    scene_finish(&scene);
}

/* Mean light; 255 is white. */
static double brightness(const struct frame *frame, size_t n)
{
    const uint8_t(*colour)[4] = frame->plane[0];
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += 255 * srgb_to_linear(colour[i][0] / 255.0);
    return sum / (double)n;
}

/* More pixels show ridges than there is memory for all their rays: the mean brightness is the same,
 * and where only some rays have room, so is a repeated frame. */
static void test_fewer_rays(void **state)
{
    (void)state;
    /* room for four rays a pixel, for one, for none */
    static const uint32_t sides_px[] = {400, 600, 1100};
    struct scene scene;
    scene_init(&scene, 64, 1, 2);
    struct frame sampled = render(&scene, sides_px[0], sides_px[0], sides_px[0] / 64.0, 2);
    double truth = brightness(&sampled, 4 * (size_t)sides_px[0] * sides_px[0]);
    frame_finish(&sampled);
    for (size_t i = 0; i < sizeof sides_px / sizeof *sides_px; i++) {
        uint32_t side = sides_px[i];
        size_t n = (size_t)side * side;
        struct frame a = render(&scene, side, side, side / 64.0, 1);
        assert_float_equal(brightness(&a, n), truth, 1.5);
        if (i == 1) {
            struct frame again = render(&scene, side, side, side / 64.0, 1);
            assert_float_equal(brightness(&a, n), brightness(&again, n), 0.01);
            frame_finish(&again);
        }
        frame_finish(&a);
    }
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ridge),
                                       cmocka_unit_test(test_many_ridges),
                                       cmocka_unit_test(test_fewer_rays)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
