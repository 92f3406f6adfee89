/* The stages' times by the device's timer queries. For a software device only tests use them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

#include <cmocka.h>

#include "tests/unit/request_scene.h"

static const char CUBE[] = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\n"
                           "v 1 1 1\nv -1 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\n"
                           "f 3 4 8 7\nf 4 1 5 8\n";

static void scene_init(struct scene *scene, bool device_times)
{
    scene_open(scene, CUBE, 640, 480, device_times);
}

static uint64_t now_us(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000u + (uint64_t)t.tv_nsec / 1000u;
}

/* The frame's times, and the elapsed time by the clock. */
static struct frame_times render(struct scene *scene, uint64_t *took_us)
{
    struct error error = {0};
    struct frame frame;
    uint64_t start = now_us();
    if (!renderer_render(scene->renderer, scene->model, &scene->request, &frame, &error))
        fail_msg("%s", error.text);
    *took_us = now_us() - start;
    struct frame_times times = frame.times;
    frame_finish(&frame);
    return times;
}

static void test_timer_queries(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, true);
    if (!renderer_info(scene.renderer)->timed_by_device) {
        scene_finish(&scene);
        skip();
    }
    for (int run = 0; run < 3; run++) {
        uint64_t took_us;
        scene.request.camera.eye[0] += 0.01;
        struct frame_times times = render(&scene, &took_us);
        assert_true(times.visibility_us > 0);
        assert_true(times.evaluate_us > 0);
        assert_true(times.shade_us > 0);
        /* each is rounded up */
        assert_true(times.visibility_us + times.evaluate_us + times.shade_us <= took_us + 3);
    }
    scene_finish(&scene);
}

/* After a change of the light, only stage 3 runs; frames of polygons have no stage 2. */
static void test_stages_left_out(void **state)
{
    (void)state;
    struct scene scene;
    for (int device_times = 0; device_times < 2; device_times++) {
        uint64_t took_us;
        scene_init(&scene, device_times);
        render(&scene, &took_us);
        scene.request.lights[0].pattern.offset = 0.25;
        struct frame_times light = render(&scene, &took_us);
        assert_int_equal(light.visibility_us, 0);
        assert_int_equal(light.evaluate_us, 0);
        assert_true(light.shade_us > 0);
        scene.request.surface = (struct surface){.kind = SURFACE_POLYGON, .level = 2};
        struct frame_times polygon = render(&scene, &took_us);
        assert_true(polygon.visibility_us > 0);
        assert_int_equal(polygon.evaluate_us, 0);
        assert_true(polygon.shade_us > 0);
        scene_finish(&scene);
    }
}

/* The times of tiles add up. */
static void test_tiles(void **state)
{
    (void)state;
    struct scene scene;
    scene_init(&scene, true);
    struct frame_work work = {.request = &scene.request, .tile_px = 256 * 256};
    struct frame frame;
    struct error error = {0};
    struct frame_times before = {0};
    assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
    enum frame_step next;
    do {
        next = renderer_step(scene.renderer, scene.model, &work, &frame, &error);
        assert_int_not_equal(next, FRAME_FAILED);
        if (!work.has_drawn)
            continue;
        assert_true(frame.times.shade_us > before.shade_us);
        before = frame.times;
    } while (next == FRAME_MORE);
    frame_finish(&frame);
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_timer_queries),
        cmocka_unit_test(test_stages_left_out),
        cmocka_unit_test(test_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
