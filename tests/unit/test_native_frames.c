/* The native device's pictures against those of the GL device: every line family, light and
 * pattern. Both devices run the same shaders (shaders/lanes), so they differ only by rounding, and
 * by what each of them sees at a silhouette. */
#include "tests/unit/native_scene.h"

enum { WIDTH = 200, HEIGHT = 150, PIXELS = WIDTH * HEIGHT };

static struct difference difference_of(struct devices *devices, const struct frame_request *request)
{
    struct frame frames[2];
    for (int i = 0; i < 2; i++)
        frames[i] = render(devices->renderer[i], devices->model[i], request);
    struct difference found = compare(&frames[0], &frames[1]);
    for (int i = 0; i < 2; i++)
        frame_finish(&frames[i]);
    return found;
}

/* Each family and each light, which are separate parts of the shaders: the last three families use no light. The oracle
 * `lines` judges every family with every light on both devices; here the GL device would spend 20 s of a processor more on
 * compiling these programs. */
static void test_families_and_lights(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/body.obj");
    static const struct {
        enum line_family family;
        enum light_kind kind;
    } cases[] = {{LINES_REFLECTION, LIGHT_RECTANGLE}, {LINES_REFLECTION, LIGHT_TUNNEL},
                 {LINES_HIGHLIGHT, LIGHT_PLANE},      {LINES_HIGHLIGHT, LIGHT_SPHERE},
                 {LINES_ISOPHOTE, LIGHT_RECTANGLE},   {LINES_ZEBRA, LIGHT_RECTANGLE},
                 {LINES_ENVIRONMENT, LIGHT_RECTANGLE}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
        char what[64];
        request.lines.family = cases[i].family;
        request.lights[0].kind = cases[i].kind;
        scene_default_light(devices.tables.box_min, devices.tables.box_max, NULL,
                            &request.lights[0]);
        struct difference found = difference_of(&devices, &request);
        snprintf(what, sizeof what, "family %d, light %d", cases[i].family, cases[i].kind);
        assert_alike(&found, what);
    }
    close_devices(&devices);
}

/* Patches, a pole and an open mouth. */
static void test_bottle(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/bottle.bpt");
    for (int view = VIEW_AROUND; view <= VIEW_BOTTOM; view += VIEW_BOTTOM - VIEW_AROUND) {
        struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
        char what[64];
        scene_default_camera(&devices.tables, NULL, (enum default_view)view, WIDTH, HEIGHT,
                             &request.camera);
        struct difference found = difference_of(&devices, &request);
        snprintf(what, sizeof what, "view %d", view);
        assert_alike(&found, what);
    }
    close_devices(&devices);
}

static void test_patterns(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/creases.obj");
    for (int kind = PATTERN_STRIPES; kind <= PATTERN_DISTANCE; kind++) {
        for (int soft = 0; soft < 2 && kind != PATTERN_IMAGE; soft++) {
            struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
            struct pattern *pattern = &request.lights[0].pattern;
            char what[64];
            pattern->kind = (enum pattern_kind)kind;
            pattern->soft = 0.4 * soft;
            pattern->width = 0.02;
            pattern->n_at = 3;
            for (uint32_t i = 0; i < pattern->n_at; i++)
                pattern->at[i] = 0.3 + 0.2 * i;
            struct difference found = difference_of(&devices, &request);
            snprintf(what, sizeof what, "pattern %d, soft %d", kind, soft);
            assert_alike(&found, what);
        }
    }
    close_devices(&devices);
}

/* Images with both kinds of texels; one fills its light once, one repeats. */
static void test_images(void **state)
{
    enum { SIDE = 64 };
    static uint8_t bytes[SIDE][SIDE][4];
    static float floats[SIDE][SIDE][4];
    struct devices devices;
    struct error error = {0};
    (void)state;
    open_devices(&devices, "tests/models/body.obj");
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) {
            const uint8_t texel[4] = {(uint8_t)(4 * x), (uint8_t)(4 * y), ((x ^ y) & 8) ? 255 : 0,
                                      255};
            memcpy(bytes[y][x], texel, sizeof texel);
            for (int k = 0; k < 4; k++)
                floats[y][x][k] = (float)texel[k] / 255;
        }
    }
    for (int i = 0; i < 2; i++) {
        struct image image = {SIDE, SIDE, i == 1, i == 1 ? (void *)floats : (void *)bytes};
        struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
        struct renderer_image *images[2];
        struct frame frames[2];
        request.lights[0].kind = i == 1 ? LIGHT_TUNNEL : LIGHT_RECTANGLE;
        scene_default_light(devices.tables.box_min, devices.tables.box_max, NULL,
                            &request.lights[0]);
        request.lights[0].pattern.kind = PATTERN_IMAGE;
        for (int k = 0; k < 2; k++) {
            images[k] = renderer_image_create(devices.renderer[k], &image, &error);
            assert_non_null(images[k]);
            request.lights[0].pattern.image = images[k];
            frames[k] = render(devices.renderer[k], devices.model[k], &request);
        }
        struct difference found = compare(&frames[0], &frames[1]);
        assert_alike(&found, i == 1 ? "image of floats" : "image of bytes");
        for (int k = 0; k < 2; k++) {
            frame_finish(&frames[k]);
            renderer_image_destroy(devices.renderer[k], images[k]);
        }
    }
    close_devices(&devices);
}

static void test_one_sample_and_several_lights(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/fender.obj");
    struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
    request.unfiltered = true;
    struct difference found = difference_of(&devices, &request);
    assert_alike(&found, "one sample a pixel");
    request.unfiltered = false;
    request.n_lights = 3;
    for (uint32_t i = 1; i < request.n_lights; i++) {
        request.lights[i] = request.lights[0];
        request.lights[i].kind = i == 1 ? LIGHT_TUNNEL : LIGHT_SPHERE;
        request.lights[i].pattern.rotation_deg = 30 * i;
        scene_default_light(devices.tables.box_min, devices.tables.box_max, NULL,
                            &request.lights[i]);
    }
    request.lights[0].pattern.background[3] = 0;
    request.lights[1].pattern.foreground[3] = 0.5f;
    found = difference_of(&devices, &request);
    assert_alike(&found, "three lights");
    close_devices(&devices);
}

/* A frame in tiles, and a frame of a view whose planes are kept, against a frame of a new renderer:
 * in tiles the same except for rounding, with kept planes the same bytes. */
static void test_tiles_and_kept_planes(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/creases.obj");
    struct frame_request request = request_for(&devices.tables, WIDTH, HEIGHT);
    struct frame whole = render(devices.renderer[1], devices.model[1], &request), tiled, again;
    struct frame_work work = {.request = &request, .tile_px = 1};
    struct error error = {0};
    struct frame_request other = request;
    other.lights[0].pattern.count = 7;
    struct frame changed = render(devices.renderer[1], devices.model[1], &other);
    again = render(devices.renderer[1], devices.model[1], &request);
    assert_memory_equal(whole.plane[0], again.plane[0], 4 * PIXELS);
    assert_memory_not_equal(whole.plane[0], changed.plane[0], 4 * PIXELS);
    other.camera.fov_deg *= 0.5;
    frame_finish(&changed);
    changed = render(devices.renderer[1], devices.model[1], &other); /* another view */
    assert_true(renderer_begin(devices.renderer[1], &work, &tiled, &error));
    int steps = 1;
    while (renderer_step(devices.renderer[1], devices.model[1], &work, &tiled, &error) ==
           FRAME_MORE)
        steps++;
    assert_true(steps > 1);
    struct difference found = compare(&whole, &tiled);
    assert_alike(&found, "tiles");
    frame_finish(&whole);
    frame_finish(&tiled);
    frame_finish(&again);
    frame_finish(&changed);
    close_devices(&devices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_families_and_lights),
        cmocka_unit_test(test_bottle),
        cmocka_unit_test(test_patterns),
        cmocka_unit_test(test_images),
        cmocka_unit_test(test_one_sample_and_several_lights),
        cmocka_unit_test(test_tiles_and_kept_planes),
    };
    return cmocka_run_group_tests_name("native_frames", tests, NULL, NULL);
}
