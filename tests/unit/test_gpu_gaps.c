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

#include "tests/unit/renderer_frames.h"

enum { SIDE_PX = 160, QUADS = 24, WALL = 14 };
static const double STEP_RAD = 0.1, RADIUS = 6;

/* The limit curve of points on a circle runs so much nearer to its middle: to 1e-6. */
static double shrink(void)
{
    return (2 + cos(STEP_RAD)) / 3;
}

/* Two rows of quads on either side of a circle about the origin at z = 0, whose borders are `gap`
 * apart, before a wall of quads that overlap and hang apart, so that a ray must be led to its own.
 * Faces: the wall, WALL x WALL of them, the inner row, the outer row. */
static void scene_init(struct scene *scene, double gap)
{
    static char text[1 << 16];
    size_t used = 0;
    const int first = 4 * WALL * WALL + 1;
    const double radius[4] = {RADIUS - 2, (RADIUS - gap / 2) / shrink(),
                              (RADIUS + gap / 2) / shrink(), RADIUS + 2};
#define ADD(...) used += (size_t)snprintf(text + used, sizeof text - used, __VA_ARGS__)
    for (int k = 0; k < WALL * WALL; k++)
        for (int corner = 0; corner < 4; corner++)
            ADD("v %g %g %g\n", RADIUS - WALL / 2 + k % WALL + 1.2 * (corner == 1 || corner == 2),
                -WALL / 2 + k / WALL + 1.2 * (corner >= 2), -1 - 0.001 * k);
    for (int k = 0; k < WALL * WALL; k++)
        ADD("f %d %d %d %d\n", 4 * k + 1, 4 * k + 2, 4 * k + 3, 4 * k + 4);
    for (int i = 0; i <= QUADS; i++)
        for (int k = 0; k < 4; k++)
            ADD("v %.17g %.17g 0\n", radius[k] * cos(STEP_RAD * (i - QUADS / 2)),
                radius[k] * sin(STEP_RAD * (i - QUADS / 2)));
    for (int row = 0; row < 2; row++)
        for (int i = 0; i < QUADS; i++)
            ADD("f %d %d %d %d\n", first + 4 * i + 2 * row, first + 1 + 4 * i + 2 * row,
                first + 5 + 4 * i + 2 * row, first + 4 + 4 * i + 2 * row);
    ADD("t interpolateboundary 1/0/0 1\n"); /* corners stay */
#undef ADD
    *scene = (struct scene){0};
    build(text, used, &scene->tables);
    scene->renderer = open_renderer(0);
    scene->model = upload(scene->renderer, &scene->tables);
}

/* From above, turned by `turn_rad`; the gap's middle in the picture's. */
static struct frame_request look(const struct scene *scene, double unit_px, double turn_rad)
{
    struct frame_request request = request_for(&scene->tables, SIDE_PX, SIDE_PX);
    request.camera = (struct camera){.kind = CAMERA_ORTHOGRAPHIC,
                                     .eye = {RADIUS, 0.01, 9},
                                     .target = {RADIUS, 0.01, 0},
                                     .up = {sin(turn_rad), cos(turn_rad), 0},
                                     .ortho_height = SIDE_PX / unit_px};
    return request;
}

/* Counts the pixels that show the wall. The borders are circles to a thousandth of a pixel: nearer
 * than a hundredth to one, either side will do. */
static size_t expect_exact(const struct frame *frame, double unit_px, double gap)
{
    const float(*position)[3] = frame->plane[1];
    const uint32_t(*ptex)[3] = frame->plane[3];
    size_t n_wall = 0;
    for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++) {
        double beyond = hypot(position[i][0], position[i][1]) - RADIUS;
        uint32_t face = ptex[i][0];
        bool is_wall = fabs(beyond) < gap / 2;
        if (face == UINT32_MAX)
            fail_msg("pixel %zu,%zu is empty", i % SIDE_PX, i / SIDE_PX);
        if (fabs(fabs(beyond) - gap / 2) * unit_px < 0.01 || fabs(beyond) > 1)
            continue;
        uint32_t row = face < WALL * WALL ? 2 : (face - WALL * WALL) / QUADS;
        if (row != (is_wall ? 2 : beyond > 0))
            fail_msg("pixel %zu,%zu shows face %u, %g px from the gap's middle", i % SIDE_PX,
                     i / SIDE_PX, face, beyond * unit_px);
        n_wall += is_wall;
    }
    return n_wall;
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

/* The same frame in tiles: a renderer of its own, once the other's is drawn. */
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

/* In tiles bit by bit the same where that is promised, and as exact otherwise. */
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
