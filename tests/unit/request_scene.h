/* A model on the GL device, and a request that shows all of it under the default light. */
#ifndef SHEEN_TESTS_UNIT_REQUEST_SCENE_H
#define SHEEN_TESTS_UNIT_REQUEST_SCENE_H

#include <string.h>

#include "server/render/gl/device.h"
#include "server/render/renderer.h"
#include "server/scene/defaults.h"
#include "tests/unit/cage_tables.h"

struct scene {
    struct limit_tables tables;
    struct renderer *renderer;
    struct renderer_model *model;
    struct frame_request request;
};

/* `text` is an OBJ. With device_times the device's timer queries measure the stages. */
static inline void scene_open(struct scene *scene, const char *text, uint32_t width_px,
                              uint32_t height_px, bool device_times)
{
    struct error error = {0};
    const struct renderer_options options = {.device = "auto", .device_times = device_times};
    *scene = (struct scene){.request = {.width_px = width_px,
                                        .height_px = height_px,
                                        .n_lights = 1,
                                        .lights = {{.pattern = {.kind = PATTERN_STRIPES,
                                                                .count = 40,
                                                                .duty = 0.5,
                                                                .opacity = 1,
                                                                .foreground = {1, 1, 1, 1}}}},
                                        .planes = PLANE_COLOUR}};
    build(text, strlen(text), &scene->tables);
    scene->renderer = renderer_create(&gl_device, &options, &error);
    if (!scene->renderer)
        fail_msg("%s", error.text);
    scene->model = renderer_model_create(scene->renderer, &scene->tables, &error);
    assert_non_null(scene->model);
    const struct limit_tables *tables = &scene->tables;
    scene_default_camera(tables, NULL, VIEW_AROUND, width_px, height_px, &scene->request.camera);
    scene_default_light(tables->box_min, tables->box_max, NULL, &scene->request.lights[0]);
}

static inline void scene_finish(struct scene *scene)
{
    renderer_model_destroy(scene->renderer, scene->model);
    renderer_destroy(scene->renderer);
    limit_tables_finish(&scene->tables);
}

#endif
