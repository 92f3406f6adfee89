/* Frames of polygons drawn slice by slice are the same as frames drawn at once, whatever other
 * frames are drawn, given up, or removed from the device between slices. */
#include "tests/unit/polygon_scene.h"

#include <string.h>

#include "server/render/gl/polygon_kept.h"
#include "server/render/mesh.h"

enum { ONE_STROKE = 1 << 28 };

/* A frame that is being drawn. */
struct drawn {
    struct frame_request request;
    struct frame_work work;
    struct frame frame;
    struct renderer_polygons *polygons;
    struct error error;
    unsigned steps;
};

static void begin(struct scene *scene, struct drawn *drawn, const struct frame_request *request,
                  uint64_t tile_px)
{
    *drawn = (struct drawn){.request = *request};
    drawn->work = (struct frame_work){.request = &drawn->request, .tile_px = tile_px};
    assert_true(renderer_begin(scene->renderer, &drawn->work, &drawn->frame, &drawn->error));
}

/* One step, including programs and polygons that it asks for first. */
static enum frame_step step(struct scene *scene, struct drawn *drawn)
{
    enum frame_step step;
    do
        step = renderer_step(scene->renderer, scene->model, &drawn->work, &drawn->frame,
                             &drawn->error);
    while (step == FRAME_MORE && !drawn->work.has_drawn);
    if (step == FRAME_POLYGONS) {
        assert_null(drawn->polygons);
        drawn->polygons = renderer_polygons_create(&scene->tables, drawn->request.surface.level,
                                                   &drawn->work.watch, &drawn->error);
        assert_non_null(drawn->polygons);
        drawn->work.polygons = drawn->polygons;
        return FRAME_MORE;
    }
    drawn->steps++;
    return step;
}

static void draw(struct scene *scene, struct drawn *drawn, const struct frame_request *request,
                 uint64_t tile_px)
{
    enum frame_step next;
    begin(scene, drawn, request, tile_px);
    do
        next = step(scene, drawn);
    while (next == FRAME_MORE);
    if (next != FRAME_DONE)
        fail_msg("%s", drawn->error.text);
}

static void finish(struct drawn *drawn)
{
    frame_work_finish(&drawn->work);
    frame_finish(&drawn->frame);
    renderer_polygons_destroy(drawn->polygons);
}

static const enum surface_kind kinds[] = {SURFACE_POLYGON, SURFACE_WIREFRAME};
static const uint64_t tiles_px[] = {0, 128 * 128};

static struct frame_request polygons_of(const struct scene *scene, enum surface_kind kind,
                                        uint32_t level)
{
    struct frame_request request = request_for(scene);
    request.surface = (struct surface){kind, level};
    return request;
}

/* 73,728 triangles in 36 slices or more, uploaded in 5 chunks. */
static void test_same_picture(void **state)
{
    (void)state;
    static const size_t slices[] = {500, 2049, 20000};
    for (int k = 0; k < 4; k++) {
        struct drawn expected;
        struct scene scene;
        build_torus(12, &scene.tables);
        open_scene(&scene, ONE_STROKE);
        struct frame_request request = polygons_of(&scene, kinds[k % 2], 4);
        draw(&scene, &expected, &request, tiles_px[k / 2]);
        assert_int_equal(expected.steps, k / 2 ? 4 : 1);
        close_scene(&scene);
        for (size_t i = 0; i < sizeof slices / sizeof *slices; i++) {
            build_torus(12, &scene.tables);
            open_scene(&scene, slices[i]);
            struct drawn drawn;
            draw(&scene, &drawn, &request, tiles_px[k / 2]);
            printf("%zu triangles a step: %u steps\n", slices[i], drawn.steps);
            unsigned least = (unsigned)(73728 / (slices[i] + 2048));
            assert_true(drawn.steps >= least + (scene_device == &gl_device ? 3 : 1));
            assert_same(&expected.frame, &drawn.frame);
            finish(&drawn);
            /* After a change of the light, no polygon is drawn again, but edges are. */
            struct frame_request moved = request;
            moved.lights[0].centre[0] += 0.25;
            draw(&scene, &drawn, &moved, 0);
            if (!tiles_px[k / 2])
                assert_int_equal(drawn.frame.times.visibility_us, 0);
            finish(&drawn);
            close_scene(&scene);
        }
        finish(&expected);
    }
}

/* Four frames of polygons take turns, together with frames of the exact surface. */
static void test_frames_in_between(void **state)
{
    (void)state;
    struct drawn expected[4], drawn[4], between;
    struct frame_request request[4];
    struct scene scene;
    build_torus(12, &scene.tables);
    open_scene(&scene, ONE_STROKE);
    struct frame_request exact = request_for(&scene);
    for (int k = 0; k < 4; k++) {
        request[k] = polygons_of(&scene, kinds[k % 2], k < 3 ? 3 : 4);
        request[k].camera.eye[0] += 0.1 * k;
        draw(&scene, &expected[k], &request[k], tiles_px[k / 2]);
    }
    close_scene(&scene);
    build_torus(12, &scene.tables);
    open_scene(&scene, 2000);
    enum frame_step next[4] = {FRAME_MORE, FRAME_MORE, FRAME_MORE, FRAME_MORE};
    unsigned n = 0, under_way = 4;
    for (int k = 0; k < 4; k++)
        begin(&scene, &drawn[k], &request[k], tiles_px[k / 2]);
    draw(&scene, &between, &exact, 0);
    finish(&between);
    for (; under_way > 0; n++) {
        for (int k = 0; k < 4; k++)
            if (next[k] == FRAME_MORE) {
                next[k] = step(&scene, &drawn[k]);
                assert_true(next[k] == FRAME_MORE || next[k] == FRAME_DONE);
                under_way -= next[k] == FRAME_DONE;
            }
        draw(&scene, &between, &exact, tiles_px[n % 2]);
        finish(&between);
    }
    assert_true(n > 30);
    for (int k = 0; k < 4; k++) {
        assert_same(&expected[k].frame, &drawn[k].frame);
        finish(&expected[k]);
        finish(&drawn[k]);
    }
    close_scene(&scene);
}

/* Frames that are given up leave nothing behind. The number of frames at once is limited where they
 * share memory of the device. */
static void test_given_up(void **state)
{
    (void)state;
    struct drawn drawn[MAX_PAUSED_TILES], late;
    struct scene scene;
    build_torus(12, &scene.tables);
    open_scene(&scene, 2000);
    struct frame_request request = polygons_of(&scene, SURFACE_POLYGON, 3);
    request.width_px = request.height_px = 32;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < MAX_PAUSED_TILES; i++) {
            begin(&scene, &drawn[i], &request, 0);
            assert_int_equal(step(&scene, &drawn[i]), FRAME_MORE);
            if (drawn[i].polygons)
                assert_int_equal(step(&scene, &drawn[i]), FRAME_MORE);
        }
        begin(&scene, &late, &request, 0);
        enum frame_step next = step(&scene, &late);
        if (late.polygons)
            next = step(&scene, &late);
        if (scene_device == &gl_device) {
            assert_int_equal(next, FRAME_FAILED);
            assert_int_equal(late.error.kind, ERROR_SERVER);
            assert_non_null(strstr(late.error.text, "24 other frames of polygons"));
        } else { /* each frame has memory of its own */
            assert_int_equal(next, FRAME_MORE);
        }
        finish(&late);
        for (int i = 0; i < MAX_PAUSED_TILES; i++)
            finish(&drawn[i]);
    }
    draw(&scene, &late, &request, 0);
    finish(&late);
    request.camera.eye[0] += 0.1;
    begin(&scene, &late, &request, 0);
    assert_int_equal(step(&scene, &late), FRAME_MORE);
    close_scene(&scene);
    assert_non_null(late.work.state);
    finish(&late); /* after its renderer, as when the daemon ends */
}

/* The device keeps 32 meshes, among them all that unfinished frames use. */
static void test_mesh_stays(void **state)
{
    (void)state;
    enum { N_MODELS = 6 };
    struct drawn first, other;
    struct renderer_model *models[N_MODELS];
    struct scene scene;
    struct error error = {0};
    build_torus(12, &scene.tables);
    open_scene(&scene, 2000);
    struct frame_request request = polygons_of(&scene, SURFACE_POLYGON, 3);
    draw(&scene, &first, &request, 0);
    finish(&first);
    request.camera.eye[0] += 0.1;
    begin(&scene, &first, &request, 0);
    assert_int_equal(step(&scene, &first), FRAME_MORE);
    struct renderer_model *own = scene.model;
    for (int i = 0; i < N_MODELS; i++) {
        scene.model = models[i] = renderer_model_create(scene.renderer, &scene.tables, &error);
        assert_non_null(models[i]);
        for (uint32_t level = 0; level < 6; level++) {
            struct frame_request small = polygons_of(&scene, SURFACE_POLYGON, level);
            draw(&scene, &other, &small, 0);
            finish(&other);
        }
    }
    scene.model = own;
    enum frame_step next;
    do
        next = step(&scene, &first);
    while (next == FRAME_MORE);
    assert_int_equal(next, FRAME_DONE);
    assert_null(first.polygons); /* it never had to ask for its mesh again */
    finish(&first);
    for (int i = 0; i < N_MODELS; i++)
        renderer_model_destroy(scene.renderer, models[i]);
    close_scene(&scene);
}

static double share_of_same_faces(const struct frame *a, const struct frame *b)
{
    const uint32_t(*p)[3] = a->plane[3], (*q)[3] = b->plane[3];
    size_t n = 0, same = 0;
    for (size_t k = 0; k < (size_t)a->width_px * a->height_px; k++) {
        n += q[k][0] != UINT32_MAX;
        same += p[k][0] == q[k][0] && q[k][0] != UINT32_MAX;
    }
    assert_true(n > 1000);
    return (double)same / (double)n;
}

/* Polygons outside the picture are not drawn, and no others are left out: from inside the torus,
 * where most of it is beside and behind the eye, from near, and in tiles, polygons show wherever
 * the surface does. */
static void test_nothing_is_left_out(void **state)
{
    (void)state;
    static const struct camera cameras[] = {
        {.eye = {2, 0, 0}, .target = {2, 1, 0.1}, .up = {0, 0, 1}, .fov_deg = 70},
        {.eye = {0, 0, 0.1}, .target = {3, 1, 0}, .up = {0, 0, 1}, .fov_deg = 100},
        {.eye = {0, -5, 4}, .target = {0.5, -2, 1}, .up = {0, 0, 1}, .fov_deg = 3},
        {.kind = CAMERA_ORTHOGRAPHIC,
         .eye = {5, 5, 5},
         .target = {1, 1, 0},
         .up = {0, 0, 1},
         .ortho_height = 1},
    };
    struct scene scene;
    struct drawn exact, drawn;
    build_torus(24, &scene.tables);
    open_scene(&scene, 5000);
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++)
        for (size_t k = 0; k < 2; k++) {
            struct frame_request request = request_for(&scene);
            request.camera = cameras[i];
            draw(&scene, &exact, &request, 0);
            request.surface = (struct surface){SURFACE_POLYGON, 5};
            draw(&scene, &drawn, &request, tiles_px[k]);
            double share = share_of_same_faces(&drawn.frame, &exact.frame);
            printf("camera %zu: %.4f of the pixels show their face, %u steps\n", i, share,
                   drawn.steps);
            assert_true(share > 0.99);
            finish(&exact);
            finish(&drawn);
        }
    close_scene(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_picture),
        cmocka_unit_test(test_frames_in_between),
        cmocka_unit_test(test_given_up),
        cmocka_unit_test(test_mesh_stays),
        cmocka_unit_test(test_nothing_is_left_out),
    };
    RETURN_FAILED_ON_BOTH_DEVICES(tests);
}
