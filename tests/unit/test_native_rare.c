/* Rare pixels of the native device: Newton steps over edges of nodes, gaps between borders that are
 * narrower than a pixel, and a tip without a normal. */
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
#include "tests/unit/native_tile.h"

/* A place at this distance outside of a node's edge. */
static void place_on_edge(int edge, double along, double outside, double *x, double *y)
{
    const double xs[4] = {along, 1 + outside, along, -outside};
    const double ys[4] = {-outside, along, 1 + outside, along};
    *x = xs[edge];
    *y = ys[edge];
}

static struct vec surface_at(const struct limit_tables *tables, uint32_t node, double x, double y)
{
    const struct limit_place place = {node, tables->nodes[node].rotation, x, y};
    struct limit_point p = {0};
    assert_true(limit_evaluate_at(tables, &place, &p));
    return p.s;
}

/* A step over any edge of any node continues on the neighbouring surface. */
static void test_walk(void **state)
{
    (void)state;
    const double OUTSIDE = 1e-6;
    size_t n_crossed = 0;
    for (size_t m = 0; m < N_MODELS; m++) {
        struct limit_tables tables = {0};
        build_file(MODELS[m], &tables);
        for (uint32_t i = 0; i < tables.n_nodes; i++) {
            int kind = tables.nodes[i].kind;
            if (kind != LIMIT_REGULAR && kind != LIMIT_CORNER && kind != LIMIT_STRIP)
                continue;
            double size = (double)tables.whole[i].radius;
            for (int k = 0; k < 8; k++) {
                uint32_t node = i;
                double x, y, along = k < 4 ? 0.3 : 0.8;
                place_on_edge(k & 3, along, 0, &x, &y);
                struct vec from = surface_at(&tables, i, x, y);
                place_on_edge(k & 3, along, OUTSIDE, &x, &y);
                if (!native_walk(&tables, &node, &x, &y))
                    continue;
                n_crossed += node != i;
                double away = vec_length(vec_sub(surface_at(&tables, node, x, y), from));
                if (!(away < 1e-4 * size))
                    fail_msg("%s: over edge %d of node %u at %g lies node %u, %g of a node away",
                             MODELS[m], k & 3, i, along, node, away / size);
            }
        }
        limit_tables_finish(&tables);
    }
    assert_true(n_crossed > 10000);
}

/* Pixels that look through a gap of a third of a pixel show the wall behind it. */
static void test_gap(void **state)
{
    (void)state;
    static float position[SIDE_PX * SIDE_PX][3];
    struct planes planes;
    planes_init(&planes);
    planes.at.pitch = SIDE_PX;
    struct native_device *device = open_device(NULL, 2);
    for (double quad_px = 15; quad_px < 32; quad_px += 4) {
        double unit_px = quad_px / (STEP_RAD * RADIUS), gap = 0.33 / unit_px;
        struct limit_tables tables = {0};
        gap_tables(&tables, gap);
        struct native_model *model = open_model(&tables);
        for (int turn = 0; turn < 4; turn++) {
            const struct camera camera = gap_camera(unit_px, 0.2 + 0.4 * turn);
            const struct tile whole = {0, 0, SIDE_PX, SIDE_PX};
            struct error error = {0};
            struct view view;
            view_init(&view, &camera, SIDE_PX, SIDE_PX, tables.hull_min, tables.hull_max);
            if (!native_draw(device, model, &view, &whole, &planes.at, NULL, &error))
                fail_msg("%s", error.text);
            for (size_t i = 0; i < SIDE_PX * SIDE_PX; i++) {
                double right = ((double)(i % SIDE_PX) + 0.5 - view.centre_px[0]) / unit_px;
                double down = ((double)(i / SIDE_PX) + 0.5 - view.centre_px[1]) / unit_px;
                if (!(planes.at.depth[i] > 0))
                    planes.face[i] = UINT32_MAX;
                for (int k = 0; k < 3; k++)
                    position[i][k] =
                        (float)(view.eye[k] + right * view.axis[0][k] + down * view.axis[1][k] +
                                (double)planes.at.depth[i] * view.axis[2][k]);
            }
            assert_true(gap_expect_exact((const float(*)[3])position, planes.face, 1, unit_px,
                                         gap) > SIDE_PX / 5);
        }
        native_model_destroy(model);
        limit_tables_finish(&tables);
    }
    native_device_destroy(device);
    planes_finish(&planes);
}

/* A sharp vertex of six faces has no normal, and the single pixel that shows exactly that vertex
 * has none. */
static void test_tip(void **state)
{
    (void)state;
    enum { FACES = 6, RIM = 2 * FACES };
    const double PIXEL = 1.0 / 128;
    char text[2000];
    int used = sprintf(text, "v 0 0 1\n");
    for (int k = 0; k < RIM; k++)
        used += sprintf(text + used, "v %.9f %.9f %.9f\n", cos(k * 0.5236), sin(k * 0.5236),
                        0.1 * (k * k % 7));
    for (int k = 0; k < FACES; k++)
        used += sprintf(text + used, "f 1 %d %d %d\n", 2 + 2 * k, 3 + 2 * k, 2 + (2 * k + 2) % RIM);
    used += sprintf(text + used, "t corner 1/1/0 0 10\n");
    struct limit_tables tables = {0};
    struct planes planes;
    const struct native_set *set;
    planes_init(&planes);
    build(text, (size_t)used, &tables);
    struct native_model *model = open_model(&tables);
    const struct camera camera = {.kind = CAMERA_ORTHOGRAPHIC,
                                  .eye = {-PIXEL / 2, PIXEL / 2, 9},
                                  .target = {-PIXEL / 2, PIXEL / 2, 0},
                                  .up = {0, 1, 0},
                                  .ortho_height = HEIGHT * PIXEL};
    for (unsigned s = 0; (set = native_set_at(s)); s++) {
        struct native_device *device = open_device(set->name, 1);
        draw(device, model, &camera, &planes);
        for (size_t i = 0; i < PX; i++) {
            bool is_tip = i == HEIGHT / 2 * WIDTH + WIDTH / 2;
            double length = vec_length(normal_at(&planes, i));
            assert_true(planes.at.depth[i] > 0 || !is_tip);
            if (planes.at.depth[i] > 0 && !(fabs(length - !is_tip) < 1e-5))
                fail_msg("%s: the normal of pixel %zu,%zu is %g long", set->name, i % WIDTH,
                         i / WIDTH, length);
        }
        native_device_destroy(device);
    }
    native_model_destroy(model);
    limit_tables_finish(&tables);
    planes_finish(&planes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_walk), cmocka_unit_test(test_gap),
                                       cmocka_unit_test(test_tip)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
