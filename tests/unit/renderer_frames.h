/* Draws frames of tables by a renderer, for tests of the renderer. */
#ifndef SHEEN_TESTS_RENDERER_FRAMES_H
#define SHEEN_TESTS_RENDERER_FRAMES_H

#include <string.h>

#include "server/render/gl/device.h"
#include "server/render/native/device.h"
#include "server/render/renderer.h"
#include "server/scene/defaults.h"
#include "tests/unit/cage_tables.h"

/* The device on which renderers are opened. */
static const struct renderer_device *frames_device = &gl_device;

static inline struct renderer *open_renderer(size_t max_texels)
{
    struct error error = {0};
    struct renderer_options options = {.device = "auto", .max_texels = max_texels};
    struct renderer *renderer = renderer_create(frames_device, &options, &error);
    if (!renderer)
        fail_msg("%s", error.text);
    return renderer;
}

/* A model's tables, and a renderer that draws them. */
struct scene {
    struct limit_tables tables;
    struct renderer *renderer;
    struct renderer_model *model;
};

static inline void scene_finish(struct scene *scene)
{
    renderer_model_destroy(scene->renderer, scene->model);
    renderer_destroy(scene->renderer);
    limit_tables_finish(&scene->tables);
}

static inline struct frame_request request_for(const struct limit_tables *tables, uint32_t width,
                                               uint32_t height)
{
    struct frame_request request = {
        .width_px = width,
        .height_px = height,
        .n_lights = 1,
        .lights = {{.pattern = {.kind = PATTERN_STRIPES,
                                .count = 40,
                                .duty = 0.5,
                                .opacity = 1,
                                .foreground = {1, 1, 1, 1},
                                .background = {0, 0, 0, 1}}}},
        .planes = PLANE_COLOUR | PLANE_POSITION | PLANE_NORMAL | PLANE_PTEX | PLANE_LIGHT,
    };
    scene_default_camera(tables, NULL, VIEW_AROUND, width, height, &request.camera);
    scene_default_light(tables->box_min, tables->box_max, NULL, &request.lights[0]);
    return request;
}

static inline struct frame render(struct renderer *renderer, struct renderer_model *model,
                                  const struct frame_request *request)
{
    struct error error = {0};
    struct frame frame;
    if (!renderer_render(renderer, model, request, &frame, &error))
        fail_msg("%s", error.text);
    return frame;
}

static inline struct renderer_model *upload(struct renderer *renderer,
                                            const struct limit_tables *tables)
{
    struct error error = {0};
    struct renderer_model *model = renderer_model_create(renderer, tables, &error);
    if (!model)
        fail_msg("%s", error.text);
    return model;
}

static inline void assert_same_frames(const struct frame *a, const struct frame *b)
{
    size_t pixels = (size_t)a->width_px * a->height_px;
    for (int p = 0; p < PLANE_COUNT; p++) {
        assert_int_equal(a->plane[p] != NULL, b->plane[p] != NULL);
        size_t bytes = pixels * frame_plane_bytes((enum frame_plane)(1 << p));
        if (a->plane[p] && memcmp(a->plane[p], b->plane[p], bytes) != 0)
            fail_msg("plane %d differs", p);
    }
}

static inline size_t hits(const struct frame *frame)
{
    const uint32_t(*ptex)[3] = frame->plane[3];
    size_t n = 0;
    for (size_t k = 0; k < (size_t)frame->width_px * frame->height_px; k++)
        n += ptex[k][0] != UINT32_MAX;
    return n;
}

#endif
