/* The planes of the native device: against the limit surface in double at the places that they name,
 * against the GL device's, one instruction set against the other, and one number of threads and one
 * cut into tiles against the other. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/render/native/native.h"
#include "server/render/native/patches.h"
#include "server/render/native/sets.h"
#include "server/render/native/tile.h"
#include "server/surface/evaluate.h"
#include "tests/unit/gap_scene.h"
#include "tests/unit/renderer_frames.h"

enum { WIDTH = 320, HEIGHT = 240, PX = WIDTH * HEIGHT };

static const char *const MODELS[] = {"tests/models/body.obj",    "tests/models/fender.obj",
                                     "tests/models/creases.obj", "tests/models/pole.obj",
                                     "tests/models/ngons.obj",   "tests/models/nonmanifold.obj",
                                     "tests/models/tetra.obj",   "tests/models/chaikin.obj"};
enum { N_MODELS = sizeof MODELS / sizeof *MODELS };

/* --- planes, and who makes them */

struct planes {
    struct native_planes at;
    float *floats; /* all of them */
    uint32_t *face, *border, *node, *where;
};

static void planes_init(struct planes *planes)
{
    enum { FLOATS = 9 };
    planes->floats = calloc(FLOATS * PX, sizeof(float));
    planes->face = calloc(PX, sizeof(uint32_t));
    planes->border = calloc(PX, sizeof(uint32_t));
    planes->node = calloc(PX, sizeof(uint32_t));
    planes->where = calloc(PX, sizeof(uint32_t));
    assert_true(planes->floats && planes->face && planes->border && planes->node && planes->where);
    float *f = planes->floats;
    planes->at = (struct native_planes){.pitch = WIDTH,
                                        .depth = f,
                                        .normal = {f + PX, f + 2 * PX, f + 3 * PX},
                                        .shape = {f + 4 * PX, f + 5 * PX, f + 6 * PX},
                                        .u = f + 7 * PX,
                                        .v = f + 8 * PX,
                                        .face = planes->face,
                                        .border = planes->border,
                                        .node = planes->node,
                                        .where = planes->where};
}

static void planes_finish(struct planes *planes)
{
    free(planes->floats);
    free(planes->face);
    free(planes->border);
    free(planes->node);
    free(planes->where);
}

/* All that is written for a pixel is the same. */
static bool is_same(const struct planes *a, const struct planes *b, size_t i)
{
    for (size_t k = 0; k < 9 && (a->at.depth[i] > 0 || k == 0); k++)
        if (memcmp(&a->floats[k * PX + i], &b->floats[k * PX + i], sizeof(float)) != 0)
            return false;
    return !(a->at.depth[i] > 0) || (a->face[i] == b->face[i] && a->border[i] == b->border[i]);
}

static struct native_device *open_device(const char *set, unsigned n_threads)
{
    const struct native_options options = {.n_threads = n_threads, .set = set};
    struct error error = {0};
    struct native_device *device = native_device_create(&options, &error);
    if (!device)
        fail_msg("%s", error.text);
    return device;
}

static struct native_model *open_model(const struct limit_tables *tables)
{
    struct error error = {0};
    struct native_model *model = native_model_create(tables, NATIVE_PATCH_BYTES, &error);
    if (!model)
        fail_msg("%s", error.text);
    return model;
}

static void draw_tile(struct native_device *device, struct native_model *model,
                      const struct camera *camera, const struct tile *tile, struct planes *planes)
{
    struct error error = {0};
    struct view view;
    const struct limit_tables *tables = model->tables;
    view_init(&view, camera, WIDTH, HEIGHT, tables->hull_min, tables->hull_max);
    if (!native_draw(device, model, &view, tile, &planes->at, NULL, &error))
        fail_msg("%s", error.text);
}

static void draw(struct native_device *device, struct native_model *model,
                 const struct camera *camera, struct planes *planes)
{
    const struct tile whole = {0, 0, WIDTH, HEIGHT};
    draw_tile(device, model, camera, &whole, planes);
}

/* --- cameras */

enum look { PLAIN, ORTHOGRAPHIC, CLOSE, CLOSE_ORTHOGRAPHIC, INSIDE, HALF, FAR, TOP, N_LOOKS };
static const char *const LOOK_NAMES[N_LOOKS] = {
    "plain", "orthographic", "close", "close orthographic", "inside", "half", "far", "top"};

static void move_eye(struct camera *camera, double factor)
{
    for (int k = 0; k < 3; k++)
        camera->eye[k] = camera->target[k] + factor * (camera->eye[k] - camera->target[k]);
}

/* A place that most views show. */
static void look_at_surface(const struct limit_tables *tables, struct camera *camera)
{
    struct limit_point p = {0};
    uint32_t face = (uint32_t)tables->n_faces / 2;
    while (!limit_evaluate(tables, face, 0.5, 0.5, &p))
        face++;
    const double at[3] = {p.s.x, p.s.y, p.s.z};
    for (int k = 0; k < 3; k++) {
        camera->eye[k] += at[k] - camera->target[k];
        camera->target[k] = at[k];
    }
}

static struct camera camera_for(const struct limit_tables *tables, enum look look)
{
    struct camera camera;
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = hypot(size, tables->box_max[k] - tables->box_min[k]);
    scene_default_camera(tables, NULL, look == TOP ? VIEW_TOP : VIEW_AROUND, WIDTH, HEIGHT,
                         &camera);
    if (look == ORTHOGRAPHIC || look == CLOSE_ORTHOGRAPHIC) {
        camera.kind = CAMERA_ORTHOGRAPHIC;
        camera.ortho_height = look == ORTHOGRAPHIC ? size : 0.05 * size;
    }
    if (look == CLOSE || look == CLOSE_ORTHOGRAPHIC)
        look_at_surface(tables, &camera);
    if (look == CLOSE)
        move_eye(&camera, 0.1);
    if (look == INSIDE) { /* surface reaches behind the eye */
        move_eye(&camera, 0.02);
        camera.fov_deg = 90;
    }
    if (look == HALF) { /* what lies behind the eye is not seen */
        camera.kind = CAMERA_ORTHOGRAPHIC;
        camera.ortho_height = size;
        move_eye(&camera, 1e-3);
    }
    if (look == FAR) {
        move_eye(&camera, 1e5);
        camera.fov_deg /= 1e5;
    }
    return camera;
}

/* --- figures */

static int compare(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return x < y ? -1 : x > y;
}

/* Sorts them; the value that so large a share of them are at most. 0 of none. */
static double quantile(double *values, size_t n, double share)
{
    qsort(values, n, sizeof *values, compare);
    return n ? values[(size_t)((double)(n - 1) * share)] : 0;
}

static double angle(struct vec a, struct vec b)
{
    return atan2(vec_length(vec_cross(a, b)), vec_dot(a, b));
}

static struct vec normal_at(const struct planes *planes, size_t i)
{
    return (struct vec){(double)planes->at.normal[0][i], (double)planes->at.normal[1][i],
                        (double)planes->at.normal[2][i]};
}

/* Principal curvatures of a shape operator. */
static void principal(double a, double b, double c, double k[2])
{
    double mean = (a + c) / 2, apart = hypot((a - c) / 2, b);
    k[0] = mean - apart;
    k[1] = mean + apart;
}

/* And of derivatives in double; false where they tell none. */
static bool principal_at(const struct limit_point *p, double k[2])
{
    double e = vec_dot(p->su, p->su), f = vec_dot(p->su, p->sv), g = vec_dot(p->sv, p->sv);
    double area2 = e * g - f * f;
    if (!(area2 > 1e-6 * e * g))
        return false;
    double twice_mean = (p->luu * g - 2 * p->luv * f + p->lvv * e) / area2;
    double gauss = (p->luu * p->lvv - p->luv * p->luv) / area2;
    double apart = sqrt(fmax(twice_mean * twice_mean / 4 - gauss, 0));
    k[0] = twice_mean / 2 - apart;
    k[1] = twice_mean / 2 + apart;
    return true;
}

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
    /* u and v are rounded to single precision: that moves a place by so much of the model. */
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
                    continue; /* all looks for the widest set, one of each model for the others */
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

/* Of a Ptex face's four borders in double, by u and v alone: the foot on the nearest that is no
 * wider than THIN px, px, and how wide that is. False where the pixel shows a rounding. */
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
        const double *other = along[e & 1]; /* the way that the edge runs */
        double length = hypot(other[0], other[1]), out = e == 0 || e == 3 ? -1 : 1;
        if (!border)
            continue;
        /* Across the edge, as far as one of u or v goes. */
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

/* How many of a model's pixels show a border within 4 px; those that are off are counted apart. */
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
        /* Steps of a 512th of a px, and 2e-3 px for u and v in single precision. */
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

/* Do any of the pixels around hold, with this one, both a hit and none, or that face? Or do depths
 * jump there? */
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

/* How far the surface's normal turns between the places that both devices name: GL's lies as far
 * from the ray as close_enough() of newton.glsl lets it. */
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

/* How far apart both devices' positions are, px. */
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
            n_differ += off_px > 0.02; /* nearer: on the line between two faces */
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
            if (look == FAR) /* depths of the GL device are too coarse to compare faces */
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

/* --- threads, tiles and sets */

static void test_threads(void **state)
{
    (void)state;
    static const unsigned counts[3] = {1, 2, 5};
    struct planes planes[3];
    struct limit_tables tables = {0};
    build_file("tests/models/creases.obj", &tables);
    for (int look = 0; look < N_LOOKS; look++) {
        const struct camera camera = camera_for(&tables, (enum look)look);
        for (int k = 0; k < 3; k++) {
            struct native_device *device = open_device(NULL, counts[k]);
            struct native_model *model = open_model(&tables);
            planes_init(&planes[k]);
            assert_int_equal(native_device_threads(device), counts[k]);
            draw(device, model, &camera, &planes[k]);
            for (size_t i = 0; i < PX; i++)
                if (!is_same(&planes[0], &planes[k], i))
                    fail_msg("%s: pixel %zu differs with %u threads", LOOK_NAMES[look], i,
                             counts[k]);
            native_model_destroy(model);
            native_device_destroy(device);
        }
        for (int k = 0; k < 3; k++)
            planes_finish(&planes[k]);
    }
    limit_tables_finish(&tables);
}

/* A part of the picture has the pixels of the whole. */
static void test_tiles(void **state)
{
    (void)state;
    static const struct tile tiles[] = {{0, 0, 1, 1},    {130, 70, 97, 33}, {160, 120, 160, 120},
                                        {127, 63, 2, 2}, {0, 100, 320, 1},  {128, 64, 128, 64},
                                        {319, 239, 1, 1}};
    struct planes whole, part;
    struct limit_tables tables = {0};
    struct native_device *device = open_device(NULL, 2);
    planes_init(&whole);
    planes_init(&part);
    build_file("tests/models/fender.obj", &tables);
    struct native_model *model = open_model(&tables);
    for (int look = 0; look < N_LOOKS; look++) {
        const struct camera camera = camera_for(&tables, (enum look)look);
        draw(device, model, &camera, &whole);
        for (size_t t = 0; t < sizeof tiles / sizeof *tiles; t++) {
            const struct tile *tile = &tiles[t];
            struct planes moved = part;
            memset(part.at.depth, 0x7f, PX * sizeof(float));
            draw_tile(device, model, &camera, tile, &part);
            for (size_t i = 0; i < (size_t)tile->width * tile->height; i++) {
                size_t x = i % tile->width, y = i / tile->width;
                /* Planes begin with the tile's first pixel. */
                size_t from = (y + tile->y) * WIDTH + x + tile->x, to = y * WIDTH + x;
                for (int k = 0; k < 9 && (k == 0 || whole.at.depth[from] > 0); k++)
                    if (memcmp(&whole.floats[k * PX + (int)from], &moved.floats[k * PX + (int)to],
                               sizeof(float)) != 0)
                        fail_msg(
                            "%s: pixel %zu,%zu differs in plane %d of tile %zu: %.9g, not %.9g",
                            LOOK_NAMES[look], x + tile->x, y + tile->y, k, t,
                            (double)moved.floats[k * PX + (int)to],
                            (double)whole.floats[k * PX + (int)from]);
            }
        }
    }
    native_model_destroy(model);
    native_device_destroy(device);
    limit_tables_finish(&tables);
    planes_finish(&whole);
    planes_finish(&part);
}

/* Two instruction sets agree as two devices do. */
static void test_sets(void **state)
{
    (void)state;
    struct planes widest, other;
    planes_init(&widest);
    planes_init(&other);
    static double normals[PX];
    for (size_t m = 0; m < N_MODELS; m++) {
        struct limit_tables tables = {0};
        const struct native_set *set;
        build_file(MODELS[m], &tables);
        const struct camera camera = camera_for(&tables, PLAIN);
        struct native_model *model = open_model(&tables);
        struct native_device *device = open_device(NULL, 1);
        draw(device, model, &camera, &widest);
        native_device_destroy(device);
        for (unsigned s = 0; (set = native_set_at(s)); s++) {
            size_t n = 0, n_differ = 0;
            device = open_device(set->name, 1);
            assert_string_equal(native_device_name(device), set->words);
            draw(device, model, &camera, &other);
            native_device_destroy(device);
            for (size_t i = 0; i < PX; i++) {
                bool is_hit = widest.at.depth[i] > 0,
                     is_same_face = widest.face[i] == other.face[i];
                if (is_hit != (other.at.depth[i] > 0) || (is_hit && !is_same_face))
                    n_differ++;
                else if (is_hit)
                    normals[n++] = angle(normal_at(&widest, i), normal_at(&other, i));
            }
            double worst = quantile(normals, n, 0.999);
            if (n_differ > n / 1000 + 2 || !(worst <= 2e-6))
                fail_msg("%s, %s: %zu of %zu pixels differ, normals by %g rad", MODELS[m],
                         set->name, n_differ, n, worst);
        }
        native_model_destroy(model);
        limit_tables_finish(&tables);
    }
    planes_finish(&widest);
    planes_finish(&other);
}

/* --- what is rare */

/* A node's place on its edge, so far outside of it. */
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

/* A step over any edge of any node leads to the surface beside it. */
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

/* Pixels that look between two borders a third of a pixel apart show the wall behind. */
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

/* A sharp vertex of six faces has no normal, and the one pixel that looks exactly at it shows none. */
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

/* An extraordinary vertex from where a pixel is 2^-24 of a face. */
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

/* There the GL device is followed, too. Places in the world in single precision tell no pixels
 * apart any more, nor do u and v. */
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

static void test_refuses(void **state)
{
    (void)state;
    const struct native_options options = {.n_threads = 1, .set = "v9"};
    struct error error = {0};
    assert_null(native_device_create(&options, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    native_device_destroy(NULL);
    native_model_destroy(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_exact),   cmocka_unit_test(test_borders), cmocka_unit_test(test_gl),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_tiles),   cmocka_unit_test(test_sets),
        cmocka_unit_test(test_walk),    cmocka_unit_test(test_gap),     cmocka_unit_test(test_tip),
        cmocka_unit_test(test_zoom),    cmocka_unit_test(test_refuses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
