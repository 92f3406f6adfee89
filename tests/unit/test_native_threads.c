/* Whole frames of the native device, colour and every plane, have the same bytes for any number of
 * threads, though threads list pixels at edges and in roundings in any order. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "tests/unit/renderer_frames.h"

static const unsigned COUNTS[] = {1, 2, 5};
enum { N_COUNTS = sizeof COUNTS / sizeof *COUNTS, PLANES = (1 << PLANE_COUNT) - 1 };

static struct frame render_by(unsigned n_threads, const struct limit_tables *tables,
                              const struct frame_request *request)
{
    const struct renderer_options options = {.device = "native", .n_threads = n_threads};
    struct error error = {0};
    struct renderer *renderer = renderer_create(&native_renderer_device, &options, &error);
    assert_non_null(renderer);
    assert_int_equal(renderer_info(renderer)->n_threads, n_threads);
    struct renderer_model *model = upload(renderer, tables);
    struct frame frame = render(renderer, model, request);
    renderer_model_destroy(renderer, model);
    renderer_destroy(renderer);
    return frame;
}

/* Pixels that surface covers in part. */
static size_t partly_covered(const struct frame *frame)
{
    const float *coverage = frame->plane[7];
    size_t n = 0;
    for (size_t i = 0; i < (size_t)frame->width_px * frame->height_px; i++)
        n += coverage[i] > 0 && coverage[i] < 1;
    return n;
}

static void check(const char *path, double zoom)
{
    struct limit_tables tables = {0};
    struct frame frames[N_COUNTS];
    build_file(path, &tables);
    struct frame_request request = request_for(&tables, 400, 300);
    request.planes = PLANES;
    request.camera.fov_deg /= zoom;
    for (int i = 0; i < N_COUNTS; i++)
        frames[i] = render_by(COUNTS[i], &tables, &request);
    assert_true(partly_covered(&frames[0]) > 100);
    for (int i = 1; i < N_COUNTS; i++)
        assert_same_frames(&frames[0], &frames[i]);
    for (int i = 0; i < N_COUNTS; i++)
        frame_finish(&frames[i]);
    limit_tables_finish(&tables);
}

static void test_creases(void **state)
{
    (void)state;
    check("tests/models/creases.obj", 1);
}

/* Roundings that are some pixels wide. */
static void test_close_up(void **state)
{
    (void)state;
    check("tests/models/fender.obj", 4);
}

static void test_many_small_faces(void **state)
{
    (void)state;
    check("tests/models/body.obj", 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_creases),
                                       cmocka_unit_test(test_close_up),
                                       cmocka_unit_test(test_many_small_faces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
