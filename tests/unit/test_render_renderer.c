/* What holds for every device, tested with one that draws nothing: requests and images out of range
 * never reach a device, what it keeps of a frame is dropped exactly once, and a frame that fails is
 * empty. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/render/device.h"
#include "server/render/renderer.h"

enum { N_STEPS = 3, MAX_PX = 64 };

/* A device that counts its calls, and fails a frame's step `fails_at`. */
static struct {
    unsigned opened, begun, steps, models, images;
    int states; /* of unfinished frames */
    unsigned fails_at;
    bool fails_to_begin;
} counts;

struct counted_state {
    struct frame_state base;
    unsigned step;
};

static const struct renderer_device counting;

static struct renderer *create(const struct renderer_options *options, struct error *error)
{
    struct renderer *renderer = calloc(1, sizeof *renderer);
    (void)error;
    assert_non_null(renderer);
    renderer->device = &counting;
    renderer->options = *options;
    renderer->info = (struct renderer_info){.device = "counting",
                                            .driver = "none",
                                            .software = true,
                                            .max_width_px = MAX_PX,
                                            .max_height_px = MAX_PX};
    counts.opened++;
    return renderer;
}

static void destroy(struct renderer *renderer)
{
    counts.opened--;
    free(renderer);
}

static struct renderer_model *model_create(struct renderer *renderer,
                                           const struct limit_tables *tables, struct error *error)
{
    struct renderer_model *model = calloc(1, sizeof *model);
    (void)renderer;
    (void)error;
    assert_non_null(model);
    model->tables = tables;
    counts.models++;
    return model;
}

static void model_destroy(struct renderer *renderer, struct renderer_model *model)
{
    (void)renderer;
    counts.models--;
    free(model);
}

static struct renderer_image *image_create(struct renderer *renderer, const struct image *pixels,
                                           struct error *error)
{
    struct renderer_image *image = calloc(1, sizeof *image);
    (void)renderer;
    (void)error;
    assert_non_null(image);
    image->pixels = pixels;
    counts.images++;
    return image;
}

static void image_destroy(struct renderer *renderer, struct renderer_image *image)
{
    (void)renderer;
    counts.images--;
    free(image);
}

static size_t bytes_of_model(const struct limit_tables *tables)
{
    return tables->n_faces * 3;
}

static size_t bytes_of_image(const struct image *image)
{
    return (size_t)image->width_px * 5;
}

static uint64_t bytes_of_paused(uint32_t width_px, uint32_t height_px, uint64_t tile_px)
{
    return width_px + height_px + tile_px;
}

static void destroy_state(struct frame_state *state)
{
    counts.states--;
    free(state);
}

static bool begin(struct renderer *renderer, struct frame_work *work, struct error *error)
{
    struct counted_state *state = calloc(1, sizeof *state);
    (void)renderer;
    assert_non_null(state);
    counts.begun++;
    if (counts.fails_to_begin) {
        free(state);
        return error_set(error, ERROR_DEVICE, "no");
    }
    state->base.destroy = destroy_state;
    work->state = &state->base;
    counts.states++;
    return true;
}

static enum frame_step step(struct renderer *renderer, struct renderer_model *model,
                            struct frame_work *work, struct frame *frame, struct error *error)
{
    struct counted_state *state = (struct counted_state *)(void *)work->state;
    (void)renderer;
    assert_non_null(model);
    assert_non_null(frame->plane[0]);
    assert_false(work->has_drawn); /* the error of the previous step is gone */
    counts.steps++;
    if (++state->step == counts.fails_at) {
        error_set(error, ERROR_DEVICE, "no");
        return FRAME_FAILED;
    }
    work->has_drawn = state->step > 1;
    memset(frame->plane[0], (int)state->step, 4);
    return state->step < N_STEPS ? FRAME_MORE : FRAME_DONE;
}

static const struct renderer_device counting = {
    .create = create,
    .destroy = destroy,
    .model_create = model_create,
    .model_destroy = model_destroy,
    .image_create = image_create,
    .image_destroy = image_destroy,
    .model_bytes = bytes_of_model,
    .image_bytes = bytes_of_image,
    .paused_bytes = bytes_of_paused,
    .begin = begin,
    .step = step,
};

static const struct frame_request GOOD = {
    .width_px = 8,
    .height_px = 4,
    .camera = {.eye = {0, -4, 0}, .up = {0, 0, 1}, .fov_deg = 35},
    .n_lights = 1,
    .lights = {{.kind = LIGHT_TUNNEL,
                .u = {0, 0, 3},
                .v = {0, 3, 0},
                .pattern = {.count = 40, .duty = 0.5, .opacity = 1}}},
    .planes = PLANE_COLOUR | PLANE_NORMAL,
};

struct scene {
    struct renderer *renderer;
    struct renderer_model *model;
    struct limit_tables tables;
};

static void scene_init(struct scene *scene)
{
    struct error error = {0};
    const struct renderer_options options = {.device = "any"};
    memset(&counts, 0, sizeof counts);
    *scene = (struct scene){.tables.n_faces = 7};
    scene->renderer = renderer_create(&counting, &options, &error);
    scene->model = renderer_model_create(scene->renderer, &scene->tables, &error);
    assert_int_equal(counts.opened, 1);
    assert_int_equal(counts.models, 1);
}

static void scene_finish(struct scene *scene)
{
    renderer_model_destroy(scene->renderer, NULL);
    renderer_image_destroy(scene->renderer, NULL);
    renderer_model_destroy(scene->renderer, scene->model);
    renderer_destroy(scene->renderer);
    renderer_destroy(NULL);
    assert_int_equal(counts.opened, 0);
    assert_int_equal(counts.models, 0);
    assert_int_equal(counts.images, 0);
    assert_int_equal(counts.states, 0);
}

static void assert_empty(const struct frame *frame)
{
    static const struct frame empty;
    assert_memory_equal(frame, &empty, sizeof empty);
}

static void test_whole(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = &GOOD};
    scene_init(&scene);
    assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
    for (unsigned k = 1; k < N_STEPS; k++) {
        assert_int_equal(renderer_step(scene.renderer, scene.model, &work, &frame, &error),
                         FRAME_MORE);
        assert_int_equal(work.has_drawn, k > 1);
        assert_int_equal(counts.states, 1);
    }
    assert_int_equal(renderer_step(scene.renderer, scene.model, &work, &frame, &error), FRAME_DONE);
    assert_int_equal(counts.states, 0);
    assert_null(work.state);
    frame_work_finish(&work); /* a second call is safe */
    assert_int_equal(*(const uint8_t *)frame.plane[0], N_STEPS);
    assert_non_null(frame.plane[2]);
    assert_null(frame.plane[1]);
    frame_finish(&frame);
    assert_true(renderer_render(scene.renderer, scene.model, &GOOD, &frame, &error));
    assert_int_equal(counts.steps, 2 * N_STEPS);
    frame_finish(&frame);
    scene_finish(&scene);
}

/* A frame may be given up at any step, also after the renderer was destroyed. */
static void test_given_up(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = &GOOD}, never_begun = {.request = &GOOD};
    scene_init(&scene);
    frame_work_finish(&never_begun);
    assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
    assert_int_equal(renderer_step(scene.renderer, scene.model, &work, &frame, &error), FRAME_MORE);
    renderer_model_destroy(scene.renderer, scene.model);
    renderer_destroy(scene.renderer);
    frame_work_finish(&work);
    frame_finish(&frame);
    assert_int_equal(counts.states, 0);
}

static void test_failures(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    struct frame frame;
    struct frame_work work = {.request = &GOOD};
    scene_init(&scene);
    for (counts.fails_at = 1; counts.fails_at <= N_STEPS; counts.fails_at++) {
        enum frame_step next = FRAME_MORE;
        assert_true(renderer_begin(scene.renderer, &work, &frame, &error));
        while (next == FRAME_MORE)
            next = renderer_step(scene.renderer, scene.model, &work, &frame, &error);
        assert_int_equal(next, FRAME_FAILED);
        assert_int_equal(counts.states, 0);
        assert_empty(&frame);
        assert_false(renderer_render(scene.renderer, scene.model, &GOOD, &frame, &error));
        assert_int_equal(counts.states, 0);
        assert_empty(&frame);
    }
    counts.fails_to_begin = true;
    assert_false(renderer_begin(scene.renderer, &work, &frame, &error));
    assert_int_equal(error.kind, ERROR_DEVICE);
    assert_empty(&frame);
    scene_finish(&scene);
}

/* Values out of range never reach the device. */
static void test_checked(void **state)
{
    (void)state;
    struct scene scene;
    struct error error = {0};
    struct frame frame;
    struct frame_request request = GOOD;
    struct frame_work work = {.request = &request};
    scene_init(&scene);
    for (uint32_t size = MAX_PX; size <= MAX_PX + 1; size++) {
        request.width_px = size;
        assert_int_equal(renderer_begin(scene.renderer, &work, &frame, &error), size == MAX_PX);
        frame_work_finish(&work);
        frame_finish(&frame);
        struct image pixels = {.width_px = 1, .height_px = size};
        struct renderer_image *image = renderer_image_create(scene.renderer, &pixels, &error);
        assert_int_equal(image != NULL, size == MAX_PX);
        renderer_image_destroy(scene.renderer, image);
    }
    assert_int_equal(error.kind, ERROR_IMAGE);
    request = GOOD;
    request.camera.fov_deg = NAN;
    assert_false(renderer_begin(scene.renderer, &work, &frame, &error));
    assert_int_equal(error.kind, ERROR_REQUEST);
    assert_empty(&frame);
    assert_int_equal(counts.begun, 1);
    scene_finish(&scene);
}

static void test_memory(void **state)
{
    (void)state;
    const struct limit_tables tables = {.n_faces = 7};
    const struct image image = {.width_px = 11};
    assert_int_equal(renderer_model_bytes(&counting, &tables), 21);
    assert_int_equal(renderer_image_bytes(&counting, &image), 55);
    assert_int_equal(renderer_paused_bytes(&counting, 1, 20, 300), 321);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole),    cmocka_unit_test(test_given_up),
        cmocka_unit_test(test_failures), cmocka_unit_test(test_checked),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
