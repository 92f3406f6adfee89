/* A model on a software device and frames of it, for tests of polygons that both devices must
 * pass. */
#ifndef SHEEN_TESTS_POLYGON_SCENE_H
#define SHEEN_TESTS_POLYGON_SCENE_H

#include "server/render/gl/device.h"
#include "server/render/native/device.h"
#include "server/render/renderer.h"
#include "server/scene/defaults.h"
#include "tests/unit/cage_tables.h"

/* The device on which scenes are opened. */
static const struct renderer_device *scene_device = &gl_device;

struct scene {
    struct limit_tables tables;
    struct renderer *renderer;
    struct renderer_model *model;
};

/* `slice`: triangles that one step draws; 0: the device's default. */
static inline void open_scene(struct scene *scene, size_t slice)
{
    const struct renderer_options options = {.device = "software", .slice = slice};
    struct error error = {0};
    scene->renderer = renderer_create(scene_device, &options, &error);
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
    scene_default_camera(tables, NULL, VIEW_AROUND, request.width_px, request.height_px,
                         &request.camera);
    scene_default_light(tables->box_min, tables->box_max, NULL, &request.lights[0]);
    return request;
}

static inline void assert_same(const struct frame *a, const struct frame *b)
{
    for (int p = 0; p < PLANE_COUNT; p++)
        if (a->plane[p])
            assert_memory_equal(a->plane[p], b->plane[p],
                                (size_t)a->width_px * a->height_px *
                                    frame_plane_bytes((enum frame_plane)(1 << p)));
}

/* Runs the tests on each device in turn, and returns the number of failures. */
#define RETURN_FAILED_ON_BOTH_DEVICES(tests)                                                       \
    scene_device = &gl_device;                                                                     \
    int failed_on_gl = cmocka_run_group_tests_name("GL", tests, NULL, NULL);                       \
    scene_device = &native_renderer_device;                                                        \
    return failed_on_gl + cmocka_run_group_tests_name("native", tests, NULL, NULL)

#endif
