/* The camera of a turntable at many angles, compared with a separate projection of the box. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "client/cli/turntable.h"

#define PI 3.14159265358979323846
#define N_ANGLES 720

static double between(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit_cross(const double a[3], const double b[3], double out[3])
{
    const double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                         a[0] * b[1] - a[1] * b[0]};
    for (int i = 0; i < 3; i++)
        out[i] = c[i] / sqrt(dot(c, c));
}

/* The largest distance of a corner of the box from the picture's middle, in halves of the
 * picture. */
static double outermost(const struct sheen_camera *camera, const double box[2][3], double aspect)
{
    double ahead[3], right[3], above[3], most = 0, tangent = tan(camera->fov_deg * PI / 360);
    for (int i = 0; i < 3; i++)
        ahead[i] = camera->target[i] - camera->eye[i];
    double length = sqrt(dot(ahead, ahead));
    unit_cross(ahead, camera->up, right);
    unit_cross(right, ahead, above);
    for (int corner = 0; corner < 8; corner++) {
        double arm[3];
        for (int i = 0; i < 3; i++)
            arm[i] = box[corner >> i & 1][i] - camera->eye[i];
        double depth = dot(arm, ahead) / length;
        assert_true(depth > 0);
        most = fmax(most, fabs(dot(arm, right)) / (depth * tangent * aspect));
        most = fmax(most, fabs(dot(arm, above)) / (depth * tangent));
    }
    return most;
}

/* A random box, and a camera that looks at a place in it and not along `axis`. */
static struct sheen_camera random_scene(double box[2][3], double axis[3])
{
    struct sheen_camera camera = {.fov_deg = between(5, 90)};
    double size = pow(10, between(-3, 3)), tip[3];
    for (int i = 0; i < 3; i++) {
        box[0][i] = size * between(-2, 2);
        box[1][i] = box[0][i] + size * between(0, 1);
        axis[i] = between(-1, 1);
        tip[i] = between(-1, 1);
        camera.target[i] = between(box[0][i], box[1][i]);
        camera.eye[i] = camera.target[i] + size * between(-1, 1);
        camera.up[i] = axis[i];
    }
    if (rand() % 3 == 0) /* the camera is tilted: its up is not the axis */
        for (int i = 0; i < 3; i++)
            camera.up[i] = tip[i];
    return camera;
}

static void the_box_stays_in_the_picture(void **state)
{
    (void)state;
    srand(7);
    for (int round = 0; round < 200; round++) {
        double box[2][3], axis[3], middle[3], most = 0, aspect = between(0.3, 3);
        struct sheen_camera start = random_scene(box, axis), camera;
        for (int i = 0; i < 3; i++)
            middle[i] = 0.5 * (box[0][i] + box[1][i]);
        turntable_fit(&start, axis, box[0], box[1], aspect, middle);
        assert_memory_equal(start.target, middle, sizeof(middle));
        for (int i = 0; i < N_ANGLES; i++) {
            turntable_turn(&start, axis, 2 * PI * i / N_ANGLES, &camera);
            most = fmax(most, outermost(&camera, box, aspect));
        }
        assert_true(most <= 0.92 * (1 + 1e-9));
        assert_true(most > 0.92 * 0.995); /* no further away than needed */
    }
}

static double distance_of(const struct sheen_camera *camera)
{
    double arm[3];
    for (int i = 0; i < 3; i++)
        arm[i] = camera->eye[i] - camera->target[i];
    return sqrt(dot(arm, arm));
}

/* With a target of its own, the camera moves back as far as it must, and never nearer. */
static void a_target_of_its_own(void **state)
{
    (void)state;
    const double box[2][3] = {{-2, -1, 0}, {2, 1, 1}}, axis[3] = {0, 0, 3};
    struct sheen_camera near = {.eye = {5, -6, 5}, .target = {2, 0, 0}, .up = {0, 0, 1}};
    near.fov_deg = 35;
    struct sheen_camera far = near, camera;
    for (int i = 0; i < 3; i++)
        far.eye[i] = far.target[i] + 100 * (far.eye[i] - far.target[i]);
    struct sheen_camera back = near, stays = far;
    turntable_fit(&back, axis, box[0], box[1], 1.5, NULL);
    turntable_fit(&stays, axis, box[0], box[1], 1.5, NULL);
    assert_memory_equal(back.target, near.target, sizeof(near.target));
    assert_true(distance_of(&back) > 1.2 * distance_of(&near));
    assert_true(fabs(distance_of(&stays) / distance_of(&far) - 1) < 1e-12);
    for (int i = 0; i < N_ANGLES; i++) {
        turntable_turn(&back, axis, 2 * PI * i / N_ANGLES, &camera);
        assert_true(outermost(&camera, box, 1.5) <= 0.92 * (1 + 1e-9));
    }
}

/* A camera that looks along the axis rotates about its line of sight: the eye stays, up turns. */
static void a_plan_turns_without_tipping(void **state)
{
    (void)state;
    const double axis[3] = {0, 0, 2};
    const struct sheen_camera plan = {.eye = {1, 2, 9}, .target = {1, 2, 0}, .up = {0, 1, 0}};
    struct sheen_camera camera;
    turntable_turn(&plan, axis, PI / 6, &camera);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(camera.eye[i] - plan.eye[i]) < 1e-12);
    assert_true(fabs(camera.up[0] + 0.5) < 1e-12 && fabs(camera.up[1] - sqrt(0.75)) < 1e-12);
    /* If up is along the axis, of any length, it remains as given. */
    const struct sheen_camera side = {.eye = {5, 0, 1}, .up = {0, 0, 3}};
    turntable_turn(&side, axis, PI / 2, &camera);
    assert_memory_equal(camera.up, side.up, sizeof(side.up));
    assert_true(fabs(camera.eye[1] - 5) < 1e-12 && fabs(camera.eye[2] - 1) < 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_box_stays_in_the_picture),
        cmocka_unit_test(a_target_of_its_own),
        cmocka_unit_test(a_plan_turns_without_tipping),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
