/* The renderer by itself: the pattern's colours, tables spread over several buffer textures, frames
 * of several tiles, the planes kept for a light-only change, and requests that cannot be rendered.
 */
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

struct scene {
    struct cage cage;
    struct limit_tables tables;
};

static void scene_read(struct scene *scene, const char *bytes, size_t size)
{
    struct error error = {0};
    if (!cage_read(&scene->cage, bytes, size, "scene.obj", &error))
        fail_msg("%s", error.text);
    struct limit_plan *plan = limit_plan_create(&scene->cage, NULL, &error);
    assert_non_null(plan);
    assert_true(limit_tables_init(&scene->tables, plan, &error));
    assert_true(limit_build_faces(&scene->tables, plan, 0, scene->tables.n_faces, NULL, &error));
    limit_plan_destroy(plan);
}

static void scene_init(struct scene *scene, const char *path)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    static char bytes[1 << 20];
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    scene_read(scene, bytes, size);
}

/* A torus of n x n quads: regular patches only. */
static void scene_init_torus(struct scene *scene, unsigned n)
{
    static char text[1 << 16];
    size_t used = 0;
    for (unsigned k = 0; k < n * n; k++) {
        double a = 6.283185307179586 * (k / n) / n, b = 6.283185307179586 * (k % n) / n;
        double r = 2 + cos(b);
        used += (size_t)snprintf(text + used, sizeof text - used, "v %.17g %.17g %.17g\n",
                                 r * cos(a), r * sin(a), sin(b));
    }
    for (unsigned k = 0; k < n * n; k++) {
        unsigned i = k / n, j = k % n, i2 = (i + 1) % n, j2 = (j + 1) % n;
        used += (size_t)snprintf(text + used, sizeof text - used, "f %u %u %u %u\n", i * n + j + 1,
                                 i2 * n + j + 1, i2 * n + j2 + 1, i * n + j2 + 1);
    }
    scene_read(scene, text, used);
}

static void scene_finish(struct scene *scene)
{
    limit_tables_finish(&scene->tables);
    cage_finish(&scene->cage);
}

static struct renderer *open_renderer(size_t max_texels)
{
    struct error error = {0};
    struct renderer_options options = {.device = "auto", .max_texels = max_texels};
    struct renderer *renderer = renderer_create(&options, &error);
    if (!renderer)
        fail_msg("%s", error.text);
    return renderer;
}

static struct frame_request request_for(const struct scene *scene, uint32_t width, uint32_t height)
{
    struct frame_request request = {
        .width_px = width,
        .height_px = height,
        .n_lights = 1,
        .lights = {{.pattern = {.kind = PATTERN_STRIPES,
                                .count = 40,
                                .duty = 0.5,
                                .opacity = 1,
                                .foreground = {1, 1, 1, 1},
                                .background = {0, 0, 0, 1}}}},
        .planes = PLANE_COLOUR | PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX | PLANE_LIGHT,
    };
    const double *low = scene->tables.box_min, *high = scene->tables.box_max;
    renderer_default_camera(low, high, width, height, &request.camera);
    renderer_default_light(low, high, &request.camera, &request.lights[0]);
    return request;
}

static struct frame render(struct renderer *renderer, struct renderer_model *model,
                           const struct frame_request *request)
{
    struct error error = {0};
    struct frame frame;
    if (!renderer_render(renderer, model, request, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

static struct renderer_model *upload(struct renderer *renderer, const struct scene *scene)
{
    struct error error = {0};
    struct renderer_model *model = renderer_model_create(renderer, &scene->tables, &error);
    if (!model)
        fail_msg("%s", error.text);
    return model;
}

static void assert_same_frames(const struct frame *a, const struct frame *b)
{
    size_t pixels = (size_t)a->width_px * a->height_px;
    for (int p = 0; p < PLANE_COUNT; p++) {
        assert_int_equal(a->plane[p] != NULL, b->plane[p] != NULL);
        size_t bytes = pixels * renderer_plane_bytes((enum renderer_plane)(1 << p));
        if (a->plane[p] && memcmp(a->plane[p], b->plane[p], bytes) != 0)
            fail_msg("plane %d differs", p);
    }
}

static size_t hits(const struct frame *frame)
{
    const uint32_t(*ptex)[3] = frame->plane[3];
    size_t n = 0;
    for (size_t k = 0; k < (size_t)frame->width_px * frame->height_px; k++)
        n += ptex[k][0] != UINT32_MAX;
    return n;
}

/* Tables spread over several buffers give the same frame. */
static void assert_banks_do_not_show(const struct scene *scene, size_t max_texels)
{
    struct frame_request request = request_for(scene, 320, 200);
    struct frame frame[2];
    for (int k = 0; k < 2; k++) {
        struct renderer *renderer = open_renderer(k ? max_texels : 0);
        struct renderer_model *model = upload(renderer, scene);
        frame[k] = render(renderer, model, &request);
        renderer_model_destroy(renderer, model);
        renderer_destroy(renderer);
    }
    assert_true(hits(&frame[0]) > 5000);
    assert_same_frames(&frame[0], &frame[1]);
    frame_finish(&frame[0]);
    frame_finish(&frame[1]);
}

static void test_point_banks(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/fender.obj");
    assert_banks_do_not_show(&scene, scene.tables.n_texels / 5 + 1);
    scene_finish(&scene);
}

/* 144 regular faces: 2448 point texels, 432 node texels. */
static void test_node_banks(void **state)
{
    (void)state;
    struct scene scene;
    scene_init_torus(&scene, 12);
    assert_int_equal(scene.tables.n_regular, 144);
    assert_banks_do_not_show(&scene, 307);
    scene_finish(&scene);
}

static void test_too_few_texels(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/fender.obj");
    struct renderer *renderer = open_renderer(100);
    struct error error = {0};
    assert_null(renderer_model_create(renderer, &scene.tables, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    assert_non_null(strstr(error.text, "texels"));
    renderer_destroy(renderer);
    scene_finish(&scene);
}

/* Across the border of two tiles every pixel still shows the point that projects onto it. */
static void test_tiles(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/plane.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    struct frame_request request = request_for(&scene, 4200, 24);
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
    scene_finish(&scene);
}

/* The next tile, and whatever has to be made ready for it. */
static enum frame_step draw_tile(struct renderer *renderer, struct renderer_model *model,
                                 struct frame_work *work, struct frame *frame, struct error *error)
{
    enum frame_step step;
    do
        step = renderer_step(renderer, model, work, frame, error);
    while (step == FRAME_PROGRAM);
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

/* How far two frames are apart in a float plane where both show something. Only a pixel or two,
 * which look at a place without a normal, may show it in one of them alone. */
static double largest_difference(const struct frame *a, const struct frame *b, int plane)
{
    enum { MOST_ALONE = 6 };
    size_t n = (size_t)a->width_px * a->height_px *
               renderer_plane_bytes((enum renderer_plane)(1 << plane)) / sizeof(float);
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

/* Polygons are interpolated: there the device's rounding shows more. */
static void assert_same_picture(const struct frame *a, const struct frame *b, bool exact,
                                double size)
{
    const uint8_t *x = a->plane[0], *y = b->plane[0];
    for (size_t k = 0; k < (size_t)a->width_px * a->height_px * 4; k++)
        if (abs(x[k] - y[k]) > 1)
            fail_msg("pixel %zu is %u and %u", k / 4, x[k], y[k]);
    assert_true(largest_difference(a, b, 1) < (exact ? 5e-6 : 2e-5) * size);
    assert_true(largest_difference(a, b, 2) < (exact ? 5e-5 : 3e-4));
    if (a->plane[7])
        assert_true(largest_difference(a, b, 7) < 1e-5);
}

/* However a frame is cut, every pixel shows the same but for rounding: at silhouettes, creases and
 * borders too, whose pixels look at their neighbours. */
static void test_cuts_do_not_show(void **state)
{
    (void)state;
    static const char *const files[] = {"tests/models/body.obj", "tests/models/creases.obj",
                                        "tests/models/fender.obj"};
    struct renderer *renderer = open_renderer(0);
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        struct scene scene;
        scene_init(&scene, files[i]);
        struct renderer_model *model = upload(renderer, &scene);
        double size = 0;
        for (int k = 0; k < 3; k++)
            size = hypot(size, scene.tables.box_max[k] - scene.tables.box_min[k]);
        for (int kind = SURFACE_EXACT; kind <= SURFACE_WIREFRAME; kind++) {
            struct frame_request request = request_for(&scene, 701, 433);
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
        scene_finish(&scene);
    }
    renderer_destroy(renderer);
}

/* Planes that are kept for a change of light outlive the tiles of another frame drawn in between,
 * and tiles are not taken for them. */
static void test_frames_interleave(void **state)
{
    (void)state;
    struct scene scene, other;
    scene_init(&scene, "tests/models/body.obj");
    scene_init(&other, "tests/models/fender.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene), *large = upload(renderer, &other);
    struct frame_request moving = request_for(&scene, 320, 200);
    struct frame_request batch = request_for(&other, 700, 500);
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
    scene_finish(&scene);
    scene_finish(&other);
}

struct countdown {
    int left;
};

static bool is_over(void *owner)
{
    struct countdown *countdown = owner;
    return countdown->left-- == 0;
}

/* A frame that nobody waits for ends between tiles and between lights; the renderer serves the
 * next. Polygons end between two faces. */
static void test_abandoned(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/body.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    for (int k = 0; k < 2; k++) {
        struct frame_request request = request_for(&scene, 300, 300);
        struct countdown countdown = {k == 0 ? 4 : 2};
        struct frame frame = render(renderer, model, &request); /* whose programs are there then */
        frame_finish(&frame);
        if (k == 1) { /* asked at the start, and before the second of eight lights */
            request.n_lights = MAX_LIGHTS;
            for (int i = 1; i < MAX_LIGHTS; i++)
                request.lights[i] = request.lights[0];
        }
        struct frame_work work = {
            .request = &request, .tile_px = k == 0 ? 1 : 0, .watch = {is_over, &countdown}};
        struct error error = {0};
        enum frame_step step = FRAME_MORE;
        assert_true(renderer_begin(renderer, &work, &frame, &error));
        while (step == FRAME_MORE)
            step = renderer_step(renderer, model, &work, &frame, &error);
        assert_int_equal(step, FRAME_FAILED);
        assert_int_equal(error.kind, ERROR_SERVER);
        assert_int_equal(countdown.left, -1); /* and nobody was asked again */
        assert_null(frame.plane[0]);
        frame = render(renderer, model, &request);
        assert_true(hits(&frame) > 1000);
        frame_finish(&frame);
    }
    struct countdown countdown = {30};
    const struct frame_watch watch = {is_over, &countdown};
    struct error error = {0};
    assert_null(renderer_polygons_create(&scene.tables, 3, &watch, &error));
    assert_int_equal(error.kind, ERROR_SERVER);
    assert_int_equal(countdown.left, -1);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    scene_finish(&scene);
}

/* One frame of polygons; how often the renderer asked for them is added to *n_asked. */
static void draw_polygons(struct renderer *renderer, struct renderer_model *model,
                          const struct scene *scene, uint32_t level, unsigned *n_asked)
{
    struct error error = {0};
    struct frame frame;
    struct frame_request request = request_for(scene, 64, 48);
    struct frame_work work = {.request = &request};
    struct renderer_polygons *polygons = NULL;
    request.surface = (struct surface){SURFACE_WIREFRAME, level};
    assert_true(renderer_begin(renderer, &work, &frame, &error));
    enum frame_step step = draw_tile(renderer, model, &work, &frame, &error);
    if (step == FRAME_POLYGONS) {
        ++*n_asked;
        polygons = renderer_polygons_create(&scene->tables, level, &work.watch, &error);
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

/* The device keeps 32 meshes. It asks for one that it has not, or not any more, and makes none by
 * itself: whoever else wants a frame would wait for it. */
static void test_polygons_are_asked_for(void **state)
{
    (void)state;
    enum { N_MODELS = 5, N_LEVELS = 7 };
    struct scene scene;
    scene_init(&scene, "tests/models/tetra.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *models[N_MODELS];
    unsigned n_asked = 0;
    for (int i = 0; i < N_MODELS; i++) {
        models[i] = upload(renderer, &scene);
        for (uint32_t level = 0; level < N_LEVELS; level++) {
            draw_polygons(renderer, models[i], &scene, level, &n_asked);
            draw_polygons(renderer, models[i], &scene, level, &n_asked);
        }
    }
    assert_int_equal(n_asked, N_MODELS * N_LEVELS);
    draw_polygons(renderer, models[N_MODELS - 1], &scene, 0, &n_asked);
    assert_int_equal(n_asked, N_MODELS * N_LEVELS);
    draw_polygons(renderer, models[0], &scene, 0, &n_asked);
    assert_int_equal(n_asked, N_MODELS * N_LEVELS + 1);
    for (int i = 0; i < N_MODELS; i++)
        renderer_model_destroy(renderer, models[i]);
    renderer_destroy(renderer);
    scene_finish(&scene);
}

/* A light-only change runs no other stage, and gives the frame that a fresh renderer gives. */
static void test_light_only(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/body.obj");
    struct renderer *renderer = open_renderer(0), *fresh = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene), *again = upload(fresh, &scene);
    struct frame_request request = request_for(&scene, 200, 120);
    struct frame frame = render(renderer, model, &request);
    assert_true(frame.times.evaluate_us > 0);
    frame_finish(&frame);
    request.lights[0].centre[0] += 0.3;
    request.lights[0].pattern.kind = PATTERN_LATTICE;
    frame = render(renderer, model, &request);
    assert_int_equal(frame.times.visibility_us, 0);
    assert_int_equal(frame.times.evaluate_us, 0);
    struct frame expected = render(fresh, again, &request);
    assert_same_frames(&frame, &expected);
    frame_finish(&frame);
    frame_finish(&expected);

    request.camera.eye[0] += 1e-3;
    frame = render(renderer, model, &request);
    assert_true(frame.times.evaluate_us > 0);
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_model_destroy(fresh, again);
    renderer_destroy(renderer);
    renderer_destroy(fresh);
    scene_finish(&scene);
}

/* A plane mirror under an image of two colours in squares: away from a square's border its colour
 * is exactly that square's, and no other colour appears. */
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
    struct image image = {SIZE, SIZE, false, false, texels};
    struct error error = {0};
    struct scene scene;
    scene_init(&scene, "tests/models/sheet.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    struct renderer_image *light = renderer_image_create(renderer, &image, &error);
    assert_non_null(light);
    struct frame_request request = request_for(&scene, 400, 300);
    request.lights[0].pattern.kind = PATTERN_IMAGE;
    request.lights[0].pattern.image = light;
    struct frame frame = render(renderer, model, &request);
    const uint8_t(*colour)[4] = frame.plane[0];
    const float(*st)[2] = frame.plane[4];
    size_t judged = 0;
    for (size_t k = 0; k < (size_t)400 * 300; k++) {
        if (!(st[k][0] > 0.05f && st[k][0] < 0.95f && st[k][1] > 0.05f && st[k][1] < 0.95f))
            continue;
        assert_true(colour[k][1] == 0 && abs(colour[k][0] + colour[k][2] - 255) <= 2);
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
    scene_finish(&scene);
}

/* Where the reflected ray runs along the light's plane the footprint explodes: what misses the
 * light by more than a few pixels shows the colour of a miss and nothing else. */
static void test_no_ghost_of_the_light(void **state)
{
    (void)state;
    enum { WIDTH = 480, HEIGHT = 360, NEAR = 3 };
    struct scene scene;
    scene_init(&scene, "tests/models/body.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    struct frame_request request = request_for(&scene, WIDTH, HEIGHT);
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
                fail_msg("pixel %d,%d far from the light is not black", x, y);
            judged++;
        }
    }
    assert_true(judged > 5000);
    frame_finish(&frame);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    scene_finish(&scene);
}

/* A fan of quads whose inner edges are collapsed into one point: S_u vanishes there, and each quad
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
    struct scene scene;
    scene_read(&scene, text, used);
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    struct frame_request request = request_for(&scene, 301, 301);
    /* The middle of a pixel looks straight at the point. */
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
    scene_finish(&scene);
}

static void test_refused_requests(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, "tests/models/tetra.obj");
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, &scene);
    const struct frame_request good = request_for(&scene, 64, 64);
    struct frame_request bad[] = {good, good, good, good, good, good, good, good, good};
    const char *const expected[] = {"size",   "size",  "same point", "up",  "fov",
                                    "finite", "light", "count",      "duty"};
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
    scene_finish(&scene);
}

static void test_unknown_devices(void **state)
{
    (void)state;
    struct error error = {0};
    assert_null(renderer_create(&(struct renderer_options){.device = "999"}, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    assert_null(renderer_create(&(struct renderer_options){.device = "gpu"}, &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_banks),
        cmocka_unit_test(test_node_banks),
        cmocka_unit_test(test_too_few_texels),
        cmocka_unit_test(test_tiles),
        cmocka_unit_test(test_cuts_do_not_show),
        cmocka_unit_test(test_frames_interleave),
        cmocka_unit_test(test_abandoned),
        cmocka_unit_test(test_polygons_are_asked_for),
        cmocka_unit_test(test_light_only),
        cmocka_unit_test(test_image_pattern),
        cmocka_unit_test(test_no_ghost_of_the_light),
        cmocka_unit_test(test_collapsed_edges),
        cmocka_unit_test(test_refused_requests),
        cmocka_unit_test(test_unknown_devices),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
