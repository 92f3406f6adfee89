/* The native device's planes are the same for any number of threads and any cut into tiles. Between
 * instruction sets they differ by rounding only. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/render/native/clip/clip.h"
#include "tests/unit/native_tile.h"

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

/* A part of the picture has the same pixels as the whole picture. */
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
                /* A tile's planes begin with the tile's first pixel. */
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

/* Two instruction sets agree as closely as two devices do. */
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

static double random_of(double low, double high)
{
    return low + (high - low) * rand() / RAND_MAX;
}

/* What is passed over could not have left anything: triangles with corners near the excluded points leave no part.
 * And most of what lies far aside is excluded. */
static void test_excludes(void **state)
{
    (void)state;
    unsigned n_excluded = 0, n_left = 0;
    srand(20261201);
    for (int n = 0; n < 20000; n++) {
        const struct view view = {.perspective = n & 1,
                                  .units_per_px = exp(random_of(-20, 2)),
                                  .centre_px = {random_of(-50, 700), random_of(-50, 500)},
                                  .near = exp(random_of(-8, 2)),
                                  .far = 1e4,
                                  .width_px = 640,
                                  .height_px = 480};
        const double side = view.units_per_px * 1000 * exp(random_of(-3, 3)), off = side / 4;
        const double middle[3] = {random_of(-4, 4) * side, random_of(-4, 4) * side,
                                  random_of(-1, 20)};
        struct native_clip clip;
        struct native_corner point[4] = {{{0}, 0, 0}}, left[CLIP_MOST_CORNERS];
        native_clip_init(&clip, &view);
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                point[i].at[k] = middle[k] + random_of(-side, side);
        bool is_excluded = native_clip_excludes(&clip, point, 4, off);
        n_excluded += is_excluded;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                point[i].at[k] += random_of(-off, off) / sqrt(3);
        int n_corners = native_clip_triangle(&clip, point, left);
        n_left += n_corners > 0;
        assert_false(is_excluded && n_corners > 0);
    }
    assert_in_range(n_excluded, 2000, 18000);
    assert_in_range(n_left, 1000, 18000);
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_threads), cmocka_unit_test(test_tiles),
                                       cmocka_unit_test(test_sets), cmocka_unit_test(test_excludes),
                                       cmocka_unit_test(test_refuses)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
