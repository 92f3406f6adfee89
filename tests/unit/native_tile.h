/* Planes of stages 1 and 2 of the native device, the cameras of tests, and statistics of the
 * results. */
#ifndef SHEEN_TESTS_NATIVE_TILE_H
#define SHEEN_TESTS_NATIVE_TILE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/render/native/native.h"
#include "server/render/native/patches.h"
#include "server/render/native/sets.h"
#include "server/render/native/tile.h"
#include "server/surface/evaluate.h"
#include "tests/unit/renderer_frames.h"

enum { WIDTH = 320, HEIGHT = 240, PX = WIDTH * HEIGHT };

static const char *const MODELS[] = {"tests/models/body.obj",    "tests/models/fender.obj",
                                     "tests/models/creases.obj", "tests/models/pole.obj",
                                     "tests/models/ngons.obj",   "tests/models/nonmanifold.obj",
                                     "tests/models/tetra.obj",   "tests/models/chaikin.obj"};
enum { N_MODELS = sizeof MODELS / sizeof *MODELS };

/* --- planes, and the device that draws them */

struct planes {
    struct native_planes at;
    float *floats; /* all of them */
    uint32_t *face, *border, *node, *where;
};

static inline void planes_init(struct planes *planes)
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

static inline void planes_finish(struct planes *planes)
{
    free(planes->floats);
    free(planes->face);
    free(planes->border);
    free(planes->node);
    free(planes->where);
}

/* True if everything written for a pixel is equal. */
static inline bool is_same(const struct planes *a, const struct planes *b, size_t i)
{
    for (size_t k = 0; k < 9 && (a->at.depth[i] > 0 || k == 0); k++)
        if (memcmp(&a->floats[k * PX + i], &b->floats[k * PX + i], sizeof(float)) != 0)
            return false;
    return !(a->at.depth[i] > 0) || (a->face[i] == b->face[i] && a->border[i] == b->border[i]);
}

static inline struct native_device *open_device(const char *set, unsigned n_threads)
{
    const struct native_options options = {.n_threads = n_threads, .set = set};
    struct error error = {0};
    struct native_device *device = native_device_create(&options, &error);
    if (!device)
        fail_msg("%s", error.text);
    return device;
}

static inline struct native_model *open_model(const struct limit_tables *tables)
{
    struct error error = {0};
    struct native_model *model = native_model_create(tables, NATIVE_PATCH_BYTES, &error);
    if (!model)
        fail_msg("%s", error.text);
    return model;
}

static inline void draw_tile(struct native_device *device, struct native_model *model,
                             const struct camera *camera, const struct tile *tile,
                             struct planes *planes)
{
    struct error error = {0};
    struct view view;
    const struct limit_tables *tables = model->tables;
    view_init(&view, camera, WIDTH, HEIGHT, tables->hull_min, tables->hull_max);
    if (!native_draw(device, model, &view, tile, &planes->at, NULL, &error))
        fail_msg("%s", error.text);
}

static inline void draw(struct native_device *device, struct native_model *model,
                        const struct camera *camera, struct planes *planes)
{
    const struct tile whole = {0, 0, WIDTH, HEIGHT};
    draw_tile(device, model, camera, &whole, planes);
}

/* --- cameras */

enum look { PLAIN, ORTHOGRAPHIC, CLOSE, CLOSE_ORTHOGRAPHIC, INSIDE, HALF, FAR, TOP, N_LOOKS };
static const char *const LOOK_NAMES[N_LOOKS] = {
    "plain", "orthographic", "close", "close orthographic", "inside", "half", "far", "top"};

static inline void move_eye(struct camera *camera, double factor)
{
    for (int k = 0; k < 3; k++)
        camera->eye[k] = camera->target[k] + factor * (camera->eye[k] - camera->target[k]);
}

/* Looks at a place that most views show. */
static inline void look_at_surface(const struct limit_tables *tables, struct camera *camera)
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

static inline struct camera camera_for(const struct limit_tables *tables, enum look look)
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
    if (look == INSIDE) { /* a part of the surface lies behind the eye */
        move_eye(&camera, 0.02);
        camera.fov_deg = 90;
    }
    if (look == HALF) { /* draws nothing of the surface that lies behind the eye */
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

static inline int compare(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return x < y ? -1 : x > y;
}

/* Sorts the values and returns the quantile for a share; 0 if there are none. */
static inline double quantile(double *values, size_t n, double share)
{
    qsort(values, n, sizeof *values, compare);
    return n ? values[(size_t)((double)(n - 1) * share)] : 0;
}

static inline double angle(struct vec a, struct vec b)
{
    return atan2(vec_length(vec_cross(a, b)), vec_dot(a, b));
}

static inline struct vec normal_at(const struct planes *planes, size_t i)
{
    return (struct vec){(double)planes->at.normal[0][i], (double)planes->at.normal[1][i],
                        (double)planes->at.normal[2][i]};
}

/* The principal curvatures of a shape operator. */
static inline void principal(double a, double b, double c, double k[2])
{
    double mean = (a + c) / 2, apart = hypot((a - c) / 2, b);
    k[0] = mean - apart;
    k[1] = mean + apart;
}

/* The principal curvatures from derivatives in double precision; false if they define none. */
static inline bool principal_at(const struct limit_point *p, double k[2])
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

#endif
