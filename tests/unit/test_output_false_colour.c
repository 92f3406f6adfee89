/* False colour: the colours of known planes, the rule for the range, and the legend. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <math.h>

#include "server/output/legend.h"
#include "server/output/false_colour.h"

enum { MAX_PIXELS = 320 * 240 };

static struct false_colour_extremes extremes; /* of the last painted picture */

static const float MISS[4] = {0, 0.2f, 0.4f, 1}, EMPTY[4] = {1, 0, 1, 0};

struct ptex {
    uint32_t face;
    float u, v;
};

/* A frame in static memory, of one row unless stated otherwise. */
static struct planes {
    uint8_t colour[MAX_PIXELS][4];
    float position[MAX_PIXELS][3], normal[MAX_PIXELS][3], curvature[MAX_PIXELS][2];
    float coverage[MAX_PIXELS];
    struct ptex ptex[MAX_PIXELS];
} planes;

static struct frame frame_of(sheen_ShowKind kind, uint32_t width_px, uint32_t height_px)
{
    memset(&planes, 0, sizeof planes);
    struct frame frame = {.width_px = width_px, .height_px = height_px};
    frame.plane[0] = planes.colour;
    if (kind == sheen_ShowKind_SHOW_PTEX) {
        frame.plane[3] = planes.ptex;
        return frame;
    }
    frame.plane[1] = planes.position;
    if (kind == sheen_ShowKind_SHOW_NORMAL || kind == sheen_ShowKind_SHOW_DRAFT)
        frame.plane[2] = planes.normal;
    else
        frame.plane[5] = planes.curvature;
    return frame;
}

static void assert_colour(size_t i, int r, int g, int b, int a)
{
    const int want[4] = {r, g, b, a};
    for (int k = 0; k < 4; k++)
        if (planes.colour[i][k] != want[k])
            fail_msg("pixel %zu, channel %d: %d, not %d", i, k, planes.colour[i][k], want[k]);
}

#define BLUE 59, 76, 192, 255
#define GREY 221, 221, 221, 255
#define RED 180, 4, 38, 255
#define MISSED 0, 51, 102, 255
#define EMPTIED 255, 0, 255, 0

static void paint_curvatures(sheen_ShowKind kind, double range, const float (*k)[2], size_t n)
{
    struct frame frame = frame_of(kind, (uint32_t)n, 1);
    memcpy(planes.curvature, k, n * sizeof *k);
    sheen_Show show = {.kind = kind, .has_range = true, .range = range};
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    assert_true(show.range == range);
}

static void test_curvatures(void **state)
{
    (void)state;
    const float k[][2] = {{-2, 0}, {-3, 2}, {-2, 3}, {0, 0}, {-1, 1}, {NAN, NAN}, {0, INFINITY}};
    paint_curvatures(sheen_ShowKind_SHOW_CURVATURE, 2, k, 7);
    assert_colour(0, BLUE);
    assert_colour(1, BLUE); /* beyond the end of the range */
    assert_colour(2, RED);
    assert_colour(3, GREY);
    assert_colour(5, MISSED);
    assert_colour(6, MISSED);
    paint_curvatures(sheen_ShowKind_SHOW_MEAN, 1, k, 7);
    assert_colour(0, BLUE);
    assert_colour(1, 141, 176, 254, 255); /* half of the range */
    assert_colour(2, 244, 154, 123, 255);
    assert_colour(4, GREY);
    paint_curvatures(sheen_ShowKind_SHOW_GAUSSIAN, 6, k, 7);
    assert_colour(0, GREY);
    assert_colour(1, BLUE);
    assert_colour(2, BLUE);
    const float dome[][2] = {{-3, -2}, {2, 3}};
    paint_curvatures(sheen_ShowKind_SHOW_GAUSSIAN, 6, dome, 2);
    assert_colour(0, RED);
    assert_colour(1, RED);
}

static void test_no_surface(void **state)
{
    (void)state;
    static const sheen_ShowKind kinds[] = {sheen_ShowKind_SHOW_CURVATURE,
                                           sheen_ShowKind_SHOW_NORMAL, sheen_ShowKind_SHOW_DRAFT};
    for (int i = 0; i < 3; i++) {
        struct frame frame = frame_of(kinds[i], 2, 1);
        for (int k = 0; k < 3; k++) {
            planes.position[0][k] = NAN;
            planes.normal[0][k] = planes.normal[1][k] = NAN;
        }
        for (int k = 0; k < 2; k++)
            planes.curvature[0][k] = planes.curvature[1][k] = NAN;
        sheen_Show show = {.kind = kinds[i], .has_direction = true, .direction = {0, 0, 1}};
        false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
        assert_colour(0, EMPTIED);
        assert_colour(1, MISSED);
    }
}

/* Two rows of four pixels with an outline between them: a pixel whose centre shows nothing has the
 * colour of a neighbour. */
static void test_outline(void **state)
{
    (void)state;
    const float coverage[8] = {1, 0.75f, 0.5f, 0, 0.25f, 0, 0.5f, 0.5f};
    const float colour_of_x[2] = {1, -1};
    struct frame frame = frame_of(sheen_ShowKind_SHOW_NORMAL, 4, 2);
    frame.plane[7] = planes.coverage;
    memcpy(planes.coverage, coverage, sizeof coverage);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            planes.position[i][k] = planes.normal[i][k] = i < 2 ? 0 : NAN;
    for (int i = 0; i < 2; i++)
        planes.normal[i][0] = colour_of_x[i];
    sheen_Show show = {.kind = sheen_ShowKind_SHOW_NORMAL};
    const float black[4] = {0, 0, 0, 1};
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    assert_colour(0, 255, 128, 128, 255);
    assert_colour(1, 0, 112, 112, 255); /* 3/4 of the light */
    assert_colour(2, 0, 92, 92, 255);   /* the left neighbour's colour */
    assert_colour(3, 0, 0, 0, 255);
    assert_colour(4, 137, 65, 65, 255); /* the upper neighbour's colour */
    assert_colour(5, 0, 0, 0, 255);
    assert_colour(6, 0, 92, 92, 255); /* the diagonal neighbour's colour */
    assert_colour(7, 0, 0, 0, 255);   /* no neighbour has a colour */
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    assert_colour(1, 0, 128, 128, 191); /* EMPTY is transparent, so the colour is too */
    planes.normal[1][0] = NAN;
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    assert_colour(1, 0, 44, 89, 255); /* 3/4 of MISS, because the pixel has no normal */
}

static void test_normals(void **state)
{
    (void)state;
    struct frame frame = frame_of(sheen_ShowKind_SHOW_NORMAL, 2, 1);
    planes.normal[0][2] = 1;
    planes.normal[1][0] = -1;
    sheen_Show show = {.kind = sheen_ShowKind_SHOW_NORMAL};
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    assert_colour(0, 128, 128, 255, 255);
    assert_colour(1, 0, 128, 128, 255);
    assert_false(show.has_range);
}

/* Sets normals at these angles above the plane perpendicular to the pull direction, and paints. */
static void paint_drafts(sheen_Show *show, const double *deg, size_t n)
{
    struct frame frame = frame_of(sheen_ShowKind_SHOW_DRAFT, (uint32_t)n, 1);
    for (size_t i = 0; i < n; i++) {
        planes.normal[i][0] = (float)cos(deg[i] * M_PI / 180);
        planes.normal[i][1] = -(float)sin(deg[i] * M_PI / 180);
    }
    false_colour_paint(&frame, show, 1, MISS, EMPTY, &extremes);
}

#define YELLOW 255, 224, 64, 255
#define AMBER 237, 173, 26, 255

static void test_drafts(void **state)
{
    (void)state;
    const double deg[] = {90, 3.001, 2.999, 0.01, -0.01, -2.999, -3.001, -90};
    sheen_Show show = {
        .kind = sheen_ShowKind_SHOW_DRAFT, .has_direction = true, .direction = {0, -1e30, 0}};
    paint_drafts(&show, deg, 8);
    assert_true(show.has_range && show.range == 3);
    assert_colour(0, 0, 84, 38, 255);
    assert_colour(1, 127, 209, 115, 255);
    assert_colour(2, YELLOW);
    assert_colour(3, YELLOW);
    assert_colour(4, AMBER);
    assert_colour(5, AMBER);
    assert_colour(6, 240, 115, 97, 255);
    assert_colour(7, 128, 0, 13, 255);
    show.range = 90; /* all but the ends lie between the two colours */
    paint_drafts(&show, deg, 8);
    assert_colour(1, YELLOW);
    assert_colour(6, AMBER);
}

static int sum(const uint8_t c[4])
{
    return c[0] + c[1] + c[2];
}

static int spread(const uint8_t c[4])
{
    int low = c[0] < c[1] ? c[0] : c[1], high = c[0] > c[1] ? c[0] : c[1];
    return (high > c[2] ? high : c[2]) - (low < c[2] ? low : c[2]);
}

static void test_ptex(void **state)
{
    (void)state;
    enum { N = 64 };
    struct frame frame = frame_of(sheen_ShowKind_SHOW_PTEX, N + 5, 1);
    for (uint32_t i = 0; i < N; i++)
        planes.ptex[i] = (struct ptex){i, 0.75f, 0.75f};
    for (uint32_t i = 0; i < 4; i++) /* the corners of one face */
        planes.ptex[N + i] = (struct ptex){5, i & 1 ? 1 : 0, i & 2 ? 1 : 0};
    planes.ptex[N + 4] = (struct ptex){UINT32_MAX, 0, 0};
    sheen_Show show = {.kind = sheen_ShowKind_SHOW_PTEX};
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    /* neighbouring numbers have very different colours, and all colours differ */
    for (int i = 0; i < N; i++)
        for (int j = 0; j < i; j++) {
            int apart = 0;
            for (int k = 0; k < 3; k++)
                apart += abs(planes.colour[i][k] - planes.colour[j][k]);
            assert_true(apart > (i - j < 3 ? 100 : 0));
        }
    uint8_t(*corner)[4] = planes.colour + N;
    assert_true(sum(corner[1]) > sum(corner[0]) && sum(corner[3]) > sum(corner[2]));
    assert_true(spread(corner[2]) > spread(corner[0]) && spread(corner[3]) > spread(corner[1]));
    assert_colour(N + 4, EMPTIED);
}

static double range_of(sheen_ShowKind kind, double size, double scale, size_t n)
{
    struct frame frame = frame_of(kind, (uint32_t)(2 * n), 1);
    /* in random order, of both signs, every other pixel without a value */
    for (size_t i = 0; i < n; i++) {
        double k = scale * (double)((i * 7919) % n + 1);
        planes.curvature[2 * i][0] = planes.curvature[2 * i][1] = (float)(i % 2 ? k : -k);
        planes.curvature[2 * i + 1][0] = NAN;
    }
    sheen_Show show = {.kind = kind};
    false_colour_paint(&frame, &show, size, MISS, EMPTY, &extremes);
    assert_true(show.has_range);
    return show.range;
}

static void test_ranges(void **state)
{
    (void)state;
    const sheen_ShowKind mean = sheen_ShowKind_SHOW_MEAN;
    assert_true(range_of(mean, 1, 1, 1000) == 980); /* the 98th percentile itself */
    assert_true(range_of(mean, 1, 1, 1001) == 990); /* 981, rounded up */
    assert_true(range_of(mean, 1, 0.001, 1001) == 0.99);
    assert_true(range_of(mean, 1, 1, 1) == 1);
    assert_true(range_of(mean, 1e30, 1e-30, 100) == 9.8e-29);
    assert_true(range_of(mean, 1e-20, 1e20, 100) == 9.8e21);
    assert_true(range_of(sheen_ShowKind_SHOW_GAUSSIAN, 1, 1, 100) == 9700); /* 9604, rounded up */
    /* The range of a flat surface, with rounding errors and without. */
    assert_true(range_of(mean, 4, 1e-9, 100) == 2.5e-6);
    assert_true(range_of(sheen_ShowKind_SHOW_GAUSSIAN, 4, 1e-9, 100) == 6.3e-12);
    assert_true(range_of(mean, 4, 0, 100) == 2.5e-6);
}

static void assert_extreme(const sheen_Extreme *extreme, double value, size_t i)
{
    const uint32_t width = 16;
    assert_true(extreme->value == value);
    assert_true(extreme->has_x_px && extreme->has_y_px && extreme->has_position);
    assert_int_equal(extreme->y_px * width + extreme->x_px, i);
    assert_true(extreme->position.x == (double)planes.position[i][0] &&
                extreme->position.y == (double)planes.position[i][1] &&
                extreme->position.z == (double)planes.position[i][2]);
    assert_true(extreme->has_face && extreme->has_u && extreme->has_v);
    assert_int_equal(extreme->face, planes.ptex[i].face);
    assert_true(extreme->u == (double)planes.ptex[i].u && extreme->v == (double)planes.ptex[i].v);
}

static float random_float(void)
{
    return (float)rand() / (float)RAND_MAX - 0.5f;
}

/* Random pictures: some pixels show nothing, no value or an infinite value, and values repeat. */
static void test_extremes(void **state)
{
    (void)state;
    enum { WIDTH = 16, N = 16 * 12 };
    static const sheen_ShowKind kinds[] = {sheen_ShowKind_SHOW_CURVATURE,
                                           sheen_ShowKind_SHOW_GAUSSIAN, sheen_ShowKind_SHOW_MEAN};
    srand(14);
    for (int run = 0; run < 300; run++) {
        const sheen_ShowKind kind = kinds[run % 3];
        struct frame frame = frame_of(kind, WIDTH, N / WIDTH);
        frame.plane[3] = planes.ptex;
        frame.plane[7] = run % 2 ? planes.coverage : NULL;
        size_t least = N, greatest = N;
        double values[N];
        for (size_t i = 0; i < N; i++) {
            bool is_empty = rand() % 4 == 0;
            float a = roundf(8 * random_float()), b = roundf(8 * random_float());
            float low = fminf(a, b), high = fmaxf(a, b);
            low = rand() % 16 == 0 ? -INFINITY : low;
            high = rand() % 16 == 0 ? NAN : high;
            planes.curvature[i][0] = is_empty ? NAN : low;
            planes.curvature[i][1] = is_empty ? NAN : high;
            for (int k = 0; k < 3; k++)
                planes.position[i][k] = is_empty ? NAN : random_float();
            planes.coverage[i] = is_empty ? (float)(rand() % 2) / 2 : 1;
            planes.ptex[i] = (struct ptex){is_empty ? UINT32_MAX : (uint32_t)i, 0.25f, 0.5f};
            double x = (double)planes.curvature[i][0], y = (double)planes.curvature[i][1];
            values[i] = kind == sheen_ShowKind_SHOW_MEAN       ? (x + y) / 2
                        : kind == sheen_ShowKind_SHOW_GAUSSIAN ? x * y
                        : fabs(x) > fabs(y)                    ? x
                                                               : y;
            if (!isfinite(values[i]))
                continue;
            least = least == N || values[i] < values[least] ? i : least;
            greatest = greatest == N || values[i] > values[greatest] ? i : greatest;
        }
        sheen_Show show = {.kind = kind};
        false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
        assert_true(extremes.has_values && least < N);
        assert_extreme(&extremes.least, values[least], least);
        assert_extreme(&extremes.greatest, values[greatest], greatest);
    }
}

/* Planes may hold values beyond a face, by extrapolation, or beyond the largest coordinate, by
 * rounding. The extremes are reported within the ranges that a client checks. */
static void test_extremes_in_range(void **state)
{
    (void)state;
    struct frame frame = frame_of(sheen_ShowKind_SHOW_MEAN, 2, 1);
    frame.plane[3] = planes.ptex;
    for (int i = 0; i < 2; i++) {
        planes.curvature[i][0] = planes.curvature[i][1] = (float)i;
        planes.position[i][0] = i ? 1e30f : -1e30f;
        planes.position[i][1] = planes.position[i][2] = 0;
        planes.ptex[i] = (struct ptex){0, i ? 1.00007f : -0.0004f, 0.5f};
    }
    sheen_Show show = {.kind = sheen_ShowKind_SHOW_MEAN};
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    assert_true(extremes.least.u == 0 && extremes.greatest.u == 1);
    assert_true(extremes.least.position.x >= -1e30 && extremes.greatest.position.x <= 1e30);
}

static void test_no_extremes(void **state)
{
    (void)state;
    const float none[][2] = {{NAN, NAN}, {0, INFINITY}};
    paint_curvatures(sheen_ShowKind_SHOW_MEAN, 1, none, 2);
    assert_false(extremes.has_values);
    /* Values that differ by rounding only are reported without a place. */
    const float flat[][2] = {{0, 1e-7f}, {-1e-7f, 0}};
    paint_curvatures(sheen_ShowKind_SHOW_MEAN, 1, flat, 2);
    assert_true(extremes.has_values && !extremes.least.has_position && !extremes.least.has_x_px);
    assert_true(extremes.least.value < 0 && extremes.greatest.value > 0);
    const float bent[][2] = {{0, 3e-5f}, {0, 0}};
    paint_curvatures(sheen_ShowKind_SHOW_MEAN, 1, bent, 2);
    assert_true(extremes.least.has_position && !extremes.least.has_face);
    assert_int_equal(extremes.least.x_px, 1);
    assert_int_equal(extremes.greatest.x_px, 0);
    const double slopes[] = {7, 7, 7};
    sheen_Show show = {
        .kind = sheen_ShowKind_SHOW_DRAFT, .has_direction = true, .direction = {0, -1, 0}};
    paint_drafts(&show, slopes, 3);
    assert_true(fabs(extremes.least.value - 7) < 1e-5 && !extremes.least.has_position);
    const double steps[] = {7, -8, 9};
    paint_drafts(&show, steps, 3);
    assert_int_equal(extremes.least.x_px, 1);
    assert_int_equal(extremes.greatest.x_px, 2);
    struct frame frame = frame_of(sheen_ShowKind_SHOW_NORMAL, 2, 1);
    show = (sheen_Show){.kind = sheen_ShowKind_SHOW_NORMAL};
    false_colour_paint(&frame, &show, 1, MISS, EMPTY, &extremes);
    assert_false(extremes.has_values);
}

static bool is_black(size_t i)
{
    return sum(planes.colour[i]) == 0;
}

static void test_legend(void **state)
{
    (void)state;
    const uint32_t width = 320, height = 240;
    struct frame frame = frame_of(sheen_ShowKind_SHOW_MEAN, width, height);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        planes.position[i][0] = NAN;
    const float black[4] = {0, 0, 0, 1};
    sheen_Show show = {.kind = sheen_ShowKind_SHOW_MEAN, .has_range = true, .range = 0.25};
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    size_t n_text = 0, blue = 0, red = 0, outside = 0;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            size_t i = (size_t)y * width + x;
            outside += !is_black(i) && (x < width / 3 || y < height * 3 / 4);
            const uint8_t *c = planes.colour[i];
            /* Strokes of small text cover no pixel wholly. */
            n_text += c[0] == c[1] && c[1] == c[2] && c[0] > 120;
            blue = c[2] > 190 && c[0] < 62 && !blue ? i : blue;
            red = c[0] > 175 && c[1] < 8 ? i : red;
        }
    assert_int_equal(outside, 0);
    assert_true(n_text > 60);
    assert_true(blue && red && blue % width < red % width);
    assert_true(red % width > width * 9 / 10);

    frame = frame_of(sheen_ShowKind_SHOW_MEAN, width, height);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        planes.position[i][0] = NAN;
    show.has_legend = true; /* `legend` is given, as false */
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        assert_true(is_black(i));
    show.legend = true;

    frame = frame_of(sheen_ShowKind_SHOW_MEAN, width, LEGEND_MIN_HEIGHT_PX - 1);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        planes.position[i][0] = NAN;
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        assert_true(is_black(i));
    frame = frame_of(sheen_ShowKind_SHOW_MEAN, 100, 240);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        planes.position[i][0] = NAN;
    false_colour_paint(&frame, &show, 1, MISS, black, &extremes);
    for (size_t i = 0; i < MAX_PIXELS; i++)
        assert_true(is_black(i));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_curvatures),
        cmocka_unit_test(test_no_surface),
        cmocka_unit_test(test_outline),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_drafts),
        cmocka_unit_test(test_ptex),
        cmocka_unit_test(test_ranges),
        cmocka_unit_test(test_legend),
        cmocka_unit_test(test_extremes),
        cmocka_unit_test(test_no_extremes),
        cmocka_unit_test(test_extremes_in_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
