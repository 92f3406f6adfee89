/* The command line: values, tables, what belongs together; and JSON. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client/cli/commands.h"
#include "client/cli/json.h"
#include "client/cli/lights_text.h"
#include "client/cli/values.h"

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
static enum options_result parse(const struct command *command, const char *line,
                                 struct options *options, char *why)
{
    static char copy[1000]; /* options point into it */
    char *argv[32];
    int argc = 0;
    snprintf(copy, sizeof(copy), "%s %s", command->name, line);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " "))
        argv[argc++] = word;
    argv[argc] = NULL;
    return options_parse(command, argc, argv, options, why);
}

/* A pattern that is not strictly one number would write over files, or read what is not there. */
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

static void good_command_lines(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o out.png", &options, why), OPTIONS_RUN);
    assert_string_equal(options.model, "m.obj");
    assert_int_equal(options.request.width_px, 1280);
    assert_int_equal(options.request.camera.projection, SHEEN_PROJECTION_AUTO);
    assert_int_equal(options.request.planes, SHEEN_PLANE_COLOUR);
    assert_false(options.request.lights[0].is_placed || options.request.lights[0].has_kind);
    assert_int_equal(parse(&COMMAND_RENDER,
                           "--json --size 64x32 --eye -1,-2,3 m.glb --target 0,0,0 --ortho 2 "
                           "--light-center 0,0,4 --light-u 4,0,0 --light-v 0,4,0 --output=o.exr "
                           "--aov P,N --miss #102030 --lines reflection --surface exact -q",
                           &options, why),
                     OPTIONS_RUN);
    assert_int_equal(options.request.camera.projection, SHEEN_PROJECTION_ORTHOGRAPHIC);
    assert_true(options.request.camera.eye[0] == -1 && options.request.camera.up[2] == 1);
    assert_true(!options.request.camera.auto_view && options.request.camera.auto_up);
    assert_true(options.request.lights[0].is_placed && options.json && options.quiet);
    assert_int_equal(options.request.planes, 7);
    assert_int_equal(options.request.format, SHEEN_FORMAT_EXR);
    assert_true(options.request.has_miss && !options.request.has_empty);
    assert_int_equal(parse(&COMMAND_RENDER,
                           "m.obj -o o.png --pattern lines --light tunnel --light plane "
                           "--light-center 0,0,4 --light-u 4,0,0 --light-v 0,4,0 --pattern "
                           "circles --light sphere --line-eye 1,2,3 --filter off",
                           &options, why),
                     OPTIONS_RUN);
    assert_int_equal(options.request.n_lights, 3);
    const struct sheen_light *lights = options.request.lights;
    assert_true(lights[0].kind == SHEEN_LIGHT_TUNNEL &&
                lights[0].pattern.kind == SHEEN_PATTERN_LINES);
    assert_true(lights[0].has_kind && lights[1].has_kind);
    assert_true(lights[1].kind == SHEEN_LIGHT_PLANE &&
                lights[1].pattern.kind == SHEEN_PATTERN_CIRCLES);
    assert_true(!lights[0].is_placed && lights[1].is_placed && !lights[2].is_placed);
    assert_true(lights[2].kind == SHEEN_LIGHT_SPHERE &&
                lights[2].pattern.kind == SHEEN_PATTERN_STRIPES);
    assert_true(options.request.unfiltered);
    assert_int_equal(options.request.surface, SHEEN_SURFACE_EXACT);
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --surface wireframe:5", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(options.request.surface, SHEEN_SURFACE_WIREFRAME);
    assert_int_equal(options.request.surface_level, 5);
    assert_int_equal(options.request.show.kind, SHEEN_SHOW_LINES);
    assert_int_equal(
        parse(&COMMAND_RENDER, "m.obj -o a.png --show-range 0.5 --show gaussian", &options, why),
        OPTIONS_RUN);
    assert_int_equal(options.request.show.kind, SHEEN_SHOW_GAUSSIAN);
    assert_true(options.request.show.range == 0.5);
    assert_int_equal(parse(&COMMAND_STREAM, "m.obj --frames 2 --show draft:0,-1,2", &options, why),
                     OPTIONS_RUN);
    const struct sheen_show *show = &options.request.show;
    assert_int_equal(show->kind, SHEEN_SHOW_DRAFT);
    assert_true(show->direction[1] == -1 && show->direction[2] == 2 && show->range == 0);
    assert_int_equal(
        parse(&COMMAND_STREAM, "m.obj --frames 10 --orbit -3 --light-only", &options, why),
        OPTIONS_RUN);
    assert_true(options.frames == 10 && options.orbit_deg == -3 && options.light_only);
    assert_false(options.given & GIVEN_CLASS); /* then the command chooses */
    assert_int_equal(
        parse(&COMMAND_STREAM, "m.obj --frames 10 --class batch --deadline 250", &options, why),
        OPTIONS_RUN);
    assert_true(options.given & GIVEN_CLASS);
    assert_int_equal(options.request.request_class, SHEEN_CLASS_BATCH);
    assert_int_equal(options.request.deadline_ms, 250);
    assert_int_equal(parse(&COMMAND_RENDER,
                           "m.obj --jpeg-quality 1 -o a.JPEG --jpeg-subsampling 420", &options,
                           why),
                     OPTIONS_RUN);
    assert_int_equal(options.request.jpeg_quality, 1);
    assert_int_equal(options.request.jpeg_subsampling, SHEEN_JPEG_420);
    assert_int_equal(
        parse(&COMMAND_STREAM, "m.obj --frames 2 -o a%d.jpg --jpeg-quality 100", &options, why),
        OPTIONS_RUN);
    assert_int_equal(options.request.jpeg_quality, 100);
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --class interactive", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(options.request.request_class, SHEEN_CLASS_INTERACTIVE);
    assert_int_equal(parse(&COMMAND_INFO, "m.obj --server unix:/tmp/s", &options, why),
                     OPTIONS_RUN);
    assert_string_equal(options.server, "unix:/tmp/s");
    assert_int_equal(options.reconnect_s, 30);
    assert_int_equal(parse(&COMMAND_INFO, "m.obj --reconnect 0", &options, why), OPTIONS_RUN);
    assert_int_equal(options.reconnect_s, 0);
    assert_int_equal(parse(&COMMAND_LEVELS, "m.obj -o a.png --reconnect 86400", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(options.reconnect_s, 86400);
    assert_int_equal(parse(&COMMAND_STATS, "--memory-budget 3G", &options, why), OPTIONS_RUN);
    assert_true(options.memory_budget_bytes == (uint64_t)3 << 30);
    assert_int_equal(parse(&COMMAND_STATS, "--device 1", &options, why), OPTIONS_RUN);
    assert_int_equal(options.memory_budget_bytes, 0);
    assert_int_equal(options.reconnect_s, 0);
    assert_int_equal(parse(&COMMAND_STATS, "--help --nonsense", &options, why), OPTIONS_HELP);
    assert_int_equal(parse(&COMMAND_RENDER,
                           "m.obj -o a.png --view left --up -y --zoom 8@0.25,1 --target 1,2,3",
                           &options, why),
                     OPTIONS_RUN);
    const struct sheen_camera *camera = &options.request.camera;
    assert_true(camera->auto_view && camera->has_target && camera->target[2] == 3);
    assert_true(camera->view == SHEEN_VIEW_LEFT && camera->up[1] == -1 && !camera->auto_up);
    assert_true(camera->zoom == 8 && camera->zoom_at[0] == 0.25 && camera->zoom_at[1] == 1);
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --zoom 3", &options, why), OPTIONS_RUN);
    assert_true(camera->zoom == 3 && camera->zoom_at[0] == 0.5 && camera->zoom_at[1] == 0.5);
    assert_true(camera->auto_view && !camera->has_target && camera->auto_up);
}

/* --up, --fov and --ortho change the camera that frames the model. */
static void cameras_in_part(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    const struct sheen_camera *camera = &options.request.camera;
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --fov 20", &options, why), OPTIONS_RUN);
    assert_int_equal(camera->projection, SHEEN_PROJECTION_PERSPECTIVE);
    assert_true(camera->auto_view && camera->auto_up && camera->fov_deg == 20);
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --ortho 3", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(camera->projection, SHEEN_PROJECTION_ORTHOGRAPHIC);
    assert_true(camera->auto_view && camera->auto_up && camera->ortho_height == 3);
    assert_int_equal(parse(&COMMAND_RENDER, "m.obj -o a.png --up 0,1,0", &options, why),
                     OPTIONS_RUN);
    assert_int_equal(camera->projection, SHEEN_PROJECTION_PERSPECTIVE);
    assert_true(camera->auto_view && !camera->auto_up && camera->up[1] == 1);
}

static void bad_command_lines_name_the_option(void **state)
{
    (void)state;
    static const struct {
        const struct command *command;
        const char *line, *word;
    } bad[] = {
        {&COMMAND_RENDER, "", "MODEL"},
        {&COMMAND_RENDER, "m.obj", "-o FILE"},
        {&COMMAND_RENDER, "m.obj -o", "-o needs a value"},
        {&COMMAND_RENDER, "m.obj n.obj -o a.png", "n.obj"},
        {&COMMAND_RENDER, "m.obj -o a.bmp", "--output 'a.bmp'"},
        {&COMMAND_RENDER, "m.obj -o a.png --aov P", ".exr"},
        {&COMMAND_RENDER, "m.obj -o a.exr --aov depth", "P,N,ptex,light,k,dlight"},
        {&COMMAND_RENDER, "m.obj -o a.png --size 0x0", "--size '0x0'"},
        {&COMMAND_RENDER, "m.obj -o a.png --eye 1,2,3", "--eye needs a --target"},
        {&COMMAND_RENDER, "m.obj -o a.png --eye 1,2,3 --target 0,0,0 --view top", "exclude"},
        {&COMMAND_RENDER, "m.obj -o a.png --view topmost", "--view 'topmost'"},
        {&COMMAND_RENDER, "m.obj -o a.png --up xy", "--up 'xy'"},
        {&COMMAND_RENDER, "m.obj -o a.png --up -", "--up '-'"},
        {&COMMAND_RENDER, "m.obj -o a.png --zoom 0.9", "FACTOR must be a number from 1 to"},
        {&COMMAND_RENDER, "m.obj -o a.png --zoom 2@", "FACTOR@X,Y"},
        {&COMMAND_RENDER, "m.obj -o a.png --zoom 2@0.5,0.5,0.5", "FACTOR@X,Y"},
        {&COMMAND_RENDER, "m.obj -o a.png --zoom 2@0.5,1.5", "shares of the picture, from 0 to 1"},
        {&COMMAND_RENDER, "m.obj -o a.png --fov 40 --ortho 2", "exclude"},
        {&COMMAND_RENDER, "m.obj -o a.png --eye 1,1,1 --target 0,0,0 --fov 180", "--fov '180'"},
        {&COMMAND_RENDER, "m.obj -o a.png --eye 1,1,1 --target 0,0,0 --fov 30 --ortho 2",
         "exclude"},
        {&COMMAND_RENDER, "m.obj -o a.png --light-u 1,0,0", "come together"},
        {&COMMAND_RENDER, "m.obj -o a.png --lines zebras", "--lines 'zebras'"},
        {&COMMAND_RENDER, "m.obj -o a.png --lines highlight:0,0,1", "isophote"},
        {&COMMAND_RENDER, "m.obj -o a.png --light bulb", "--light 'bulb'"},
        {&COMMAND_RENDER, "m.obj -o a.png --light-u 1,0,0 --light plane --light plane",
         "come together"},
        {&COMMAND_RENDER,
         "m.obj -o a.png --light plane --light plane --light plane --light plane --light plane "
         "--light plane --light plane --light plane --light plane",
         "8 lights"},
        {&COMMAND_RENDER, "m.obj -o a.png --line-eye 1,2", "--line-eye '1,2'"},
        {&COMMAND_RENDER, "m.obj -o a.png --filter on", "exact or off"},
        {&COMMAND_RENDER, "m.obj -o a.png --base blue", "#rrggbb"},
        {&COMMAND_RENDER, "m.obj -o a.jpg --jpeg-quality 0", "1 to 100"},
        {&COMMAND_RENDER, "m.obj -o a.jpg --jpeg-quality 101", "--jpeg-quality '101'"},
        {&COMMAND_RENDER, "m.obj -o a.jpg --jpeg-quality high", "1 to 100"},
        {&COMMAND_RENDER, "m.obj -o a.jpg --jpeg-subsampling 411", "444, 422 or 420"},
        {&COMMAND_RENDER, "m.obj -o a.png --jpeg-quality 95", ".jpg"},
        {&COMMAND_STREAM, "m.obj --frames 2 --jpeg-quality 95", ".jpg"},
        {&COMMAND_STREAM, "m.obj --frames 2 --jpeg-quality 95 -o a%d.tif", ".jpg"},
        {&COMMAND_RENDER, "m.obj --jpeg-subsampling 444 -o a.tif", ".jpg"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface polygon", "polygon:LEVEL"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface polygon:", "polygon:LEVEL"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface polygon:7", "LEVEL from 0 to 6"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface wireframe:-1", "LEVEL from 0 to 6"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface exact:1", "LEVEL from 0 to 6"},
        {&COMMAND_RENDER, "m.obj -o a.png --surface tessellation:1", "LEVEL from 0 to 6"},
        {&COMMAND_RENDER, "m.obj -o a.png --show torsion", "curvature, gaussian"},
        {&COMMAND_RENDER, "m.obj -o a.png --show mean:1", "--show 'mean:1'"},
        {&COMMAND_RENDER, "m.obj -o a.png --show draft", "draft:0,0,1"},
        {&COMMAND_RENDER, "m.obj -o a.png --show draft:1,2", "draft:0,0,1"},
        {&COMMAND_RENDER, "m.obj -o a.png --show draft:0,0,0", "not 0,0,0"},
        {&COMMAND_RENDER, "m.obj -o a.png --fov 179.5", "from 1e-6 to 179 degrees"},
        {&COMMAND_RENDER, "m.obj -o a.png --eye 2e30,0,0 --target 0,0,0",
         "each from -1e30 to 1e30"},
        {&COMMAND_RENDER, "m.obj -o a.png --up 0,0,0", "--up '0,0,0'"},
        {&COMMAND_RENDER, "m.obj -o a.png --lines zebra:0,0,0", "not 0,0,0"},
        {&COMMAND_RENDER, "m.obj -o a.png --light-u 0,0,0", "length from 1e-18 to 1e18 units"},
        {&COMMAND_RENDER, "m.obj -o a.jpg --size 65501x1", "65500"},
        {&COMMAND_RENDER, "m.obj -o a.png --show-range 91 --show draft:0,0,1",
         "at most 90 degrees"},
        {&COMMAND_RENDER, "m.obj -o a.png --show-range 0", "--show-range '0'"},
        {&COMMAND_RENDER, "m.obj -o a.png --show-range nan", "above 0"},
        {&COMMAND_RENDER, "m.obj -o a.png --class urgent", "interactive, still or batch"},
        {&COMMAND_STREAM, "m.obj --frames 5 --deadline 0", "--deadline '0'"},
        {&COMMAND_RENDER, "m.obj -o a.png --deadline 3600001", "from 1 to 3600000 milliseconds"},
        {&COMMAND_LEVELS, "m.obj -o a.png --class batch", "--class"},
        {&COMMAND_RENDER, "m.obj -o a.png --pattern dots", "--pattern 'dots'"},
        {&COMMAND_RENDER, "m.obj -o a.png --empty red", "#rrggbb"},
        {&COMMAND_RENDER, "m.obj -o a.png --nonsense", "--nonsense"},
        {&COMMAND_RENDER, "m.obj -o a.png -x", "-x"},
        {&COMMAND_RENDER, "m.obj -o a.png --device gpu", "--device 'gpu'"},
        {&COMMAND_RENDER, "m.obj -o a.png --device 0 --server unix:/s", "unix:/s"},
        {&COMMAND_RENDER, "m.obj -o a.png --legend on", "--legend is for"},
        {&COMMAND_STREAM, "m.obj --frames 2 --legend off --show lines", "--legend is for"},
        {&COMMAND_RENDER, "m.obj -o a.png --memory-budget 1G --server unix:/s", "its operator"},
        {&COMMAND_INFO, "m.obj --memory-budget 4GB", "800M or 4G"},
        {&COMMAND_INFO, "m.obj --memory-budget 4194303", "4M or more"},
        {&COMMAND_INFO, "m.obj --memory-budget 99999999T", "4M or more"},
        {&COMMAND_RENDER, "m.obj -o a.png --json=yes", "--json=yes"},
        {&COMMAND_STREAM, "m.obj", "--frames"},
        {&COMMAND_STREAM, "m.obj --frames 0", "--frames '0'"},
        {&COMMAND_STREAM, "m.obj --frames 1000001", "--frames"},
        {&COMMAND_STREAM, "m.obj --frames 5 --orbit 361", "--orbit"},
        {&COMMAND_STREAM, "m.obj --frames 5 -o a.png", "as FRAME_%04d.png"},
        {&COMMAND_STREAM, "m.obj --frames 5 -o a_%d.gif", "as FRAME_%04d.png"},
        {&COMMAND_STREAM, "m.obj --frames 5 -o a_%d.jpg --size 65501x1", "65500"},
        {&COMMAND_INFO, "m.obj --size 4x4", "--size"},
        {&COMMAND_INFO, "m.obj --reconnect 86401", "0 to 86400"},
        {&COMMAND_RENDER, "m.obj -o a.png --reconnect -1", "--reconnect '-1'"},
        {&COMMAND_STREAM, "m.obj --frames 5 --reconnect 1.5", "whole number"},
        {&COMMAND_STATS, "--reconnect 5", "--reconnect is no option here"},
        {&COMMAND_STATS, "m.obj", "m.obj"},
    };
    struct options options;
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
        char why[OPTIONS_WHY_BYTES] = "";
        assert_int_equal(parse(bad[i].command, bad[i].line, &options, why), OPTIONS_WRONG);
        if (!strstr(why, bad[i].word))
            fail_msg("'%s': '%s' lacks '%s'", bad[i].line, why, bad[i].word);
    }
}

static void the_environment_names_a_server(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    setenv("SHEEN_SERVER", "unix:/from/environment", 1);
    assert_int_equal(parse(&COMMAND_STATS, "", &options, why), OPTIONS_RUN);
    assert_string_equal(options.server, "unix:/from/environment");
    assert_int_equal(parse(&COMMAND_STATS, "--server tcp:a:1", &options, why), OPTIONS_RUN);
    assert_string_equal(options.server, "tcp:a:1");
    setenv("SHEEN_SERVER", "", 1);
    assert_int_equal(parse(&COMMAND_STATS, "", &options, why), OPTIONS_RUN);
    assert_null(options.server);
    unsetenv("SHEEN_SERVER");
}

static void help_shows_every_option(void **state)
{
    (void)state;
    static const struct command *const commands[] = {
        &COMMAND_RENDER, &COMMAND_STREAM, &COMMAND_INFO, &COMMAND_STATS, &COMMAND_LEVELS};
    for (size_t i = 0; i < 5; i++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        options_help(commands[i], out);
        fclose(out);
        for (const struct option_row *const *table = commands[i]->tables; *table; table++)
            for (const struct option_row *row = *table; row->name; row++) {
                char name[40];
                snprintf(name, sizeof(name), "--%s", row->name);
                assert_non_null(strstr(text, name));
                assert_true(row->help && *row->help);
            }
        assert_non_null(strstr(text, "examples:"));
        free(text);
    }
}

/* Valid until the next. */
static const char *help_of(const struct command *command)
{
    static char text[1 << 15];
    FILE *out = fmemopen(text, sizeof(text), "w");
    options_help(command, out);
    fclose(out);
    return text;
}

/* Each its own, and none promises an answer to a question that it does not ask. */
static void help_has_the_commands_exit_codes(void **state)
{
    (void)state;
    static const struct {
        const struct command *command;
        const char *codes; /* in this order */
    } cases[] = {{&COMMAND_RENDER, "02345"}, {&COMMAND_STREAM, "02345"}, {&COMMAND_INFO, "02345"},
                 {&COMMAND_LEVELS, "02345"}, {&COMMAND_STATS, "02345"},  {&COMMAND_LIGHTS, "023"},
                 {&COMMAND_PATTERNS, "023"}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        char found[11] = "";
        const char *codes = strstr(help_of(cases[i].command), "Exit codes: ");
        assert_non_null(codes);
        for (; *codes; codes++) {
            const char digit[] = {*codes, 0};
            if (strchr("0123456789", *codes) && codes[1] == ' ')
                strcat(found, digit);
        }
        assert_string_equal(found, cases[i].codes);
    }
    const char *text = help_of(&COMMAND_LEVELS);
    assert_non_null(strstr(text, "usage: sheen levels "));
    assert_non_null(strstr(text, "old name, figure7, still works"));
}

/* No place of a range is left open. */
static void help_has_the_ranges(void **state)
{
    (void)state;
    static const struct command *const commands[] = {&COMMAND_RENDER, &COMMAND_STREAM,
                                                     &COMMAND_LEVELS};
    static const char *const wanted[] = {"from 1e-6 to 179 degrees", "from 1 to 1000000",
                                         "each from 1 to 65536 pixels"};
    for (size_t i = 0; i < 3; i++) {
        const char *text = help_of(commands[i]);
        assert_null(strstr(text, "{}"));
        assert_non_null(strstr(text, wanted[i]));
    }
}

/* The size that --help says is the one that a command takes without --size. */
static void help_says_its_own_default_size(void **state)
{
    (void)state;
    static const struct {
        const struct command *command;
        const char *line;
    } cases[] = {{&COMMAND_RENDER, "m.obj -o a.png"},
                 {&COMMAND_STREAM, "m.obj --frames 1"},
                 {&COMMAND_LEVELS, "m.obj -o a.png"}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct options options;
        char why[OPTIONS_WHY_BYTES], wanted[40], *text = NULL;
        size_t size = 0;
        assert_int_equal(parse(cases[i].command, cases[i].line, &options, why), OPTIONS_RUN);
        snprintf(wanted, sizeof(wanted), "(default: %ux%u)", options.request.width_px,
                 options.request.height_px);
        FILE *out = open_memstream(&text, &size);
        options_help(cases[i].command, out);
        fclose(out);
        const char *row = strstr(text, "--size WxH"), *end = strchr(row, '\n');
        assert_memory_equal(end - strlen(wanted), wanted, strlen(wanted));
        assert_null(strstr(end, "--size WxH"));
        free(text);
    }
}

static void json_is_json(void **state)
{
    (void)state;
    char *text = NULL;
    size_t size = 0;
    struct json json = {.out = open_memstream(&text, &size)};
    const double v[3] = {0.1, NAN, -INFINITY};
    json_object_begin(&json, NULL);
    json_string(&json, "name", "a\"b\\c\nd\x01\x7f\xc3\xbc\xff\xc3");
    json_uint(&json, "n", UINT64_MAX);
    json_bool(&json, "yes", true);
    json_vec3(&json, "v", v);
    json_double(&json, "all digits", 0.1 + 0.2);
    json_hex(&json, "id", (const uint8_t *)"\x00\xff", 2);
    json_lines(&json, "lines", "one\n\ntwo\n");
    json_array_begin(&json, "empty");
    json_array_end(&json);
    json_object_end(&json);
    assert_true(json_finish(&json));
    fclose(json.out);
    assert_string_equal(text,
                        "{\n"
                        "  \"name\": \"a\\\"b\\\\c\\u000ad\\u0001\\u007f\xc3\xbc\\ufffd\\ufffd\",\n"
                        "  \"n\": 18446744073709551615,\n"
                        "  \"yes\": true,\n"
                        "  \"v\": [\n    0.1,\n    null,\n    null\n  ],\n"
                        "  \"all digits\": 0.30000000000000004,\n"
                        "  \"id\": \"00ff\",\n"
                        "  \"lines\": [\n    \"one\",\n    \"two\"\n  ],\n"
                        "  \"empty\": []\n"
                        "}\n");
    free(text);
    FILE *full = fopen("/dev/full", "w");
    json = (struct json){.out = full};
    json_uint(&json, NULL, 1);
    assert_false(json_finish(&json));
    fclose(full);
}

int main(void)
{
    unsetenv("SHEEN_SERVER");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_strict),
        cmocka_unit_test(vectors_sizes_colours),
        cmocka_unit_test(planes_and_formats),
        cmocka_unit_test(patterns),
        cmocka_unit_test(families_and_lights),
        cmocka_unit_test(frames_have_names),
        cmocka_unit_test(good_command_lines),
        cmocka_unit_test(cameras_in_part),
        cmocka_unit_test(bad_command_lines_name_the_option),
        cmocka_unit_test(the_environment_names_a_server),
        cmocka_unit_test(help_shows_every_option),
        cmocka_unit_test(help_has_the_commands_exit_codes),
        cmocka_unit_test(help_has_the_ranges),
        cmocka_unit_test(help_says_its_own_default_size),
        cmocka_unit_test(json_is_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
