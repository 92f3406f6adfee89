/* Values of options: numbers, vectors, colours, patterns, lights, and numbered file names. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/options/frame_names.h"
#include "client/cli/options/lights_text.h"
#include "client/cli/options/values.h"

static void numbers_are_strict(void **state)
{
    (void)state;
    static const char *const good[] = {"0", "-1.5", "+2", "1e3", ".5", "5.", "1e-300"};
    static const char *const bad[] = {"",      " 1",  "1 ",  "1x", "nan", "inf", "-inf", "0x10",
                                      "1e999", "1,5", "--1", "1e", "e5",  ".",   "1.2.3"};
    double value;
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
        assert_true(value_double(good[i], &value));
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
        assert_false(value_double(bad[i], &value));
    uint32_t number;
    assert_true(value_uint32("4294967295", &number));
    assert_int_equal(number, UINT32_MAX);
    static const char *const wrong[] = {"", "-1", "+1", "4294967296", "1.0", " 1", "99999999999"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(*wrong); i++)
        assert_false(value_uint32(wrong[i], &number));
}

static void vectors_sizes_colours(void **state)
{
    (void)state;
    double v[3];
    assert_true(value_vec3("1,-2.5,3e2", v));
    assert_true(v[0] == 1 && v[1] == -2.5 && v[2] == 300);
    static const char *const bad_vectors[] = {"",        "1",    "1,2",   "1,2,",    "1,2,3,",
                                              "1,2,3,4", "1,,3", "1;2;3", "nan,0,0", "1, 2,3"};
    for (size_t i = 0; i < sizeof(bad_vectors) / sizeof(*bad_vectors); i++)
        assert_false(value_vec3(bad_vectors[i], v));
    uint32_t width, height;
    assert_true(value_size("1x65536", &width, &height));
    assert_int_equal(width, 1);
    assert_int_equal(height, 65536);
    static const char *const bad_sizes[] = {"",     "0x0", "0x5",          "5x0",
                                            "5",    "5x",  "x5",           "5x5x5",
                                            "-5x5", "5X5", "4294967296x1", "65537x1"};
    for (size_t i = 0; i < sizeof(bad_sizes) / sizeof(*bad_sizes); i++)
        assert_false(value_size(bad_sizes[i], &width, &height));
    float colour[4];
    assert_true(value_colour("#ff8000", colour));
    assert_true(colour[0] == 1 && colour[2] == 0 && colour[3] == 1);
    assert_true(fabsf(colour[1] - 128 / 255.0f) < 1e-6f);
    assert_true(value_colour("#00000000", colour));
    assert_true(colour[3] == 0);
    static const char *const bad_colours[] = {"",         "#",       "ff8000",     "#ff800",
                                              "#ff80000", "#gg8000", "#ff8000000", "red"};
    for (size_t i = 0; i < sizeof(bad_colours) / sizeof(*bad_colours); i++)
        assert_false(value_colour(bad_colours[i], colour));
}

static void planes_and_formats(void **state)
{
    (void)state;
    uint32_t planes;
    assert_true(value_planes("P,N,ptex,light,k,dlight,coverage", &planes));
    assert_int_equal(planes, 254);
    assert_true(value_planes("k", &planes));
    assert_int_equal(planes, SHEEN_PLANE_CURVATURE);
    static const char *const bad[] = {"", "p", "P,", ",P", "P,,N", "P N", "depth"};
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
        assert_false(value_planes(bad[i], &planes));
    enum sheen_format format;
    assert_true(value_format("a/b.c/hood.EXR", &format));
    assert_int_equal(format, SHEEN_FORMAT_EXR);
    assert_true(value_format("x.jpeg", &format));
    assert_int_equal(format, SHEEN_FORMAT_JPEG);
    assert_true(value_format("x.tiff", &format));
    assert_int_equal(format, SHEEN_FORMAT_TIFF);
    static const char *const unknown[] = {"", "png", ".png", "a.png/b", "a.bmp", "a.", "a.png "};
    for (size_t i = 0; i < sizeof(unknown) / sizeof(*unknown); i++)
        assert_false(value_format(unknown[i], &format));
}

static void patterns(void **state)
{
    (void)state;
    struct sheen_pattern pattern;
    const char *image;
    char why[LIGHTS_WHY_BYTES];
    assert_true(text_pattern("stripes", &pattern, &image, why));
    assert_true(pattern.count == 40 && pattern.duty == 0.5 && !pattern.has_colours);
    assert_null(image);
    assert_true(text_pattern("circles:count=7,bg=#000080,duty=0.25", &pattern, &image, why));
    assert_int_equal(pattern.kind, SHEEN_PATTERN_CIRCLES);
    assert_true(pattern.count == 7 && pattern.duty == 0.25 && pattern.has_colours);
    assert_true(pattern.foreground[0] == 1 && pattern.background[3] == 1);
    assert_true(text_pattern("lattice:count=3", &pattern, &image, why));
    assert_int_equal(pattern.kind, SHEEN_PATTERN_LATTICE);
    assert_true(text_pattern("image:a:b,c.png", &pattern, &image, why));
    assert_int_equal(pattern.kind, SHEEN_PATTERN_IMAGE);
    assert_string_equal(image, "a:b,c.png");
    assert_true(text_pattern("lines:at=0.1/0.5,width=0.02,soft=0", &pattern, &image, why));
    assert_int_equal(pattern.kind, SHEEN_PATTERN_LINES);
    assert_true(pattern.n_at == 2 && pattern.at[1] == 0.5 && pattern.width == 0.02);
    assert_true(text_pattern("rainbow:period=3,rotation=-45,offset=0.25,opacity=0.5", &pattern,
                             &image, why));
    assert_true(pattern.kind == SHEEN_PATTERN_RAINBOW && pattern.period == 3 &&
                pattern.rotation_deg == -45 && pattern.offset == 0.25 && pattern.opacity == 0.5);
    static const char *const bad[][2] = {{"stripes:at=1", "at changes nothing of stripes"},
                                         {"stripes:width=0.1", "width changes nothing of stripes"},
                                         {"lines:count=4", "count changes nothing of lines"},
                                         {"lines:period=4", "period changes"},
                                         {"lines:duty=0.4", "duty changes"},
                                         {"lines:offset=0.4", "offset changes"},
                                         {"rainbow:duty=0.4", "duty changes nothing of rainbow"},
                                         {"rainbow:soft=0.4", "soft changes"},
                                         {"rainbow:fg=#ff0000", "fg changes"},
                                         {"stripes:count=4,period=3", "exclude each other"},
                                         {"stripes:period=3,duty=1,count=4", "exclude each"},
                                         {"lines:at=", "at must"},
                                         {"lines:at=1/x", "at must"},
                                         {"lines:width=0", "width"},
                                         {"stripes:soft=2", "soft"},
                                         {"stripes:opacity=-1", "opacity"},
                                         {"stripes:period=0", "period"},
                                         {"lines:at=1/1/1/1/1/1/1/1/1/1/1/1/1/1/1/1/1", "at must"},
                                         {"", "patterns are"},
                                         {"dots", "patterns are"},
                                         {"stripes:", "nothing"},
                                         {"stripes:count", "'='"},
                                         {"stripes:count=0", "count"},
                                         {"stripes:count=1e6", "count"},
                                         {"stripes:duty=1.1", "duty"},
                                         {"stripes:duty=nan", "duty"},
                                         {"stripes:fg=red", "#rrggbb"},
                                         {"stripes:n=3", "no part 'n'"},
                                         {"image:", "file"},
                                         {"stripes:count=3,,", "'='"}};
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        assert_false(text_pattern(bad[i][0], &pattern, &image, why));
        assert_non_null(strstr(why, bad[i][1]));
    }
}

static void families_and_lights(void **state)
{
    (void)state;
    struct sheen_lines lines;
    struct sheen_light light;
    char why[LIGHTS_WHY_BYTES];
    assert_true(text_lines("isophote:0,0,1", &lines, why));
    assert_true(lines.family == SHEEN_LINES_ISOPHOTE && lines.has_direction &&
                lines.direction[2] == 1);
    assert_true(text_lines("zebra", &lines, why));
    assert_true(lines.family == SHEEN_LINES_ZEBRA && !lines.has_direction);
    assert_false(text_lines("reflection:0,0,1", &lines, why));
    assert_false(text_lines("zebras", &lines, why));
    assert_false(text_lines("isophote:1,2", &lines, why));
    assert_true(text_lines("zebra:-y", &lines, why));
    assert_true(lines.direction[0] == 0 && lines.direction[1] == -1 && lines.direction[2] == 0);
    struct sheen_show show;
    assert_true(text_show("draft:+z", &show, why));
    assert_true(show.direction[0] == 0 && show.direction[1] == 0 && show.direction[2] == 1);
    assert_false(text_show("draft:", &show, why));
    assert_false(text_show("draft:zz", &show, why));
    assert_non_null(strstr(why, "x, y, z, -x, -y, -z"));
    assert_true(text_light("plane:one-sided", &light, why));
    assert_true(light.kind == SHEEN_LIGHT_PLANE && light.one_sided);
    assert_true(text_light("sphere", &light, why));
    assert_true(light.kind == SHEEN_LIGHT_SPHERE && !light.one_sided);
    assert_false(text_light("tunnel:one-sided", &light, why));
    assert_false(text_light("plane:two-sided", &light, why));
    assert_true(text_line_eye("1,2,3", &lines, why));
    assert_true(lines.eye_kind == SHEEN_LINE_EYE_POINT && lines.eye[2] == 3);
    assert_true(text_line_eye("dir:0,0,-1", &lines, why));
    assert_true(lines.eye_kind == SHEEN_LINE_EYE_DIRECTION && lines.eye[2] == -1);
    assert_true(text_line_eye("camera", &lines, why));
    assert_int_equal(lines.eye_kind, SHEEN_LINE_EYE_CAMERA);
    assert_false(text_line_eye("dir:", &lines, why));
}

/* Parses a command line that is written with spaces. */

/* A file name with anything but exactly one number would overwrite files, or read arguments that do
 * not exist. */
static void frames_have_names(void **state)
{
    (void)state;
    static const struct {
        const char *pattern, *seven, *million;
    } good[] = {{"FRAME_%04d.png", "FRAME_0007.png", "FRAME_999999.png"},
                {"a/b.c/%d.exr", "a/b.c/7.exr", "a/b.c/999999.exr"},
                {"%3d.jpg", "  7.jpg", "999999.jpg"},
                {"x%09dy.tif", "x000000007y.tif", "x000999999y.tif"},
                {"%1d", "7", "999999"}};
    static const char *const bad[] = {
        "",         "a.png",   "%",        "%d%d.png",  "%%d.png",  "%d%%",     "%s.png",
        "%n.png",   "%ld.png", "%-4d.png", "%+d",       "%.3d.png", "%010d",    "%12d.png",
        "%0d.png",  "%00d",    "%u.png",   "%i.png",    "%x.png",   "%*d.png",  "% 4d",
        "%4",       "%04",     "%0",       "a%d/b.png", "%d/%d",    "%1$d.png", "%d.png%",
        "%hhd.png", "%'d.png", "a%D.png"};
    struct frame_names names;
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++) {
        assert_true(frame_names_parse(good[i].pattern, &names));
        char *seven = frame_names_path(&names, 7), *million = frame_names_path(&names, 999999);
        assert_string_equal(seven, good[i].seven);
        assert_string_equal(million, good[i].million);
        free(seven);
        free(million);
    }
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
        if (frame_names_parse(bad[i], &names))
            fail_msg("'%s' is taken", bad[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_strict),  cmocka_unit_test(vectors_sizes_colours),
        cmocka_unit_test(planes_and_formats),  cmocka_unit_test(patterns),
        cmocka_unit_test(families_and_lights), cmocka_unit_test(frames_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
