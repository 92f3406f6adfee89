/* Frames without antialiasing, on both devices: a pixel shows the surface at its centre, and lines
 * averaged over its area. */
#include "tests/unit/native_scene.h"

enum { WIDTH = 320, HEIGHT = 240, PIXELS = WIDTH * HEIGHT };

/* How pixels are sampled. */
enum sampling { EXACT, ALIASED, ONE_SAMPLE, SAMPLINGS };

/* Planes that have one sample for each pixel, with and without antialiasing. */
static const uint32_t SAMPLED =
    PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX | PLANE_LIGHT | PLANE_CURVATURE | PLANE_LIGHT_CHANGE;

/* `empty` is transparent, so that alpha is the share of a pixel that shows surface. */
static struct frame_request request_of(const struct devices *devices, enum sampling sampling)
{
    struct frame_request request = request_for(&devices->tables, WIDTH, HEIGHT);
    request.planes = PLANE_COLOUR | SAMPLED;
    request.lights[0].kind = LIGHT_TUNNEL;
    scene_default_light(devices->tables.box_min, devices->tables.box_max, NULL, &request.lights[0]);
    request.lights[0].pattern.count = 150; /* stripes that are finer than a pixel in some places */
    memcpy(request.miss, (const float[4]){1, 0, 0, 1}, sizeof request.miss);
    request.aliased = sampling == ALIASED;
    request.unfiltered = sampling == ONE_SAMPLE;
    return request;
}

static struct frame draw(struct devices *devices, int device, enum sampling sampling)
{
    struct frame_request request = request_of(devices, sampling);
    return render(devices->renderer[device], devices->model[device], &request);
}

static const uint8_t *colour_at(const struct frame *frame, int pixel)
{
    return (const uint8_t *)frame->plane[0] + 4 * pixel;
}

static bool is_hit(const struct frame *frame, int pixel)
{
    return ((const uint32_t *)frame->plane[3])[3 * pixel] != UINT32_MAX;
}

/* Whether the pixel and its eight neighbours all see surface, and the surface turns so little
 * between neighbours that only a smooth, flat piece can lie between them. */
static bool is_calm(const struct frame *frame, int x, int y)
{
    const float(*normal)[3] = frame->plane[2];
    int middle = y * WIDTH + x;
    if (x < 1 || y < 1 || x + 1 >= WIDTH || y + 1 >= HEIGHT)
        return false;
    for (int k = 0; k < 9; k++) {
        int beside = (y + k / 3 - 1) * WIDTH + x + k % 3 - 1;
        float dot = 0;
        for (int i = 0; i < 3; i++)
            dot += normal[middle][i] * normal[beside][i];
        if (!is_hit(frame, beside) || !(dot > 0.99976f)) /* an angle of 0.022 rad */
            return false;
    }
    return true;
}

static void finish(struct frame frames[SAMPLINGS])
{
    for (int i = 0; i < SAMPLINGS; i++)
        frame_finish(&frames[i]);
}

/* All planes except colour have one sample for each pixel in any case. */
static void assert_same_samples(const struct frame *a, const struct frame *b)
{
    for (int p = 1; p < PLANE_COUNT; p++)
        if (SAMPLED >> p & 1)
            assert_memory_equal(a->plane[p], b->plane[p],
                                PIXELS * frame_plane_bytes((enum frame_plane)(1 << p)));
}

struct counts {
    int calm, other_mean, other_sample, mixed;
};

static struct counts count(const struct frame frames[SAMPLINGS])
{
    struct counts n = {0};
    for (int k = 0; k < PIXELS; k++) {
        const uint8_t *aliased = colour_at(&frames[ALIASED], k);
        /* covered wholly or not at all */
        assert_int_equal(aliased[3], is_hit(&frames[ALIASED], k) ? 255 : 0);
        n.mixed += colour_at(&frames[EXACT], k)[3] % 255 != 0;
        if (!is_calm(&frames[ALIASED], k % WIDTH, k / WIDTH))
            continue;
        n.calm++;
        n.other_mean += memcmp(aliased, colour_at(&frames[EXACT], k), 4) != 0;
        n.other_sample += memcmp(aliased, colour_at(&frames[ONE_SAMPLE], k), 4) != 0;
    }
    return n;
}

/* Calm pixels show the same mean as with antialiasing. Exceptions are pixels that the rounding of a
 * semi-sharp crease crosses, or over which the lines bend: they are shaded in nine squares. */
static void test_planes_and_means(void **state)
{
    static const struct {
        const char *model;
        int most_other;
    } cases[] = {{"tests/models/body.obj", 0},
                 {"tests/models/ngons.obj", 0},
                 {"tests/models/creases.obj", 700}};
    (void)state;
    for (size_t m = 0; m < sizeof cases / sizeof *cases; m++) {
        struct devices devices;
        open_devices(&devices, cases[m].model);
        for (int device = 0; device < DEVICES; device++) {
            struct frame frames[SAMPLINGS];
            for (int i = 0; i < SAMPLINGS; i++)
                frames[i] = draw(&devices, device, (enum sampling)i);
            assert_same_samples(&frames[ALIASED], &frames[ONE_SAMPLE]);
            assert_same_samples(&frames[ALIASED], &frames[EXACT]);
            struct counts n = count(frames);
            if (n.calm < 1000 || n.mixed < 200 || n.other_sample < n.calm / 4 ||
                n.other_mean > cases[m].most_other)
                fail_msg("%s, device %d: of %d calm pixels %d have another mean than with "
                         "antialiasing, %d than one sample; %d at edges",
                         cases[m].model, device, n.calm, n.other_mean, n.other_sample, n.mixed);
            finish(frames);
        }
        close_devices(&devices);
    }
}

/* A pixel at an edge shows the mean over the surface at its centre. */
static void test_edges_show_the_centre(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/creases.obj");
    for (int device = 0; device < DEVICES; device++) {
        struct frame_request request = request_of(&devices, ALIASED);
        request.lights[0].pattern.duty = 1; /* the same colour everywhere */
        memcpy(request.lights[0].pattern.foreground, (const float[4]){0.2f, 0.4f, 0.6f, 1},
               sizeof request.lights[0].pattern.foreground);
        struct frame frame = render(devices.renderer[device], devices.model[device], &request);
        int n_met = 0;
        for (int k = 0; k < PIXELS; k++) {
            bool is_met = !isnan(((const float *)frame.plane[4])[2 * k]);
            n_met += is_met;
            if (is_met)
                assert_memory_equal(colour_at(&frame, k), ((const uint8_t[4]){51, 102, 153, 255}),
                                    4);
        }
        assert_true(n_met > 1000);
        frame_finish(&frame);
    }
    close_devices(&devices);
}

static void test_several_lights(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/fender.obj");
    struct frame frames[DEVICES];
    for (int device = 0; device < DEVICES; device++) {
        struct frame_request request = request_of(&devices, ALIASED);
        request.n_lights = 2;
        request.lights[1] = request.lights[0];
        request.lights[0].pattern.background[3] = 0.25f;
        request.lights[1].pattern.rotation_deg = 60;
        request.lights[1].pattern.count = request.lights[0].pattern.count = 20;
        frames[device] = render(devices.renderer[device], devices.model[device], &request);
    }
    struct difference found = compare(&frames[ON_GL], &frames[ON_NATIVE]);
    assert_alike(&found, "two lights without antialiasing");
    for (int device = 0; device < DEVICES; device++)
        frame_finish(&frames[device]);
    close_devices(&devices);
}

/* Planes that were kept with antialiasing serve frames without, but not the reverse, because planes
 * kept without antialiasing have no lists of edges. */
static void test_kept_planes(void **state)
{
    struct devices devices;
    struct frame fresh[DEVICES][SAMPLINGS];
    (void)state;
    for (int i = 0; i < SAMPLINGS; i++) {
        open_devices(&devices, "tests/models/body.obj");
        for (int device = 0; device < DEVICES; device++)
            fresh[device][i] = draw(&devices, device, (enum sampling)i);
        close_devices(&devices);
    }
    open_devices(&devices, "tests/models/body.obj");
    for (int device = 0; device < DEVICES; device++) {
        static const struct {
            enum sampling sampling;
            bool is_kept;
        } turns[] = {{ALIASED, false}, {ONE_SAMPLE, true}, {EXACT, false},
                     {ALIASED, true},  {ONE_SAMPLE, true}, {EXACT, true}};
        for (size_t t = 0; t < sizeof turns / sizeof *turns; t++) {
            struct frame frame = draw(&devices, device, turns[t].sampling);
            assert_same_frames(&frame, &fresh[device][turns[t].sampling]);
            assert_int_equal(frame.times.evaluate_us == 0, turns[t].is_kept);
            frame_finish(&frame);
        }
        finish(fresh[device]);
    }
    close_devices(&devices);
}

static void test_coverage_is_refused(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/fender.obj");
    for (int device = 0; device < DEVICES; device++) {
        for (int i = 0; i < SAMPLINGS; i++) {
            struct frame_request request = request_of(&devices, (enum sampling)i);
            struct frame frame;
            struct error error = {0};
            request.planes |= PLANE_COVERAGE;
            bool ok = renderer_render(devices.renderer[device], devices.model[device], &request,
                                      &frame, &error);
            assert_int_equal(ok, i == EXACT);
            if (ok)
                frame_finish(&frame);
            else
                assert_non_null(strstr(error.text, "coverage"));
        }
    }
    close_devices(&devices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_planes_and_means),    cmocka_unit_test(test_edges_show_the_centre),
        cmocka_unit_test(test_several_lights),      cmocka_unit_test(test_kept_planes),
        cmocka_unit_test(test_coverage_is_refused),
    };
    return cmocka_run_group_tests_name("render_antialias", tests, NULL, NULL);
}
