/* Sheets side by side whose borders run along each other, a third of a pixel apart, before a wall:
 * the triangles of stage 1 hide the wall at many pixels that see it through the gap. Every pixel
 * shows what its centre sees. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/gap_scene.h"
#include "tests/unit/renderer_frames.h"

static void scene_init(struct scene *scene, double gap)
{
    *scene = (struct scene){0};
    gap_tables(&scene->tables, gap);
    scene->renderer = open_renderer(0);
    scene->model = upload(scene->renderer, &scene->tables);
}

static struct frame_request look(const struct scene *scene, double unit_px, double turn_rad)
{
    struct frame_request request = request_for(&scene->tables, SIDE_PX, SIDE_PX);
    request.camera = gap_camera(unit_px, turn_rad);
    return request;
}

static size_t expect_exact(const struct frame *frame, double unit_px, double gap)
{
    return gap_expect_exact(frame->plane[1], frame->plane[3], 3, unit_px, gap);
}

static void test_gap(void **state)
{
    (void)state;
    for (double quad_px = 15; quad_px < 32; quad_px += 4) {
        struct scene scene;
        double unit_px = quad_px / (STEP_RAD * RADIUS), gap = 0.33 / unit_px;
        scene_init(&scene, gap);
        for (int turn = 0; turn < 4; turn++) {
            const struct frame_request request = look(&scene, unit_px, 0.2 + 0.4 * turn);
            struct frame frame = render(scene.renderer, scene.model, &request);
            assert_true(expect_exact(&frame, unit_px, gap) > SIDE_PX / 5);
            frame_finish(&frame);
        }
        scene_finish(&scene);
    }
}

/* Draws the same frame in tiles, by a renderer of its own, after the other frame is complete. */
static struct frame render_in_tiles(const struct limit_tables *tables,
                                    const struct frame_request *request, bool in_place)
{
    struct renderer *renderer = open_renderer(0);
    struct renderer_model *model = upload(renderer, tables);
    struct frame_work work = {.request = request, .tile_px = 128 * 128, .in_place = in_place};
    struct frame frame;
    struct error error = {0};
    enum frame_step step = FRAME_MORE;
    unsigned n_tiles = 0;
    if (!renderer_begin(renderer, &work, &frame, &error))
        fail_msg("%s", error.text);
    for (; step == FRAME_MORE; n_tiles += work.has_drawn)
        step = renderer_step(renderer, model, &work, &frame, &error);
    assert_int_equal(step, FRAME_DONE);
    assert_true(n_tiles > 1);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    return frame;
}

/* Tiles give the same bytes where that is promised, and elsewhere the same exactness. */
static void test_tiles(void **state)
{
    (void)state;
    enum { TURNS = 4, UNIT_PX = 40 };
    const double GAP = 0.33 / UNIT_PX;
    struct scene scene;
    struct frame whole[TURNS];
    scene_init(&scene, GAP);
    for (int turn = 0; turn < TURNS; turn++) {
        const struct frame_request request = look(&scene, UNIT_PX, 0.2 + 0.4 * turn);
        whole[turn] = render(scene.renderer, scene.model, &request);
    }
    for (int turn = 0; turn < TURNS; turn++) {
        const struct frame_request request = look(&scene, UNIT_PX, 0.2 + 0.4 * turn);
        struct frame in_place = render_in_tiles(&scene.tables, &request, true);
        struct frame apart = render_in_tiles(&scene.tables, &request, false);
        assert_same_frames(&whole[turn], &in_place);
        expect_exact(&apart, UNIT_PX, GAP);
        frame_finish(&whole[turn]);
        frame_finish(&in_place);
        frame_finish(&apart);
    }
    scene_finish(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gap),
        cmocka_unit_test(test_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
