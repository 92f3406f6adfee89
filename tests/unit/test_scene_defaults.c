/* The default camera and the default lights. */
#include <string.h>

#include "server/render/view.h"
#include "server/scene/defaults.h"
#include "server/surface/evaluate.h"
#include "server/surface/support.h"
#include "tests/unit/cage_tables.h"

#define MARGIN 0.92 /* the share of the half picture that the box fills */

static const double ups[][3] = {{0, 0, 1},  {0, 1, 0},   {1, 0, 0},
                                {0, 0, -2}, {-50, 0, 0}, {1, -9, 8}};

/* How far the box reaches from the picture's middle to each side, in halves of the picture. */
struct reach {
    double low[2], high[2]; /* horizontally, vertically */
};

static void frame_box(const double box_min[3], const double box_max[3], const double up[3],
                      uint32_t width_px, uint32_t height_px, struct camera *camera)
{
    struct limit_tables tables = {0};
    memcpy(tables.box_min, box_min, sizeof tables.box_min);
    memcpy(tables.box_max, box_max, sizeof tables.box_max);
    scene_default_camera(&tables, up, VIEW_AROUND, width_px, height_px, camera);
}

static struct reach reach_of(const double box_min[3], const double box_max[3], const double up[3],
                             uint32_t width_px, uint32_t height_px)
{
    struct camera camera;
    struct view view;
    frame_box(box_min, box_max, up, width_px, height_px, &camera);
    view_init(&view, &camera, width_px, height_px, box_min, box_max);
    const double half[2] = {0.5 * width_px, 0.5 * height_px};
    struct reach reach = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    for (int corner = 0; corner < 8; corner++) {
        double world[3], seen[3];
        for (int i = 0; i < 3; i++)
            world[i] = (corner >> i & 1 ? box_max : box_min)[i];
        view_transform(&view, world, seen);
        assert_true(seen[2] > 0);
        for (int i = 0; i < 2; i++) {
            double place = seen[i] / seen[2] / view.units_per_px / half[i];
            reach.low[i] = fmin(reach.low[i], place);
            reach.high[i] = fmax(reach.high[i], place);
        }
    }
    return reach;
}

static void assert_fills(struct reach reach)
{
    bool touches = false;
    for (int axis = 0; axis < 2; axis++) {
        double least = fmin(-reach.low[axis], reach.high[axis]);
        double most = fmax(-reach.low[axis], reach.high[axis]);
        assert_true(most < MARGIN * (1 + 1e-6));
        touches = touches || least > 0.99 * MARGIN;
    }
    assert_true(touches);
}

/* The whole box is in the picture, and as large as possible, whichever axis is up. */
static void test_the_box_fills_the_picture(void **state)
{
    (void)state;
    static const double boxes[][2][3] = {
        {{-1, -1, -1}, {1, 1, 1}},             /* as high as wide */
        {{0, 0, 0}, {4000, 1800, 1300}},       /* a car, in mm, z up */
        {{0, 0, 0}, {4000, 1300, 1800}},       /* the same, y up */
        {{-500, 20, 7}, {500, 21, 7}},         /* a sliver */
        {{99000, -1, 3}, {99001, 9, 3.001}},   /* a plate, far off */
        {{1e-12, 0, 0}, {2e-12, 2e-12, 5e-13}} /* tiny */
    };
    static const uint32_t sizes[][2] = {{640, 480}, {100, 400}, {1920, 300}};
    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++)
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            const double *low = boxes[i][0], *high = boxes[i][1];
            assert_fills(reach_of(low, high, NULL, sizes[k][0], sizes[k][1]));
            for (size_t n = 0; n < sizeof ups / sizeof ups[0]; n++)
                assert_fills(reach_of(low, high, ups[n], sizes[k][0], sizes[k][1]));
        }
}

/* The camera stands 45 degrees above the horizon of the given up, whose length has no effect. The
 * up that would be chosen anyway gives the default camera. */
static void test_up_is_above(void **state)
{
    (void)state;
    static const double zero[3] = {0, 0, 0}, door[3] = {1100, 90, 800};
    struct camera camera, guessed;
    for (size_t n = 0; n < sizeof ups / sizeof ups[0]; n++) {
        frame_box(zero, door, ups[n], 640, 480, &camera);
        double rise = 0, distance = 0, length = 0;
        for (int i = 0; i < 3; i++) {
            rise += (camera.eye[i] - camera.target[i]) * ups[n][i];
            distance = hypot(distance, camera.eye[i] - camera.target[i]);
            length = hypot(length, ups[n][i]);
            assert_true(camera.up[i] == ups[n][i]);
        }
        assert_true(fabs(rise / distance / length - sqrt(0.5)) < 1e-9);
    }
    frame_box(zero, door, NULL, 640, 480, &guessed);
    frame_box(zero, door, guessed.up, 640, 480, &camera);
    assert_memory_equal(&camera, &guessed, sizeof camera);
}

/* For a model about as deep as high, neither rounding nor a small change of the model changes
 * up. */
static void test_a_near_tie_stays_z_up(void **state)
{
    (void)state;
    static const struct {
        double depth;
        int up;
    } cases[] = {{1, 2}, {1 - 1e-9, 2}, {1 + 1e-9, 2}, {0.991, 2}, {0.989, 1}, {0.1, 1}, {0, 1}};
    static const double zero[3] = {0, 0, 0};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double up[3];
        scene_guess_up(zero, (const double[]){1, cases[i].depth, 1}, up);
        for (int k = 0; k < 3; k++)
            assert_true(up[k] == (k == cases[i].up));
    }
    double up[3];
    scene_guess_up(zero, zero, up);
    assert_true(up[2] == 1);
}

/* The longer of the two horizontal sides is seen across, for every up; x if they differ little. The
 * size of the picture has no effect. */
static void test_the_longer_side_lies_across(void **state)
{
    (void)state;
    static const struct {
        double size[3];
        int across, into;
    } cases[] = {{{4, 1.8, 1.3}, 0, 1}, {{1.8, 4, 1.3}, 1, 0}, {{4, 1.3, 1.8}, 0, 2},
                 {{1.8, 1.3, 4}, 2, 0}, {{2, 2.1, 1}, 0, 1},   {{2, 1, 2.1}, 0, 2}};
    static const uint32_t sizes[][2] = {{640, 480}, {100, 400}};
    static const double zero[3] = {0, 0, 0};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
            struct camera camera;
            frame_box(zero, cases[i].size, NULL, sizes[k][0], sizes[k][1], &camera);
            int across = cases[i].across, into = cases[i].into;
            double view_across = fabs(camera.target[across] - camera.eye[across]);
            double view_into = fabs(camera.target[into] - camera.eye[into]);
            assert_true(fabs(view_across / view_into - tan(30 * acos(-1) / 180)) < 1e-9);
        }
}

/* The share of the picture's longer half that the points reach, in a frame that shows all of
 * them. */
static double fill_of(const struct limit_tables *tables, enum default_view view,
                      const struct vec *points, size_t n)
{
    struct camera camera;
    struct view seen_by;
    scene_default_camera(tables, NULL, view, 640, 480, &camera);
    view_init(&seen_by, &camera, 640, 480, tables->hull_min, tables->hull_max);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (size_t i = 0; i < n; i++) {
        const double world[3] = {points[i].x, points[i].y, points[i].z};
        double seen[3];
        view_transform(&seen_by, world, seen);
        assert_true(seen[2] > 0);
        for (int k = 0; k < 2; k++) {
            double place = seen[k] / seen[2] / seen_by.units_per_px / (k ? 480 : 640);
            low[k] = fmin(low[k], place);
            high[k] = fmax(high[k], place);
        }
    }
    for (int k = 0; k < 2; k++)
        assert_true(low[k] > -0.49 && high[k] < 0.49);
    return fmax(high[0] - low[0], high[1] - low[1]);
}

enum { SAMPLES = 33 };

/* The whole surface is in the picture and fills it, for every view. It is sampled more densely here
 * than by the code that places the camera. */
static void test_the_surface_fills_the_picture(void **state)
{
    (void)state;
    static const char *const names[] = {"body", "fender", "creases", "ngons",
                                        "pole", "tetra",  "plane"};
    for (size_t m = 0; m < sizeof names / sizeof names[0]; m++) {
        char path[64];
        struct error error = {0};
        struct limit_tables tables;
        snprintf(path, sizeof path, "tests/models/%s.obj", names[m]);
        build_file(path, &tables);
        assert_true(limit_find_support(&tables, NULL, &error));
        assert_true(tables.n_support > 4 && tables.n_support <= LIMIT_MAX_SUPPORT);
        struct vec *points = calloc(tables.n_faces * SAMPLES * SAMPLES, sizeof *points);
        assert_non_null(points);
        size_t n = 0;
        for (size_t i = 0; i < tables.n_faces * SAMPLES * SAMPLES; i++) {
            struct limit_point point;
            size_t x = i % SAMPLES, y = i / SAMPLES % SAMPLES;
            if (limit_evaluate(&tables, (uint32_t)(i / SAMPLES / SAMPLES),
                               (double)x / (SAMPLES - 1), (double)y / (SAMPLES - 1), &point))
                points[n++] = point.s;
        }
        for (enum default_view view = VIEW_AROUND; view <= VIEW_ISO; view++) {
            double fill = fill_of(&tables, view, points, n);
            assert_true(fill > 0.90 && fill < 0.95);
        }
        free(points);
        limit_tables_finish(&tables);
    }
}

static struct vec vec_of(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

/* The axis of the tunnel is along the longer horizontal side (x if they differ little), through the
 * middle of the box. The whole box is well inside, and azimuth 0 is above. */
static void test_the_tunnel(void **state)
{
    (void)state;
    static const struct {
        double size[3];
        int up, along;
    } cases[] = {{{4, 1.8, 1.3}, 2, 0}, {{1.8, 4, 1.3}, 2, 1},   {{1.8, 1.3, 4}, 1, 2},
                 {{2, 2.1, 1}, 2, 0},   {{1100, 90, 800}, 2, 0}, {{9, 2, 3}, 0, 2},
                 {{0, 0, 0}, 2, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct light light = {.kind = LIGHT_TUNNEL};
        double low[3], high[3], up[3] = {0, 0, 0}, radius = vec_length(vec_of(cases[i].size)) / 2;
        for (int k = 0; k < 3; k++) {
            low[k] = 7 - k;
            high[k] = low[k] + cases[i].size[k];
        }
        up[cases[i].up] = 5;
        scene_default_light(low, high, up, &light);
        double tunnel = vec_length(vec_of(light.u));
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(light.centre[k] - 0.5 * (low[k] + high[k])) < 1e-12);
            assert_true((light.v[k] != 0) == (k == cases[i].along));
            assert_true(k == cases[i].up ? light.u[k] > 0 : light.u[k] == 0);
        }
        assert_true(radius > 0 ? tunnel > 2 * radius : tunnel > 0);
    }
}

/* A light above the model, seen from below. */
static void test_flat_lights_face_the_model(void **state)
{
    (void)state;
    static const double low[3] = {0, 0, 0}, high[3] = {4, 2, 1};
    for (size_t n = 0; n < sizeof ups / sizeof ups[0]; n++)
        for (enum light_kind kind = LIGHT_RECTANGLE; kind <= LIGHT_PLANE; kind++) {
            struct light light = {.kind = kind};
            scene_default_light(low, high, ups[n], &light);
            struct vec m = vec_unit(vec_cross(vec_of(light.u), vec_of(light.v)));
            struct vec up = vec_unit(vec_of(ups[n]));
            struct vec middle = {2, 1, 0.5}, above = vec_sub(vec_of(light.centre), middle);
            assert_true(vec_dot(m, up) < -1 + 1e-12);
            assert_true(vec_dot(vec_unit(above), up) > 1 - 1e-12);
        }
}

/* A box without size is seen from some distance. */
static void test_a_point(void **state)
{
    (void)state;
    const double point[3] = {5, 6, 7};
    struct camera camera;
    frame_box(point, point, NULL, 640, 480, &camera);
    double distance = 0;
    for (int i = 0; i < 3; i++) {
        assert_true(camera.target[i] == point[i]);
        distance = hypot(distance, camera.eye[i] - camera.target[i]);
    }
    assert_true(fabs(distance - 1) < 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_box_fills_the_picture),
        cmocka_unit_test(test_up_is_above),
        cmocka_unit_test(test_a_near_tie_stays_z_up),
        cmocka_unit_test(test_the_longer_side_lies_across),
        cmocka_unit_test(test_the_surface_fills_the_picture),
        cmocka_unit_test(test_the_tunnel),
        cmocka_unit_test(test_flat_lights_face_the_model),
        cmocka_unit_test(test_a_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
