/* The share of visible surface that meets a light, against planes that tell it pixel by pixel. The
 * default light is met everywhere. */
#include "tests/unit/renderer_frames.h"

static void scene_init(struct scene *scene, const char *path)
{
    build_file(path, &scene->tables);
    scene->renderer = open_renderer(0);
    scene->model = upload(scene->renderer, &scene->tables);
}

static struct frame render_tiled(const struct scene *scene, const struct frame_request *request,
                                 uint64_t tile_px)
{
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = request, .tile_px = tile_px};
    enum frame_step step;
    if (!renderer_begin(scene->renderer, &work, &frame, &error))
        fail_msg("%s", error.text);
    do
        step = renderer_step(scene->renderer, scene->model, &work, &frame, &error);
    while (step == FRAME_MORE);
    assert_int_equal(step, FRAME_DONE);
    return frame;
}

/* Marks where the first light is met. */
static void mark_met(const struct scene *scene, const struct frame_request *request, uint8_t *met)
{
    struct frame frame = render(scene->renderer, scene->model, request);
    const float(*light)[2] = frame.plane[4];
    for (size_t k = 0; k < (size_t)request->width_px * request->height_px; k++)
        met[k] |= !isnan(light[k][0]);
    frame_finish(&frame);
}

/* The number of pixels that meet any of the request's lights, by the planes of requests in which
 * each light stands first. */
static uint64_t count_met(const struct scene *scene, const struct frame_request *request)
{
    size_t pixels = (size_t)request->width_px * request->height_px;
    uint8_t *met = calloc(pixels, 1);
    uint64_t n = 0;
    assert_non_null(met);
    for (uint32_t i = 0; i < request->n_lights; i++) {
        struct frame_request turned = *request;
        turned.lights[0] = request->lights[i];
        turned.lights[i] = request->lights[0];
        mark_met(scene, &turned, met);
    }
    for (size_t k = 0; k < pixels; k++)
        n += met[k];
    free(met);
    return n;
}

static struct frame_request request_of(const struct scene *scene, uint32_t width, uint32_t height,
                                       const enum light_kind *kinds, uint32_t n_lights)
{
    struct frame_request request = request_for(&scene->tables, width, height);
    request.count_light = true;
    request.n_lights = n_lights;
    for (uint32_t i = 0; i < n_lights; i++) {
        request.lights[i] = request.lights[0];
        request.lights[i].kind = kinds[i];
        scene_default_light(scene->tables.box_min, scene->tables.box_max, NULL, &request.lights[i]);
    }
    return request;
}

/* The count is exact to the pixel: in one piece and in tiles, with one light and with two. */
static void test_counts(void **state)
{
    (void)state;
    static const enum light_kind kinds[][2] = {{LIGHT_RECTANGLE, LIGHT_TUNNEL},
                                               {LIGHT_PLANE, LIGHT_RECTANGLE},
                                               {LIGHT_TUNNEL, LIGHT_PLANE}};
    struct scene scene;
    int n_parts = 0;
    scene_init(&scene, "tests/models/body.obj");
    for (size_t i = 0; i < 3; i++)
        for (uint32_t n = 1; n <= 2; n++)
            for (int family = LINES_REFLECTION; family <= LINES_HIGHLIGHT; family++) {
                struct frame_request request = request_of(&scene, 241, 163, kinds[i], n);
                request.lines.family = (enum line_family)family;
                for (int k = 0; k < 3; k++) { /* to one side, so that many rays miss it */
                    request.lights[0].centre[k] += 0.4 * request.lights[0].v[k];
                    request.lights[0].u[k] *= 0.2;
                }
                request.lights[0].one_sided = kinds[i][0] != LIGHT_TUNNEL;
                uint64_t met = count_met(&scene, &request);
                for (int tiled = 0; tiled < 2; tiled++) {
                    struct frame frame = render_tiled(&scene, &request, tiled ? 128 * 128 : 0);
                    assert_int_equal(frame.seen_px, hits(&frame));
                    assert_int_equal(frame.met_px, met);
                    n_parts += met > 0 && met < frame.seen_px;
                    frame_finish(&frame);
                }
            }
    assert_true(n_parts >= 6); /* some pixels, but not all */
    scene_finish(&scene);
}

/* In a large frame a sample of the pixels stands for all. */
static void test_large(void **state)
{
    (void)state;
    static const enum light_kind kind = LIGHT_RECTANGLE;
    struct scene scene;
    scene_init(&scene, "tests/models/body.obj");
    struct frame_request request = request_of(&scene, 800, 600, &kind, 1);
    struct frame frame = render(scene.renderer, scene.model, &request);
    double seen = (double)hits(&frame), share = (double)count_met(&scene, &request) / seen;
    assert_true(fabs((double)frame.seen_px / seen - 0.125) < 0.002);
    assert_true(fabs((double)frame.met_px / (double)frame.seen_px - share) < 0.005);
    frame_finish(&frame);
    scene_finish(&scene);
}

/* Lights at infinity are always met. There is no count if none was requested, or if nothing is
 * visible. */
static void test_no_count(void **state)
{
    (void)state;
    static const enum light_kind kinds[] = {LIGHT_RECTANGLE, LIGHT_SPHERE};
    struct scene scene;
    scene_init(&scene, "tests/models/body.obj");
    struct frame_request request = request_of(&scene, 64, 48, kinds, 2);
    struct frame frame = render(scene.renderer, scene.model, &request);
    assert_true(frame.seen_px > 0 && frame.met_px == frame.seen_px);
    frame_finish(&frame);
    request.n_lights = 1;
    request.lines = (struct lines){.family = LINES_ZEBRA};
    frame = render(scene.renderer, scene.model, &request);
    assert_true(frame.seen_px > 0 && frame.met_px == frame.seen_px);
    frame_finish(&frame);
    request.lines.family = LINES_REFLECTION;
    request.count_light = false;
    frame = render(scene.renderer, scene.model, &request);
    assert_true(frame.seen_px == 0 && frame.met_px == 0);
    frame_finish(&frame);
    request.count_light = true;
    for (int k = 0; k < 3; k++)
        request.camera.target[k] = 2 * request.camera.eye[k] - request.camera.target[k];
    frame = render(scene.renderer, scene.model, &request);
    assert_true(frame.seen_px == 0 && !frame.shows_surface);
    frame_finish(&frame);
    scene_finish(&scene);
}

/* A ray along the axis of a tunnel meets nothing; every other ray meets the tunnel. */
static void test_along_the_axis(void **state)
{
    (void)state;
    static const enum light_kind kind = LIGHT_TUNNEL;
    struct scene scene;
    scene_init(&scene, "tests/models/plane.obj"); /* in the plane of x and y */
    struct frame_request request = request_of(&scene, 64, 48, &kind, 1);
    request.camera = (struct camera){
        .kind = CAMERA_ORTHOGRAPHIC, .eye = {0, 0, 5}, .up = {0, 1, 0}, .ortho_height = 0.5};
    for (int tilted = 0; tilted < 2; tilted++) {
        request.camera.eye[0] = 0.01 * tilted;
        for (int k = 0; k < 3; k++) {
            request.lights[0].u[k] = k == 0 ? 9 : 0;
            request.lights[0].v[k] = k == 2 ? 9 : 0;
        }
        struct frame frame = render(scene.renderer, scene.model, &request);
        assert_true(frame.seen_px > 0);
        assert_int_equal(frame.met_px, tilted ? frame.seen_px : 0);
        frame_finish(&frame);
    }
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_no_count),
        cmocka_unit_test(test_along_the_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
