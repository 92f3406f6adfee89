/* Polygons and wireframes on the native device against those of the GL device. */
#include "tests/unit/native_scene.h"

#include <math.h>

#include "server/surface/evaluate.h"

enum { WIDTH = 200, HEIGHT = 150, PIXELS = WIDTH * HEIGHT };

static const char *const models[] = {
    "tests/models/body.obj",  "tests/models/creases.obj",     "tests/models/fender.obj",
    "tests/models/ngons.obj", "tests/models/nonmanifold.obj", "tests/models/pole.obj",
    "tests/models/sheet.obj", "tests/models/tetra.obj",
};

/* Pixels at which both frames show a face, and for each plane the number of these pixels whose
 * values differ by more than rounding. */
struct planes {
    int both, position, normal, uv, curvature;
};

static double distance(const float *a, const float *b, int n)
{
    double sum = 0;
    for (int k = 0; k < n; k++)
        sum = hypot(sum, (double)a[k] - (double)b[k]);
    return sum;
}

/* `size`: the size of the model, by which positions are compared. Curvatures come from differences
 * of normals between pixels, so they are compared by how far the normal turns over a pixel of `px`
 * units. */
static struct planes compare_planes(const struct frame *a, const struct frame *b, double size,
                                    double px)
{
    struct planes found = {0};
    for (int i = 0; i < PIXELS; i++) {
        const float *const place[2] = {(const float *)a->plane[1] + 3 * i,
                                       (const float *)b->plane[1] + 3 * i};
        const float *const normal[2] = {(const float *)a->plane[2] + 3 * i,
                                        (const float *)b->plane[2] + 3 * i};
        const uint32_t *const ptex[2] = {(const uint32_t *)a->plane[3] + 3 * i,
                                         (const uint32_t *)b->plane[3] + 3 * i};
        const float *const curvature[2] = {(const float *)a->plane[5] + 2 * i,
                                           (const float *)b->plane[5] + 2 * i};
        float uv[2][2];
        if (ptex[0][0] == UINT32_MAX || ptex[0][0] != ptex[1][0])
            continue;
        memcpy(uv[0], ptex[0] + 1, sizeof uv[0]);
        memcpy(uv[1], ptex[1] + 1, sizeof uv[1]);
        found.both++;
        found.position += distance(place[0], place[1], 3) > 1e-5 * size;
        found.normal += distance(normal[0], normal[1], 3) > 1e-3;
        found.uv += distance(uv[0], uv[1], 2) > 1e-3;
        double turn = distance(curvature[0], curvature[1], 2) * px;
        double most = px * fmax(fabs((double)curvature[0][0]), fabs((double)curvature[0][1]));
        found.curvature += turn > 1e-4 + 0.02 * most;
    }
    return found;
}

/* Returns the number of pixels that show a face in both frames. */
static int assert_same_pictures(struct devices *devices, const struct frame_request *request,
                                const char *what)
{
    struct frame frames[DEVICES];
    const struct limit_tables *tables = &devices->tables;
    double size = 0, far = 0;
    for (int i = 0; i < DEVICES; i++)
        frames[i] = render(devices->renderer[i], devices->model[i], request);
    for (int k = 0; k < 3; k++) {
        size = hypot(size, tables->box_max[k] - tables->box_min[k]);
        far = hypot(far, request->camera.eye[k] - 0.5 * (tables->box_max[k] + tables->box_min[k]));
    }
    struct difference found = compare(&frames[0], &frames[1]);
    double px = request->camera.kind == CAMERA_ORTHOGRAPHIC
                    ? request->camera.ortho_height / HEIGHT
                    : 2 * far * tan(request->camera.fov_deg * 3.14159265 / 360) / HEIGHT;
    struct planes planes = compare_planes(&frames[0], &frames[1], size + far, px);
    assert_alike(&found, what);
    /* Beside an edge, the two devices may show different triangles of the edge. */
    if (planes.position > planes.both / 500 || planes.normal > planes.both / 500 ||
        planes.uv > planes.both / 500 || planes.curvature > planes.both / 100)
        fail_msg("%s: of %d pixels places %d, normals %d, uv %d, curvatures %d", what, planes.both,
                 planes.position, planes.normal, planes.uv, planes.curvature);
    for (int i = 0; i < DEVICES; i++)
        frame_finish(&frames[i]);
    return planes.both;
}

static struct frame_request request_of(const struct devices *devices, int kind, uint32_t level)
{
    struct frame_request request = request_for(&devices->tables, WIDTH, HEIGHT);
    request.planes |= PLANE_CURVATURE;
    request.surface = (struct surface){kind ? SURFACE_WIREFRAME : SURFACE_POLYGON, level};
    return request;
}

static double diagonal_of(const struct limit_tables *tables)
{
    double diagonal = 0;
    for (int k = 0; k < 3; k++)
        diagonal = hypot(diagonal, tables->box_max[k] - tables->box_min[k]);
    return diagonal;
}

static void test_models(void **state)
{
    (void)state;
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        struct devices devices;
        open_devices(&devices, models[m]);
        for (int k = 0; k < 8; k++) {
            struct frame_request request = request_of(&devices, k & 1, (uint32_t)k / 2);
            char what[100];
            if (k & 2) {
                request.camera.kind = CAMERA_ORTHOGRAPHIC;
                request.camera.ortho_height = diagonal_of(&devices.tables);
            }
            snprintf(what, sizeof what, "%s, %s, level %u%s", models[m],
                     k & 1 ? "wires" : "polygons", request.surface.level,
                     k & 2 ? ", orthographic" : "");
            assert_true(assert_same_pictures(&devices, &request, what) > 1000);
        }
        close_devices(&devices);
    }
}

/* Eyes in the middle of the model and near its surface: edges cross the near plane, and reach far
 * beyond the picture. */
static void test_eyes_inside(void **state)
{
    static const double towards[][3] = {{1, 0.1, 0.2}, {-0.3, 1, -0.1}, {0.2, -0.1, -1}};
    int seen = 0;
    (void)state;
    for (int m = 0; m < 3; m++) {
        struct devices devices;
        open_devices(&devices, models[m]);
        const struct limit_tables *tables = &devices.tables;
        double diagonal = diagonal_of(tables);
        for (int k = 0; k < 12; k++) {
            struct frame_request request = request_of(&devices, k & 1, (uint32_t)(k % 3));
            struct camera *camera = &request.camera;
            char what[100];
            camera->fov_deg = k & 4 ? 30 : 110;
            if (k % 5 == 4) {
                camera->kind = CAMERA_ORTHOGRAPHIC;
                camera->ortho_height = 0.3 * diagonal;
            }
            for (int i = 0; i < 3; i++) {
                double middle = 0.5 * (tables->box_min[i] + tables->box_max[i]);
                camera->eye[i] = middle + 0.02 * k * (tables->box_max[i] - middle);
                camera->target[i] = camera->eye[i] + diagonal * towards[k % 3][i];
            }
            memcpy(camera->up, (const double[3]){0.1, 0.2, 1}, sizeof camera->up);
            if (k % 3 == 2)
                memcpy(camera->up, (const double[3]){1, 0.2, 0.1}, sizeof camera->up);
            snprintf(what, sizeof what, "inside %s, camera %d", models[m], k);
            seen += assert_same_pictures(&devices, &request, what);
        }
        close_devices(&devices);
    }
    assert_true(seen > 10 * PIXELS);
}

/* From a distance of 100 times the model's size, and so near that a polygon is larger than the
 * picture. */
static void test_far_and_near(void **state)
{
    struct devices devices;
    (void)state;
    open_devices(&devices, "tests/models/fender.obj");
    for (int k = 0; k < 4; k++) {
        struct frame_request request = request_of(&devices, k & 1, 1);
        struct camera *camera = &request.camera;
        struct limit_point middle = {0};
        assert_true(limit_evaluate(&devices.tables, 0, 0.5, 0.5, &middle));
        const double place[3] = {middle.s.x, middle.s.y, middle.s.z};
        for (int i = 0; i < 3 && k < 2; i++)
            camera->eye[i] += 1e2 * (camera->eye[i] - camera->target[i]);
        if (k >= 2)
            memcpy(camera->target, place, sizeof place);
        camera->fov_deg *= k < 2 ? 1e-2 : 0.01;
        assert_true(assert_same_pictures(&devices, &request, k < 2 ? "far away" : "near") > 1000);
    }
    close_devices(&devices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_models),
        cmocka_unit_test(test_eyes_inside),
        cmocka_unit_test(test_far_and_near),
    };
    return cmocka_run_group_tests_name("native_polygons", tests, NULL, NULL);
}
