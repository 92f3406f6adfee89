/* A model on a software device, and frames of it, for the tests of polygons. */
#ifndef SHEEN_TESTS_POLYGON_SCENE_H
#define SHEEN_TESTS_POLYGON_SCENE_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/cage/read/read.h"
#include "server/gpu/renderer.h"

struct scene {
    struct limit_tables tables;
    struct renderer *renderer;
    struct renderer_model *model;
};

static inline void build(const char *bytes, size_t size, struct limit_tables *tables)
{
    struct cage cage;
    struct error error = {0};
    if (!cage_read(&cage, bytes, size, "scene.obj", &error))
        fail_msg("%s", error.text);
    struct limit_plan *plan = limit_plan_create(&cage, NULL, &error);
    assert_non_null(plan);
    assert_true(limit_tables_init(tables, plan, &error));
    assert_true(limit_build_faces(tables, plan, 0, tables->n_faces, NULL, &error));
    limit_plan_destroy(plan);
    cage_finish(&cage);
}

static inline void build_file(const char *path, struct limit_tables *tables)
{
    static char bytes[1 << 20];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    build(bytes, size, tables);
}

/* A torus of n x n quads: smooth, and regular all over. */
static inline void build_torus(unsigned n, struct limit_tables *tables)
{
    size_t room = (size_t)n * n * 100, used = 0;
    char *text = malloc(room);
    assert_non_null(text);
    for (unsigned k = 0; k < n * n; k++) {
        double a = 6.283185307179586 * (k / n) / n, b = 6.283185307179586 * (k % n) / n;
        double r = 2 + cos(b);
        used += (size_t)snprintf(text + used, room - used, "v %.12f %.12f %.12f\n", r * cos(a),
                                 r * sin(a), sin(b));
    }
    for (unsigned k = 0; k < n * n; k++) {
        unsigned i = k / n, j = k % n, i2 = (i + 1) % n, j2 = (j + 1) % n;
        used += (size_t)snprintf(text + used, room - used, "f %u %u %u %u\n", i * n + j + 1,
                                 i2 * n + j + 1, i2 * n + j2 + 1, i * n + j2 + 1);
    }
    build(text, used, tables);
    free(text);
}

/* `slice`: triangles a step; 0: the device's own. */
static inline void open_scene(struct scene *scene, size_t slice)
{
    const struct renderer_options options = {.device = "software", .slice = slice};
    struct error error = {0};
    scene->renderer = renderer_create(&options, &error);
    if (!scene->renderer)
        fail_msg("%s", error.text);
    scene->model = renderer_model_create(scene->renderer, &scene->tables, &error);
    assert_non_null(scene->model);
}

static inline void close_scene(struct scene *scene)
{
    renderer_model_destroy(scene->renderer, scene->model);
    renderer_destroy(scene->renderer);
    limit_tables_finish(&scene->tables);
}

static inline struct frame_request request_for(const struct scene *scene)
{
    struct frame_request request = {
        .width_px = 240,
        .height_px = 160,
        .n_lights = 1,
        .lights = {{.pattern = {.count = 20,
                                .duty = 0.5,
                                .opacity = 1,
                                .foreground = {1, 1, 1, 1},
                                .background = {0, 0, 0, 1}}}},
        .miss = {0, 0, 1, 1},
        .empty = {1, 0, 0, 1},
        .planes = PLANE_COLOUR | PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX | PLANE_CURVATURE,
    };
    const struct limit_tables *tables = &scene->tables;
    renderer_default_camera(tables->box_min, tables->box_max, request.width_px, request.height_px,
                            &request.camera);
    renderer_default_light(tables->box_min, tables->box_max, &request.camera, &request.lights[0]);
    return request;
}

static inline void assert_same(const struct frame *a, const struct frame *b)
{
    for (int p = 0; p < PLANE_COUNT; p++)
        if (a->plane[p])
            assert_memory_equal(a->plane[p], b->plane[p],
                                (size_t)a->width_px * a->height_px *
                                    renderer_plane_bytes((enum renderer_plane)(1 << p)));
}

#endif
