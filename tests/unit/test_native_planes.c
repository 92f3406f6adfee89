/* The native device's planes, against the limit surface in double precision at the places that the
 * planes name, and against the planes of the GL device. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/unit/native_tile.h"

/* --- the surface in double */

struct errors {
    double normal[PX], off_px[PX], curvature[PX];
    size_t n, n_curvature;
};

static void add_errors(const struct limit_tables *tables, const struct view *view,
                       const struct planes *planes, size_t i, struct errors *errors)
{
    struct limit_point p = {0};
    if (!limit_evaluate(tables, planes->face[i], (double)planes->at.u[i], (double)planes->at.v[i],
                        &p))
        fail_msg("pixel %zu shows a hole of face %u", i, planes->face[i]);
    const double world[3] = {p.s.x, p.s.y, p.s.z};
    double camera[3], k[2], own[2], diagonal = 0;
    view_transform(view, world, camera);
    double px = view->units_per_px * (view->perspective ? camera[2] : 1);
    errors->off_px[errors->n] =
        hypot(camera[0] / px + view->centre_px[0] - (double)(i % WIDTH) - 0.5,
              camera[1] / px + view->centre_px[1] - (double)(i / WIDTH) - 0.5);
    errors->normal[errors->n++] = angle(normal_at(planes, i), p.n);
    for (int a = 0; a < 3; a++)
        diagonal = hypot(diagonal, tables->box_max[a] - tables->box_min[a]);
    if (!principal_at(&p, k))
        return;
    principal((double)planes->at.shape[0][i], (double)planes->at.shape[1][i],
              (double)planes->at.shape[2][i], own);
    double large = fmax(fmax(fabs(k[0]), fabs(k[1])), 1 / diagonal);
    errors->curvature[errors->n_curvature++] =
        fmax(fabs(own[0] - k[0]), fabs(own[1] - k[1])) / large;
}

/* Every pixel lies on its ray, and its normal and curvatures are the surface's there. */
static void expect_exact(const struct limit_tables *tables, const struct camera *camera,
                         const struct planes *planes, const char *what)
{
    static struct errors errors;
    struct view view;
    view_init(&view, camera, WIDTH, HEIGHT, tables->hull_min, tables->hull_max);
    errors.n = errors.n_curvature = 0;
    for (size_t i = 0; i < PX; i++)
        if (planes->at.depth[i] > 0)
            add_errors(tables, &view, planes, i, &errors);
    double normal = quantile(errors.normal, errors.n, 0.999);
    double off_px = quantile(errors.off_px, errors.n, 0.999);
    double curvature = quantile(errors.curvature, errors.n_curvature, 0.999);
    /* u and v are rounded to single precision, which moves a place by this share of the model's
     * size */
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = hypot(size, tables->box_max[k] - tables->box_min[k]);
    double near_z = INFINITY;
    for (size_t i = 0; i < PX; i++)
        if (planes->at.depth[i] > 0)
            near_z = fmin(near_z, (double)planes->at.depth[i]);
    double most_px = 0.002 + 2e-7 * size / (view.units_per_px * (view.perspective ? near_z : 1));
    if (getenv("VERBOSE"))
        fprintf(stderr, "%s: %zu px, normal %.2g rad, %.2g px (of %.2g), curvature %.2g\n", what,
                errors.n, normal, off_px, most_px, curvature);
    if (errors.n < PX / 50 && !strstr(what, LOOK_NAMES[INSIDE]))
        fail_msg("%s: only %zu pixels show surface", what, errors.n);
    if (!(normal <= 2e-6 && off_px <= most_px && curvature <= 1e-4))
        fail_msg("%s: normals are off by %g rad, places by %g px of %g, curvatures by %g", what,
                 normal, off_px, most_px, curvature);
}

static void test_exact(void **state)
{
    (void)state;
    struct planes planes;
    planes_init(&planes);
    for (size_t m = 0; m < N_MODELS; m++) {
        struct limit_tables tables = {0};
        const struct native_set *set;
        build_file(MODELS[m], &tables);
        struct native_model *model = open_model(&tables);
        for (unsigned s = 0; (set = native_set_at(s)); s++) {
            struct native_device *device = open_device(set->name, 1);
            for (int look = 0; look < N_LOOKS; look++) {
                char what[200];
                if (native_set_at(s + 1) && look != (int)((m + s) % N_LOOKS))
                    continue; /* the widest set draws all views, every other set one view of each
                               * model */
                snprintf(what, sizeof what, "%s, %s, %s", MODELS[m], LOOK_NAMES[look], set->name);
                const struct camera camera = camera_for(&tables, (enum look)look);
                draw(device, model, &camera, &planes);
                expect_exact(&tables, &camera, &planes, what);
            }
            native_device_destroy(device);
        }
        native_model_destroy(model);
        limit_tables_finish(&tables);
    }
    planes_finish(&planes);
}

/* --- borders */

/* Considers the four borders of a Ptex face in double precision, by u and v alone. Finds, of the
 * borders no wider than THIN px, the nearest one, writes its foot (px) and its width, and returns
 * whether the pixel shows no rounding. */
static bool border_at(const struct limit_node *root, const struct view *view,
                      const struct limit_point *p, double u, double v, double foot[2],
                      double *width)
{
    const double THIN = 0.5, WIDE = 6, HALF_PIXEL = 0.71, NONE = 2047.0 / 512;
    const struct vec ways[2] = {p->su, p->sv};
    const double world[3] = {p->s.x, p->s.y, p->s.z}, away[4] = {v, 1 - u, 1 - v, u};
    double at[3], along[2][2];
    view_transform(view, world, at);
    for (int k = 0; k < 2; k++) {
        double c[3];
        for (int a = 0; a < 3; a++)
            c[a] = view->axis[a][0] * ways[k].x + view->axis[a][1] * ways[k].y +
                   view->axis[a][2] * ways[k].z;
        for (int a = 0; a < 2; a++) {
            double slope = view->perspective ? at[a] / at[2] : 0;
            double px = view->units_per_px * (view->perspective ? at[2] : 1);
            along[k][a] = (c[a] - slope * c[2]) / px;
        }
    }
    double area = along[0][0] * along[1][1] - along[0][1] * along[1][0];
    bool is_plain = true;
    foot[0] = foot[1] = NONE;
    *width = 0;
    for (int e = 0; e < 4; e++) {
        unsigned border = root->borders >> 4 * e & 15;
        const double *other = along[e & 1]; /* the direction of the edge */
        double length = hypot(other[0], other[1]), out = e == 0 || e == 3 ? -1 : 1;
        if (!border)
            continue;
        /* Perpendicular to the edge, as far as one step of u or v leads. */
        double far = area / (length * length) * (e & 1 ? 1 : -1);
        const double to[2] = {other[1] * far * out, -other[0] * far * out};
        double rounding = border == LIMIT_BORDER_SHARP ? 0 : ldexp(1, -(int)border);
        double rounding_px = rounding * hypot(to[0], to[1]);
        double beyond_px = (away[e] - rounding) * hypot(to[0], to[1]);
        is_plain =
            is_plain && !(rounding_px >= THIN && rounding_px < WIDE && beyond_px < HALF_PIXEL);
        double go = away[e] < rounding ? 0 : away[e];
        if (rounding_px >= THIN || hypot(go * to[0], go * to[1]) >= hypot(foot[0], foot[1]))
            continue;
        foot[0] = go * to[0];
        foot[1] = go * to[1];
        *width = rounding_px;
    }
    for (int k = 0; k < 2; k++)
        foot[k] = fmin(fmax(foot[k], -NONE), NONE);
    return is_plain;
}

/* Counts the pixels of a model that show a border within 4 px; those that are wrong are counted in
 * *n_off. */
static size_t count_borders(const struct limit_tables *tables, const struct view *view,
                            const struct planes *planes, size_t *n_rounded, size_t *n_off)
{
    const uint32_t ROUNDED = 0x800;
    size_t n = 0;
    for (size_t i = 0; i < PX; i++) {
        struct limit_point p = {0};
        double u = (double)planes->at.u[i], v = (double)planes->at.v[i], foot[2], width;
        if (!(planes->at.depth[i] > 0) || !limit_evaluate(tables, planes->face[i], u, v, &p))
            continue;
        uint32_t border = planes->border[i];
        bool is_plain = border_at(&tables->nodes[planes->face[i]], view, &p, u, v, foot, &width);
        *n_rounded += border == ROUNDED;
        if (is_plain != (border != ROUNDED)) {
            (*n_off)++;
            continue;
        }
        int x = (int)(border << 20) >> 20, y = (int)(border << 8) >> 20;
        n += is_plain && (x != 2047 || y != 2047);
        /* The error allowed is a step of 1/512 px, and 2e-3 px for u and v in single precision. */
        *n_off +=
            is_plain && (fabs(x / 512.0 - foot[0]) > 0.003 || fabs(y / 512.0 - foot[1]) > 0.003 ||
                         fabs((border >> 24) / 510.0 - width) > 0.004);
    }
    return n;
}

static void test_borders(void **state)
{
    (void)state;
    static const char *const models[] = {"tests/models/creases.obj", "tests/models/fender.obj",
                                         "tests/models/nonmanifold.obj"};
    struct planes planes;
    size_t n = 0, n_rounded = 0;
    planes_init(&planes);
    struct native_device *device = open_device(NULL, 1);
    for (size_t m = 0; m < sizeof models / sizeof *models; m++) {
        struct limit_tables tables = {0};
        build_file(models[m], &tables);
        struct native_model *model = open_model(&tables);
        for (int look = 0; look < N_LOOKS; look++) {
            const struct camera camera = camera_for(&tables, (enum look)look);
            struct view view;
            size_t n_off = 0;
            view_init(&view, &camera, WIDTH, HEIGHT, tables.hull_min, tables.hull_max);
            draw(device, model, &camera, &planes);
            n += count_borders(&tables, &view, &planes, &n_rounded, &n_off);
            if (n_off > PX / 5000)
                fail_msg("%s, %s: the border of %zu pixels is off", models[m], LOOK_NAMES[look],
                         n_off);
        }
        native_model_destroy(model);
        limit_tables_finish(&tables);
    }
    assert_true(n > 5000);
    assert_true(n_rounded > 500);
    native_device_destroy(device);
    planes_finish(&planes);
}

/* --- the GL device */

/* Whether this pixel and one of its neighbours differ in being hit, or show that face, or whether
 * depths jump between them. */
static bool is_at_edge(const struct frame *frame, const struct planes *planes, size_t i)
{
    const uint32_t(*ptex)[3] = frame->plane[3];
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            int at_x = (int)(i % WIDTH) + x, at_y = (int)(i / WIDTH) + y;
            if (at_x < 0 || at_y < 0 || at_x >= WIDTH || at_y >= HEIGHT)
                continue;
            size_t k = (size_t)at_y * WIDTH + (size_t)at_x;
            bool is_hit = planes->at.depth[i] > 0;
            if (is_hit ? ptex[k][0] == planes->face[i] : ptex[k][0] == UINT32_MAX)
                return true;
        }
    }
    return false;
}

/* How far the surface's normal turns between the places that both devices name. The GL device's
 * place may lie as far from the ray as close_enough() of newton.glsl allows. */
static double turn_between(const struct limit_tables *tables, const struct planes *planes,
                           const uint32_t ptex[3], size_t i)
{
    struct limit_point own = {0}, gl = {0};
    float uv[2];
    memcpy(uv, ptex + 1, sizeof uv);
    limit_evaluate(tables, ptex[0], (double)planes->at.u[i], (double)planes->at.v[i], &own);
    limit_evaluate(tables, ptex[0], (double)uv[0], (double)uv[1], &gl);
    return angle(own.n, gl.n);
}

/* The distance of both devices' positions in px. */
static double apart_px(const struct view *view, const struct planes *planes, const float gl[3],
                       size_t i)
{
    double z = (double)planes->at.depth[i], off = 0;
    double px = view->units_per_px * (view->perspective ? z : 1);
    double right = ((double)(i % WIDTH) + 0.5 - view->centre_px[0]) * px;
    double down = ((double)(i / WIDTH) + 0.5 - view->centre_px[1]) * px;
    for (int k = 0; k < 3; k++)
        off = hypot(off, view->eye[k] + right * view->axis[0][k] + down * view->axis[1][k] +
                             z * view->axis[2][k] - (double)gl[k]);
    return off / px;
}

static void compare_with_gl(const struct limit_tables *tables, const struct camera *camera,
                            const struct frame *frame, const struct planes *planes,
                            const char *what, bool is_zoomed)
{
    static double normals[PX], apart[PX];
    const float(*position)[3] = frame->plane[1], (*normal)[3] = frame->plane[2];
    const uint32_t(*ptex)[3] = frame->plane[3];
    struct view view;
    size_t n = 0, n_differ = 0, n_hits = 0;
    view_init(&view, camera, WIDTH, HEIGHT, tables->hull_min, tables->hull_max);
    for (size_t i = 0; i < PX; i++) {
        bool is_hit = planes->at.depth[i] > 0, is_gl_hit = ptex[i][0] != UINT32_MAX;
        double off_px = is_hit && is_gl_hit ? apart_px(&view, planes, position[i], i) : INFINITY;
        n_hits += is_hit;
        if (is_hit != is_gl_hit || (is_hit && planes->face[i] != ptex[i][0])) {
            n_differ += off_px > 0.02; /* closer than that: on the line between two faces */
            if (!is_at_edge(frame, planes, i) && off_px > 0.02)
                fail_msg("%s: pixel %zu,%zu shows face %u by GL, %u here", what, i % WIDTH,
                         i / WIDTH, ptex[i][0], is_hit ? planes->face[i] : UINT32_MAX);
            continue;
        }
        if (!is_hit || !(normal[i][0] == normal[i][0]))
            continue;
        const struct vec gl = {(double)normal[i][0], (double)normal[i][1], (double)normal[i][2]};
        apart[n] = off_px;
        normals[n++] = angle(normal_at(planes, i), gl) - turn_between(tables, planes, ptex[i], i);
    }
    double worst = quantile(normals, n, 0.999), far = quantile(apart, n, 0.99);
    if (getenv("VERBOSE"))
        fprintf(stderr, "%s: %zu of %zu hits differ, normals %.2g rad, P %.2g px\n", what, n_differ,
                n_hits, worst, far);
    if (n_differ > n_hits / (is_zoomed ? 50 : 500) + 5)
        fail_msg("%s: %zu of %zu pixels show another face than by GL", what, n_differ, n_hits);
    if (!(worst <= 2e-6 && (far <= 0.02 || is_zoomed)))
        fail_msg("%s: normals differ from GL's by %g rad, P by %g px", what, worst, far);
}

static void test_gl(void **state)
{
    (void)state;
    struct planes planes;
    planes_init(&planes);
    struct native_device *device = open_device(NULL, 2);
    for (size_t m = 0; m < N_MODELS; m++) {
        struct scene scene = {0};
        build_file(MODELS[m], &scene.tables);
        scene.renderer = open_renderer(0);
        scene.model = upload(scene.renderer, &scene.tables);
        struct native_model *model = open_model(&scene.tables);
        struct frame_request request = request_for(&scene.tables, WIDTH, HEIGHT);
        request.planes = PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX;
        for (int look = 0; look < N_LOOKS; look++) {
            char what[200];
            if (look == FAR) /* the GL device's depths are too coarse to compare faces */
                continue;
            snprintf(what, sizeof what, "%s, %s", MODELS[m], LOOK_NAMES[look]);
            request.camera = camera_for(&scene.tables, (enum look)look);
            struct frame frame = render(scene.renderer, scene.model, &request);
            draw(device, model, &request.camera, &planes);
            compare_with_gl(&scene.tables, &request.camera, &frame, &planes, what, false);
            frame_finish(&frame);
        }
        native_model_destroy(model);
        scene_finish(&scene);
    }
    native_device_destroy(device);
    planes_finish(&planes);
}

/* An extraordinary vertex, from where a pixel is 2^-24 of a face. */
static struct camera zoomed_on(const struct limit_tables *tables, size_t corner, bool orthographic)
{
    double size = (double)tables->whole[corner].radius;
    const struct limit_place place = {(uint32_t)corner, tables->nodes[corner].rotation, 0, 0};
    struct limit_point vertex;
    assert_true(limit_evaluate_at(tables, &place, &vertex));
    struct vec aside = fabs(vertex.n.x) < 0.7 ? (struct vec){1, 0, 0} : (struct vec){0, 1, 0};
    struct vec across = vec_unit(vec_cross(vertex.n, aside));
    struct vec eye = vec_mad(vertex.s, 0.1 * size, vec_mad(vertex.n, 0.5, across));
    return (struct camera){.kind = orthographic ? CAMERA_ORTHOGRAPHIC : CAMERA_PERSPECTIVE,
                           .fov_deg = ldexp(HEIGHT, -24) * 10 * 57,
                           .ortho_height = ldexp(size, -24) * HEIGHT,
                           .eye = {eye.x, eye.y, eye.z},
                           .target = {vertex.s.x, vertex.s.y, vertex.s.z},
                           .up = {aside.x, aside.y, aside.z}};
}

/* The native device agrees with the GL device there, too. Positions in single precision do not
 * distinguish pixels at this zoom, and neither do u and v. */
static void test_zoom(void **state)
{
    (void)state;
    struct planes planes;
    planes_init(&planes);
    struct native_device *device = open_device(NULL, 2);
    for (size_t m = 0; m < N_MODELS; m++) {
        struct scene scene = {0};
        unsigned n = 0;
        build_file(MODELS[m], &scene.tables);
        scene.renderer = open_renderer(0);
        scene.model = upload(scene.renderer, &scene.tables);
        struct native_model *model = open_model(&scene.tables);
        struct frame_request request = request_for(&scene.tables, WIDTH, HEIGHT);
        request.planes = PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX;
        for (size_t i = 5 * m; i < scene.tables.n_nodes && n < 2; i++) {
            const struct limit_node *node = &scene.tables.nodes[i];
            if (node->kind != LIMIT_CORNER || node->levels & LIMIT_NO_NORMAL)
                continue;
            char what[200];
            snprintf(what, sizeof what, "%s, node %zu, %s", MODELS[m], i,
                     n ? "orthographic" : "perspective");
            request.camera = zoomed_on(&scene.tables, i, n++);
            struct frame frame = render(scene.renderer, scene.model, &request);
            draw(device, model, &request.camera, &planes);
            assert_true(hits(&frame) > PX / 4);
            compare_with_gl(&scene.tables, &request.camera, &frame, &planes, what, true);
            frame_finish(&frame);
        }
        native_model_destroy(model);
        scene_finish(&scene);
    }
    native_device_destroy(device);
    planes_finish(&planes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_exact), cmocka_unit_test(test_borders),
                                       cmocka_unit_test(test_gl), cmocka_unit_test(test_zoom)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
