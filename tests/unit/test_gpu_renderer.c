/* The renderer alone: the pattern's colours, tables in several buffer textures, planes kept for a
 * change of the light, and requests that cannot be drawn. */
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
#include "tests/unit/renderer_frames.h"

/* Tables in several buffers give the same frame as in one. */
static void assert_cuts_do_not_show(const struct limit_tables *tables, size_t max_texels)
{
    struct frame_request request = request_for(tables, 320, 200);
    struct frame frame[2];
    for (int k = 0; k < 2; k++) {
        struct renderer *renderer = open_renderer(k ? max_texels : 0);
        struct renderer_model *model = upload(renderer, tables);
        frame[k] = render(renderer, model, &request);
        renderer_model_destroy(renderer, model);
        renderer_destroy(renderer);
    }
    assert_true(hits(&frame[0]) > 5000);
    assert_same_frames(&frame[0], &frame[1]);
    frame_finish(&frame[0]);
    frame_finish(&frame[1]);
}

static void test_point_textures(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/fender.obj", &tables);
    assert_cuts_do_not_show(&tables, tables.n_texels / 5 + 1);
    limit_tables_finish(&tables);
}

/* 144 regular faces: 2448 point texels, 432 node texels. */
static void test_node_textures(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_torus(12, &tables);
    assert_int_equal(tables.count[LIMIT_REGULAR], 144);
    assert_cuts_do_not_show(&tables, 307);
    limit_tables_finish(&tables);
}

static void test_too_few_texels(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/fender.obj", &tables);
    struct renderer *renderer = open_renderer(100);
    struct error error = {0};
    assert_null(renderer_model_create(renderer, &tables, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    assert_non_null(strstr(error.text, "texels"));
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* A change of the light runs stage 3 only, and gives the frame of a new renderer. */
static void test_light_only(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/body.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct frame_request request = request_for(&tables, 200, 120);
    struct frame first = render(renderer, model, &request);
    assert_true(first.times.evaluate_us > 0);
    frame_finish(&first);
    request.lights[0].centre[0] += 0.3;
    request.lights[0].pattern.kind = PATTERN_LATTICE;
    struct frame frame = render(renderer, model, &request);
    assert_int_equal(frame.times.visibility_us, 0);
    assert_int_equal(frame.times.evaluate_us, 0);

    struct frame_request moved = request;
    moved.camera.eye[0] += 1e-3;
    struct frame last = render(renderer, model, &moved);
    assert_true(last.times.evaluate_us > 0);
    frame_finish(&last);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);

    renderer =
        open_renderer(0); /* not before: its context replaces the first one's on this thread */
    model = upload(renderer, &tables);
    struct frame expected = render(renderer, model, &request);
    assert_same_frames(&frame, &expected);
    frame_finish(&frame);
    frame_finish(&expected);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* A plane mirror under an image of squares in two colours: away from the squares' borders, a pixel
 * has exactly its square's colour, and no other colour appears. */
static void test_image_pattern(void **state)
{
    (void)state;
    enum { SQUARES = 16, SIZE = 512 };
    static uint8_t texels[SIZE][SIZE][4];
    for (int y = 0; y < SIZE; y++)
        for (int x = 0; x < SIZE; x++) {
            bool red = (x / (SIZE / SQUARES) + y / (SIZE / SQUARES)) & 1;
            memcpy(texels[y][x], red ? "\377\0\0\377" : "\0\0\377\377", 4);
        }
    struct image image = {SIZE, SIZE, false, texels};
    struct error error = {0};
    struct limit_tables tables;
    build_file("tests/models/sheet.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct renderer_image *light = renderer_image_create(renderer, &image, &error);
    assert_non_null(light);
    struct frame_request request = request_for(&tables, 400, 300);
    request.lights[0].pattern.kind = PATTERN_IMAGE;
    request.lights[0].pattern.image = light;
    struct frame frame = render(renderer, model, &request);
    const uint8_t(*colour)[4] = frame.plane[0];
    const float(*st)[2] = frame.plane[4];
    size_t judged = 0;
    for (size_t k = 0; k < (size_t)400 * 300; k++) {
        if (!(st[k][0] > 0.05f && st[k][0] < 0.95f && st[k][1] > 0.05f && st[k][1] < 0.95f))
            continue;
        double sum = srgb_to_linear(colour[k][0] / 255.0) + srgb_to_linear(colour[k][2] / 255.0);
        assert_true(colour[k][1] == 0 && fabs(sum - 1) <= 0.01);
        double x = st[k][0] * SQUARES, y = (1 - st[k][1]) * SQUARES;
        double border = fmax(fabs(x - floor(x) - 0.5), fabs(y - floor(y) - 0.5));
        if (border > 0.2)
            continue;
        bool red = ((int)x + (int)y) & 1;
        if (abs(colour[k][0] - (red ? 255 : 0)) > 2)
            fail_msg("pixel %zu is %d in a square of %d", k, colour[k][0], red ? 255 : 0);
        judged++;
    }
    assert_true(judged > 1000);
    frame_finish(&frame);
    renderer_image_destroy(renderer, light);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* Where the reflected ray runs along the light's plane, the footprint becomes huge. Pixels that
 * miss the light by more than a few pixels show the colour `miss` and nothing else. */
static void test_no_ghost_of_the_light(void **state)
{
    (void)state;
    enum { WIDTH = 480, HEIGHT = 360, NEAR = 3 };
    struct limit_tables tables;
    build_file("tests/models/body.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct frame_request request = request_for(&tables, WIDTH, HEIGHT);
    struct frame frame = render(renderer, model, &request);
    const uint8_t(*colour)[4] = frame.plane[0];
    const float(*st)[2] = frame.plane[4];
    const uint32_t(*ptex)[3] = frame.plane[3];
    size_t judged = 0;
    for (int y = NEAR; y < HEIGHT - NEAR; y++) {
        for (int x = NEAR; x < WIDTH - NEAR; x++) {
            bool lit = false;
            for (int dy = -NEAR; dy <= NEAR; dy++)
                for (int dx = -NEAR; dx <= NEAR; dx++)
                    lit |= !isnan(st[(y + dy) * WIDTH + x + dx][0]);
            size_t k = (size_t)y * WIDTH + (size_t)x;
            if (lit || ptex[k][0] == UINT32_MAX)
                continue;
            if (colour[k][0] || colour[k][1] || colour[k][2])
                fail_msg("pixel %d,%d far from the light is %d, not black", x, y, colour[k][0]);
            judged++;
        }
    }
    assert_true(judged > 5000);
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* A fan of quads whose inner edges are collapsed into one point: S_u vanishes there, but each quad
 * still has a limit normal. */
static void test_collapsed_edges(void **state)
{
    (void)state;
    enum { SPOKES = 12, RINGS = 4 };
    static char text[1 << 14];
    size_t used = 0;
    for (int r = 0; r < RINGS; r++)
        for (int k = 0; k < SPOKES; k++) {
            double a = 6.283185307179586 * k / SPOKES;
            used += (size_t)snprintf(text + used, sizeof text - used, "v %.17g %.17g %.17g\n",
                                     r * cos(a), r * sin(a), -0.2 * r * r);
        }
    for (int r = 0; r + 1 < RINGS; r++)
        for (int k = 0; k < SPOKES; k++) {
            int a = r * SPOKES + k + 1, b = r * SPOKES + (k + 1) % SPOKES + 1;
            used += (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d %d\n", a,
                                     a + SPOKES, b + SPOKES, b);
        }
    struct limit_tables tables;
    build(text, used, &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    struct frame_request request = request_for(&tables, 301, 301);
    /* The middle of a pixel shows exactly the point. */
    request.camera = (struct camera){
        .kind = CAMERA_ORTHOGRAPHIC, .eye = {0, 0, 5}, .up = {0, 1, 0}, .ortho_height = 0.02};
    struct frame frame = render(renderer, model, &request);
    assert_int_equal(hits(&frame), 301 * 301);
    const float(*normal)[3] = frame.plane[2];
    for (size_t k = 0; k < 301 * 301; k++)
        if (!(normal[k][2] > 0.9f && normal[k][2] < 1.0001f))
            fail_msg("pixel %zu has normal z %g", k, normal[k][2]);
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

/* The pole of a sphere, so near that a derivative is lost to rounding: the normal is up, except for
 * the sphere's own curvature. */
static void test_pole(void **state)
{
    (void)state;
    enum { SIZE = 64 };
    struct renderer *renderer = open_renderer(0);
    for (int turned = 0; turned < 2; turned++) {
        struct limit_tables tables;
        build_octant(turned, &tables);
        struct renderer_model *model = upload(renderer, &tables);
        struct frame_request request = request_for(&tables, SIZE, SIZE);
        request.camera = (struct camera){
            .kind = CAMERA_ORTHOGRAPHIC, .eye = {0, 0, 5}, .up = {0, 1, 0}, .ortho_height = 1e-4};
        struct frame frame = render(renderer, model, &request);
        size_t n_hits = hits(&frame);
        if (n_hits < SIZE * SIZE / 5)
            fail_msg("%zu pixels hit", n_hits);
        const uint32_t(*ptex)[3] = frame.plane[3];
        const float(*normal)[3] = frame.plane[2];
        for (size_t k = 0; k < SIZE * SIZE; k++)
            if (ptex[k][0] != LIMIT_NO_FACE && !(hypotf(normal[k][0], normal[k][1]) < 2e-4f))
                fail_msg("pixel %zu: normal %g %g", k, normal[k][0], normal[k][1]);
        frame_finish(&frame);
        renderer_model_destroy(renderer, model);
        limit_tables_finish(&tables);
    }
    renderer_destroy(renderer);
}

static void test_refused_requests(void **state)
{
    (void)state;
    struct limit_tables tables;
    build_file("tests/models/tetra.obj", &tables);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &tables);
    const struct frame_request good = request_for(&tables, 64, 64);
    struct frame_request bad[] = {good, good, good, good, good, good, good, good, good};
    const char *const expected[] = {"size",       "size",  "same point", "up",  "fov",
                                    "eye is nan", "light", "count",      "duty"};
    bad[0].width_px = 0;
    bad[1].height_px = 100000;
    memcpy(bad[2].camera.target, bad[2].camera.eye, sizeof bad[2].camera.eye);
    for (int k = 0; k < 3; k++)
        bad[3].camera.up[k] = bad[3].camera.target[k] - bad[3].camera.eye[k];
    bad[4].camera.fov_deg = 180;
    bad[5].camera.eye[1] = NAN;
    memcpy(bad[6].lights[0].v, bad[6].lights[0].u, sizeof bad[6].lights[0].u);
    bad[7].lights[0].pattern.count = 0;
    bad[8].lights[0].pattern.duty = 2;
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        struct error error = {0};
        struct frame frame;
        assert_false(renderer_render(renderer, model, &bad[k], &frame, &error));
        assert_int_equal(error.kind, ERROR_REQUEST);
        if (!strstr(error.text, expected[k]))
            fail_msg("case %zu: '%s' does not name '%s'", k, error.text, expected[k]);
    }
    struct frame frame = render(renderer, model, &good);
    assert_true(hits(&frame) > 100);
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    limit_tables_finish(&tables);
}

static void test_unknown_devices(void **state)
{
    (void)state;
    struct error error = {0};
    assert_null(renderer_create(&gl_device, &(struct renderer_options){.device = "999"}, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    assert_null(renderer_create(&gl_device, &(struct renderer_options){.device = "gpu"}, &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_textures),
        cmocka_unit_test(test_node_textures),
        cmocka_unit_test(test_too_few_texels),
        cmocka_unit_test(test_light_only),
        cmocka_unit_test(test_image_pattern),
        cmocka_unit_test(test_no_ghost_of_the_light),
        cmocka_unit_test(test_pole),
        cmocka_unit_test(test_collapsed_edges),
        cmocka_unit_test(test_refused_requests),
        cmocka_unit_test(test_unknown_devices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
