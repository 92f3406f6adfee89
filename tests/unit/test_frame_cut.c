/* How frames are cut: no interactive tile costs more than its device's limit, whatever is
 * requested. The cut depends on the machine only where it does not change the frame. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/frame/cut.h"
#include "server/render/tiles.h"

static const struct cut_device NATIVE = {.software = true, .n_threads = 2};
static const struct cut_device MESA = {.software = true};
static const struct cut_device GPU = {.software = false};

static sheen_Render frame_of(uint32_t width_px, uint32_t height_px, pb_size_t lights,
                             sheen_PatternKind pattern, sheen_RequestClass request_class)
{
    sheen_Render render = {.width_px = width_px,
                           .height_px = height_px,
                           .lights_count = lights,
                           .request_class = request_class};
    for (pb_size_t i = 0; i < lights; i++)
        render.lights[i].pattern.kind = pattern;
    return render;
}

static uint64_t most_tile_px(const sheen_Render *render, struct cut cut)
{
    struct tile_size size =
        tiles_cut(render->width_px, render->height_px, cut.tile_px, cut.in_place);
    return (uint64_t)size.width * size.height;
}

/* The limits in nanoseconds: 15 ms by the weights of cut.c, which are written a second time
 * here. */
static double tile_ms(const sheen_Render *render, struct cut cut, double scale)
{
    static const double light_ns[] = {15, 22.5, 22.5, 22.5, 22.5, 37.5, 22.5};
    double ns = 60;
    for (pb_size_t i = 0; i < render->lights_count; i++)
        ns += light_ns[render->lights[i].pattern.kind];
    return ns * scale * (double)most_tile_px(render, cut) / 1e6;
}

static void test_no_interactive_tile_takes_long(void **state)
{
    (void)state;
    const sheen_RequestClass interactive = sheen_RequestClass_CLASS_INTERACTIVE;
    for (uint32_t side = 16; side <= 1400; side += 97)
        for (pb_size_t lights = 1; lights <= 8; lights++)
            for (int pattern = 0; pattern <= 6; pattern++) {
                sheen_Render render = frame_of(side, side * 2 / 3 + 1, lights,
                                               (sheen_PatternKind)pattern, interactive);
                struct cut native = cut_frame(&render, &NATIVE), mesa = cut_frame(&render, &MESA);
                assert_true(native.in_place && mesa.in_place);
                assert_true(tile_ms(&render, native, 1) < 8);
                assert_true(tile_ms(&render, mesa, 2.4) < 15 || mesa.tile_px < 128 * 128);
                assert_int_equal(cut_frame(&render, &GPU).tile_px, 0);
            }
    sheen_Render eight = frame_of(1600, 1200, 8, sheen_PatternKind_PATTERN_STRIPES, interactive);
    sheen_Render one = frame_of(1600, 1200, 1, sheen_PatternKind_PATTERN_STRIPES, interactive);
    assert_true(cut_frame(&eight, &NATIVE).tile_px * 2 < cut_frame(&one, &NATIVE).tile_px);
    sheen_Render small = frame_of(320, 240, 1, sheen_PatternKind_PATTERN_STRIPES, interactive);
    assert_int_equal(cut_frame(&small, &NATIVE).tile_px, 0);
    /* Without lights the frame shows a tunnel of stripes; false colour is drawn without any
     * light. */
    sheen_Render none = frame_of(1600, 1200, 0, sheen_PatternKind_PATTERN_STRIPES, interactive);
    assert_int_equal(cut_frame(&none, &NATIVE).tile_px, cut_frame(&one, &NATIVE).tile_px);
    eight.show.kind = sheen_ShowKind_SHOW_MEAN;
    assert_true(cut_frame(&eight, &NATIVE).tile_px > cut_frame(&one, &NATIVE).tile_px);
}

static void test_threads_cut_only_what_stays_the_same(void **state)
{
    (void)state;
    const struct cut_device many = {.software = true, .n_threads = 16};
    const sheen_RequestClass classes[] = {sheen_RequestClass_CLASS_STILL,
                                          sheen_RequestClass_CLASS_BATCH,
                                          sheen_RequestClass_CLASS_INTERACTIVE};
    for (uint32_t side = 100; side <= 8000; side += 100)
        for (size_t c = 0; c < sizeof classes / sizeof *classes; c++) {
            sheen_Render render =
                frame_of(side, side, 3, sheen_PatternKind_PATTERN_LATTICE, classes[c]);
            struct cut two = cut_frame(&render, &NATIVE), all = cut_frame(&render, &many);
            assert_int_equal(two.in_place, all.in_place);
            if (two.tile_px == all.tile_px)
                continue;
            assert_true(two.in_place && classes[c] == sheen_RequestClass_CLASS_INTERACTIVE);
            assert_true(all.tile_px == 0 || all.tile_px / 8 == two.tile_px);
        }
}

/* Polygons are drawn in slices of the mesh. */
static void test_polygons(void **state)
{
    (void)state;
    sheen_Render render = frame_of(1600, 1200, 8, sheen_PatternKind_PATTERN_STRIPES,
                                   sheen_RequestClass_CLASS_INTERACTIVE);
    render.surface = sheen_SurfaceKind_SURFACE_POLYGON;
    assert_int_equal(cut_frame(&render, &NATIVE).tile_px, 0);
    render.request_class = sheen_RequestClass_CLASS_STILL;
    assert_in_range(cut_frame(&render, &NATIVE).tile_px, 1, 65536);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_interactive_tile_takes_long),
        cmocka_unit_test(test_threads_cut_only_what_stays_the_same),
        cmocka_unit_test(test_polygons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
