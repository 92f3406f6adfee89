/* Frames drawn step by step: in tiles, in turn with other frames, given up, and with polygons that
 * the caller makes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/renderer_frames.h"

/* Across the border of two tiles every pixel shows the point that projects onto it. */
static void test_tiles(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/plane.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct frame_request request = request_for(&tables, 4200, 24);
    request.camera = (struct camera){.kind = CAMERA_ORTHOGRAPHIC,
                                     .eye = {0.1, 0, 5},
                                     .target = {0.1, 0, 0},
                                     .up = {0, 1, 0},
                                     .ortho_height = 24 * 1.2 / 4200};
    struct frame frame = render(renderer, model, &request);
    const float(*position)[3] = frame.plane[1];
    double unit = 1.2 / 4200;
    for (uint32_t y = 0; y < 24; y++) {
        for (uint32_t x = 0; x < 4200; x++) {
            const float *p = position[(size_t)y * 4200 + x];
            double off_x = (p[0] - 0.1) / unit + 2100 - (x + 0.5);
            double off_y = -p[1] / unit + 12 - (y + 0.5);
            if (!(fabs(off_x) < 0.01 && fabs(off_y) < 0.01))
                fail_msg("pixel %u,%u shows a point %g,%g px away", x, y, off_x, off_y);
        }
    }
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* Draws the next tile, after making what it needs. */
static enum frame_step draw_tile(struct renderer *renderer, struct renderer_model *model,
                                 struct frame_work *work, struct frame *frame, struct error *error)
{
    enum frame_step step;
    do
        step = renderer_step(renderer, model, work, frame, error);
    while (step == FRAME_MORE && !work->has_drawn);
    return step;
}

static struct frame render_in_tiles(struct renderer *renderer, struct renderer_model *model,
                                    const struct frame_request *request, uint64_t tile_px,
                                    unsigned *n_steps)
{
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = request, .tile_px = tile_px};
    enum frame_step step = FRAME_MORE;
    if (!renderer_begin(renderer, &work, &frame, &error))
        fail_msg("%s", error.text);
    for (*n_steps = 0; step == FRAME_MORE; ++*n_steps)
        step = draw_tile(renderer, model, &work, &frame, &error);
    if (step != FRAME_DONE)
        fail_msg("%s", error.text);
    return frame;
}

/* The largest difference of two frames in a float plane, where both show the surface. Only a few
 * pixels, which see a place without a normal, may show it in one of the frames alone. */
static double largest_difference(const struct frame *a, const struct frame *b, int plane)
{
    enum { MOST_ALONE = 6 };
    size_t n = (size_t)a->width_px * a->height_px *
               frame_plane_bytes((enum frame_plane)(1 << plane)) / sizeof(float);
    const float *x = a->plane[plane], *y = b->plane[plane];
    double largest = 0;
    size_t n_alone = 0;
    for (size_t k = 0; k < n; k++) {
        n_alone += isnan(x[k]) != isnan(y[k]);
        if (!isnan(x[k]) && !isnan(y[k]))
            largest = fmax(largest, fabs((double)x[k] - (double)y[k]));
    }
    assert_true(n_alone <= MOST_ALONE);
    return largest;
}

/* Polygons are interpolated, so the device's rounding shows more. */
static void assert_same_picture(const struct frame *a, const struct frame *b, bool exact,
                                double size)
{
    const uint8_t *x = a->plane[0], *y = b->plane[0];
    for (size_t k = 0; k < (size_t)a->width_px * a->height_px * 4; k++)
        if (abs(x[k] - y[k]) > 1)
            fail_msg("pixel %zu is %u and %u", k / 4, x[k], y[k]);
    assert_true(largest_difference(a, b, 1) < (exact ? 5e-6 : 2e-5) * size);
    assert_true(largest_difference(a, b, 2) < (exact ? 5e-5 : 3e-4));
    /* The place where a piece ends is stored in a few bits: rounding may move it by one step. */
    if (a->plane[7])
        assert_true(largest_difference(a, b, 7) < 1e-4);
}

/* However a frame is cut, every pixel is the same except for rounding, also at silhouettes, creases
 * and borders, where pixels use their neighbours. */
static void test_cuts_do_not_show(void **state)
{
    (void)state;
    static const char *const files[] = {"tests/models/body.obj", "tests/models/creases.obj",
                                        "tests/models/fender.obj"};
    struct renderer *renderer = open_renderer(0);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct limit_tables tables;
        build_file(files[i], &tables);
        struct renderer_model *model = upload(renderer, &tables);
        double size = 0;
        for (int k = 0; k < 3; k++)
            size = hypot(size, tables.box_max[k] - tables.box_min[k]);
        for (int kind = SURFACE_EXACT; kind <= SURFACE_WIREFRAME; kind++) {
            struct frame_request request = request_for(&tables, 701, 433);
            request.surface = (struct surface){(enum surface_kind)kind, kind ? 2 : 0};
            request.planes = PLANE_COLOUR | PLANE_POSITION | PLANE_NORMAL;
            request.planes |= kind == SURFACE_EXACT ? PLANE_COVERAGE : 0;
            struct frame whole = render(renderer, model, &request);
            static const uint64_t sizes[] = {1, 100000, 250000};
            for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
                unsigned n_steps;
                struct frame cut = render_in_tiles(renderer, model, &request, sizes[k], &n_steps);
                assert_int_equal(n_steps, k == 0 ? 24 : k == 1 ? 6 : 2);
                assert_same_picture(&whole, &cut, kind == SURFACE_EXACT, size);
                frame_finish(&cut);
            }
            frame_finish(&whole);
        }
        renderer_model_destroy(renderer, model);
        limit_tables_finish(&tables);
    }
    renderer_destroy(renderer);
}

/* Planes kept for a change of the light remain while another frame is drawn in tiles, and are not
 * mistaken for tiles. */
static void test_frames_interleave(void **state)
{
    (void)state;
    struct limit_tables tables, others;
    build_file("tests/models/body.obj", &tables);
    build_file("tests/models/fender.obj", &others);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables), *large = upload(renderer, &others);
    struct frame_request moving = request_for(&tables, 320, 200);
    struct frame_request batch = request_for(&others, 700, 500);
    unsigned n_steps;
    struct frame alone = render_in_tiles(renderer, large, &batch, 1, &n_steps);
    struct frame before = render(renderer, model, &moving);
    struct error error = {0};
    struct frame cut;
    struct frame_work work = {.request = &batch, .tile_px = 1};
    assert_true(renderer_begin(renderer, &work, &cut, &error));
    for (unsigned k = 0; k < n_steps; k++) {
        enum frame_step step = draw_tile(renderer, large, &work, &cut, &error);
        assert_int_equal(step, k + 1 < n_steps ? FRAME_MORE : FRAME_DONE);
        struct frame same = render(renderer, model, &moving);
        assert_int_equal(same.times.evaluate_us, 0);
        assert_same_frames(&before, &same);
        frame_finish(&same);
    }
    assert_same_frames(&alone, &cut);
    frame_finish(&cut);
    frame_finish(&alone);
    frame_finish(&before);
    renderer_model_destroy(renderer, model);
    renderer_model_destroy(renderer, large);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
    limit_tables_finish(&others);
}

struct countdown {
    int left;
};

static bool is_over(void *owner)
{
    struct countdown *countdown = owner;
    return countdown->left-- == 0;
}

/* A frame that is abandoned ends between two tiles or two lights, and the renderer draws the next
 * one. Making polygons ends between two faces. */
static void test_abandoned(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/body.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    for (int k = 0; k < 2; k++) {
        struct frame_request request = request_for(&tables, 300, 300);
        struct countdown countdown = {k == 0 ? 4 : 2};
        /* the question is asked at the start, and before the second of eight lights */
        if (k == 1) {
            request.n_lights = MAX_LIGHTS;
            for (int i = 1; i < MAX_LIGHTS; i++)
                request.lights[i] = request.lights[0];
        }
        struct frame frame = render(renderer, model, &request); /* its programs exist by then */
        frame_finish(&frame);
        struct frame_work work = {
            .request = &request, .tile_px = k == 0 ? 1 : 0, .watch = {is_over, &countdown}};
        struct error error = {0};
        enum frame_step step = FRAME_MORE;
        assert_true(renderer_begin(renderer, &work, &frame, &error));
        while (step == FRAME_MORE)
            step = renderer_step(renderer, model, &work, &frame, &error);
        assert_int_equal(step, FRAME_FAILED);
        assert_int_equal(error.kind, ERROR_SERVER);
        assert_int_equal(countdown.left, -1); /* the question was not asked again */
        assert_null(frame.plane[0]);
        frame = render(renderer, model, &request);
        assert_true(hits(&frame) > 1000);
        frame_finish(&frame);
    }
    struct countdown countdown = {30};
    const struct frame_watch watch = {is_over, &countdown};
    struct error error = {0};
    assert_null(renderer_polygons_create(&tables, 3, &watch, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    assert_int_equal(countdown.left, -1);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* Draws one frame of polygons and adds to *n_asked how often the renderer asked for them. */
static void draw_polygons(struct renderer *renderer, struct renderer_model *model,
                          const struct limit_tables *tables, uint32_t level, unsigned *n_asked)
{
    struct error error = {0};
    struct frame frame;
    struct frame_request request = request_for(tables, 64, 48);
    struct frame_work work = {.request = &request};
    struct renderer_polygons *polygons = NULL;
    request.surface = (struct surface){SURFACE_WIREFRAME, level};
    assert_true(renderer_begin(renderer, &work, &frame, &error));
    enum frame_step step = draw_tile(renderer, model, &work, &frame, &error);
    if (step == FRAME_POLYGONS) {
        ++*n_asked;
        polygons = renderer_polygons_create(tables, level, &work.watch, &error);
        work.polygons = polygons;
        step = FRAME_MORE;
    }
    while (step == FRAME_MORE)
        step = draw_tile(renderer, model, &work, &frame, &error);
    assert_int_equal(step, FRAME_DONE);
    assert_true(hits(&frame) > 100);
    renderer_polygons_destroy(polygons);
    frame_finish(&frame);
}

/* The device keeps 32 meshes. It asks the caller for a mesh that it does not have, and does not
 * make the mesh itself, because other frames would wait for that. */
static void test_polygons_are_asked_for(void **state)
{
    (void)state;
    enum { N_MODELS = 5, N_LEVELS = 7 };
    struct limit_tables tables;
    build_file("tests/models/tetra.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *models[N_MODELS];
    unsigned n_asked = 0;
    for (int i = 0; i < N_MODELS; i++) {
        models[i] = upload(renderer, &tables);
        for (uint32_t level = 0; level < N_LEVELS; level++) {
            draw_polygons(renderer, models[i], &tables, level, &n_asked);
            draw_polygons(renderer, models[i], &tables, level, &n_asked);
        }
    }
    assert_int_equal(n_asked, N_MODELS * N_LEVELS);
    draw_polygons(renderer, models[N_MODELS - 1], &tables, 0, &n_asked);
    assert_int_equal(n_asked, N_MODELS * N_LEVELS);
    draw_polygons(renderer, models[0], &tables, 0, &n_asked);
    assert_int_equal(n_asked, N_MODELS * N_LEVELS + 1);
    for (int i = 0; i < N_MODELS; i++)
        renderer_model_destroy(renderer, models[i]);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tiles),
        cmocka_unit_test(test_cuts_do_not_show),
        cmocka_unit_test(test_frames_interleave),
        cmocka_unit_test(test_abandoned),
        cmocka_unit_test(test_polygons_are_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
