/* Semi-sharp creases whose rounding is narrower than a pixel, about as wide, and wider: what a
 * pixel there shows is the mean over the pixel, as exact samples of it say. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/gpu/renderer.h"

enum { WIDTH = 96, HEIGHT = 64, SIDE = 8 }; /* SIDE x SIDE samples a pixel */

struct scene {
    struct cage cage;
    struct limit_tables tables;
    struct renderer *renderer;
    struct renderer_model *model;
};

/* A sheet of unit quads, 8 x 8, folded every `ridge` quads along creases: rounded over 2^-sharpness
 * of a quad on either side. */
static void scene_init(struct scene *scene, int ridge, double sharpness)
{
    struct error error = {0};
    static char text[1 << 14];
    size_t used = 0;
    for (int k = 0; k < 81; k++)
        used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d %g\n", k % 9 - 4,
                                 k / 9 - 4, -0.7 * abs(k % 9 % (2 * ridge) - ridge));
    for (int k = 0; k < 64; k++) {
        int a = k / 8 * 9 + k % 8 + 1;
        used += (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d %d\n", a, a + 1,
                                 a + 10, a + 9);
    }
    for (int k = 0; k < 8; k++)
        for (int x = ridge; x < 8; x += ridge)
            used += (size_t)snprintf(text + used, sizeof text - used, "t crease 2/1/0 %d %d %g\n",
                                     k * 9 + x, k * 9 + 9 + x, sharpness);
    *scene = (struct scene){0};
    assert_true(cage_read(&scene->cage, text, used, "roof.obj", &error));
    struct limit_plan *plan = limit_plan_create(&scene->cage, &error);
    assert_non_null(plan);
    assert_true(limit_tables_init(&scene->tables, plan, &error));
    assert_true(limit_build_faces(&scene->tables, plan, 0, scene->tables.n_faces, &error));
    limit_plan_destroy(plan);
    const struct renderer_options options = {.device = "auto"};
    scene->renderer = renderer_create(&options, &error);
    if (!scene->renderer)
        fail_msg("%s", error.text);
    scene->model = renderer_model_create(scene->renderer, &scene->tables, &error);
    assert_non_null(scene->model);
}

static void scene_finish(struct scene *scene)
{
    renderer_model_destroy(scene->renderer, scene->model);
    renderer_destroy(scene->renderer);
    limit_tables_finish(&scene->tables);
    cage_finish(&scene->cage);
}

/* The ridge from above, aslant, `quad_px` pixels a quad; or in SIDE times the pixels, one sample
 * each. */
static struct frame render(const struct scene *scene, double quad_px, bool samples)
{
    struct error error = {0};
    uint32_t scale = samples ? SIDE : 1;
    const struct frame_request request = {
        .width_px = WIDTH * scale,
        .height_px = HEIGHT * scale,
        .camera = {.kind = CAMERA_ORTHOGRAPHIC,
                   .eye = {0.1, -1, 8},
                   .up = {0.35, 1, 0},
                   .ortho_height = HEIGHT / quad_px},
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
        .unfiltered = samples,
    };
    struct frame frame;
    if (!renderer_render(scene->renderer, scene->model, &request, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

/* The mean error over the pixels that show ridge, 1/255, and the largest. */
static void compare(const struct scene *scene, double quad_px, double *mean, double *largest)
{
    struct frame shown = render(scene, quad_px, false), sampled = render(scene, quad_px, true);
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
            truth += value / (double)(SIDE * SIDE);
            least = value < least ? value : least;
            most = value > most ? value : most;
        }
        if (least == most)
            continue;
        double off = fabs(colour[i][0] - truth);
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

/* Rounded over a sixteenth of a quad: from 0.7 px on. From 1 px on no side of it is a border. */
static void test_ridge(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, 4, 4);
    for (double quad_px = 11.2; quad_px < 100; quad_px *= 1.25)
        expect(&scene, quad_px, 5, quad_px < 16 ? 60 : 15);
    scene_finish(&scene);
}

/* More ridges than there is memory for all rays of: still near, and the same each time. */
static void test_many_ridges(void **state)
{
    (void)state;
    static const double quads_px[] = {5, 8, 16, 24};
    struct scene scene;
    scene_init(&scene, 1, 2);
    for (size_t i = 0; i < sizeof quads_px / sizeof *quads_px; i++) {
        expect(&scene, quads_px[i], i == 0 ? 30 : 4, 80);
        struct frame a = render(&scene, quads_px[i], false), b = render(&scene, quads_px[i], false);
        assert_memory_equal(a.plane[0], b.plane[0], (size_t)4 * WIDTH * HEIGHT);
        frame_finish(&a);
        frame_finish(&b);
    }
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ridge),
                                       cmocka_unit_test(test_many_ridges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
