/* A model on the GL device and on the native one, and the differences of their frames. */
#ifndef SHEEN_TESTS_NATIVE_SCENE_H
#define SHEEN_TESTS_NATIVE_SCENE_H

#include "server/render/native/device.h"
#include "tests/unit/renderer_frames.h"

/* Indices of renderer[] and model[]. */
enum { ON_GL, ON_NATIVE, DEVICES };

struct devices {
    struct limit_tables tables;
    struct renderer *renderer[DEVICES];
    struct renderer_model *model[DEVICES];
};

static inline void open_devices(struct devices *devices, const char *path)
{
    const struct renderer_device *const kinds[DEVICES] = {&gl_device, &native_renderer_device};
    const struct renderer_options options = {.device = "software"};
    struct error error = {0};
    build_file(path, &devices->tables);
    for (int i = 0; i < DEVICES; i++) {
        devices->renderer[i] = renderer_create(kinds[i], &options, &error);
        assert_non_null(devices->renderer[i]);
        devices->model[i] = renderer_model_create(devices->renderer[i], &devices->tables, &error);
        assert_non_null(devices->model[i]);
    }
}

static inline void close_devices(struct devices *devices)
{
    for (int i = 0; i < DEVICES; i++) {
        renderer_model_destroy(devices->renderer[i], devices->model[i]);
        renderer_destroy(devices->renderer[i]);
    }
    limit_tables_finish(&devices->tables);
}

/* The differences of two frames: pixels whose colours differ by more than one step and by more than
 * three, pixels that only one frame hits, and pixels that show different faces. */
struct difference {
    int over_one, over_three, hits, faces, lights, pixels;
};

static inline int colour_step(const struct frame *a, const struct frame *b, int pixel)
{
    const uint8_t *p = (const uint8_t *)a->plane[0] + 4 * pixel;
    const uint8_t *q = (const uint8_t *)b->plane[0] + 4 * pixel;
    int most = 0;
    for (int k = 0; k < 4; k++)
        most = abs(p[k] - q[k]) > most ? abs(p[k] - q[k]) : most;
    return most;
}

static inline struct difference compare(const struct frame *a, const struct frame *b)
{
    struct difference found = {.pixels = (int)(a->width_px * a->height_px)};
    const uint32_t *face_a = a->plane[3], *face_b = b->plane[3];
    const float *light_a = a->plane[4], *light_b = b->plane[4];
    for (int i = 0; i < found.pixels; i++) {
        int step = colour_step(a, b, i);
        found.over_one += step > 1;
        found.over_three += step > 3;
        bool hit_a = face_a[3 * i] != UINT32_MAX, hit_b = face_b[3 * i] != UINT32_MAX;
        found.hits += hit_a != hit_b;
        found.faces += hit_a && hit_b && face_a[3 * i] != face_b[3 * i];
        found.lights += isnan(light_a[2 * i]) != isnan(light_b[2 * i]);
    }
    return found;
}

/* Silhouettes and borders of Ptex faces may fall on either side of a pixel's centre, and the rays
 * of a pixel at an edge may meet the surface on one device and miss it on the other. */
static inline void assert_alike(const struct difference *found, const char *what)
{
    int n = found->pixels;
    if (found->hits > n / 2000 || found->faces > n / 500 || found->lights > n / 500 ||
        found->over_one > n / 500 || found->over_three > n / 1000)
        fail_msg(
            "%s: hits %d, faces %d, lights %d, colours by more than one step %d, than three %d",
            what, found->hits, found->faces, found->lights, found->over_one, found->over_three);
}

#endif
