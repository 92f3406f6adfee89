/* Command lines: which fields options set, which options need or exclude each other, and which are
 * refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/command_line.h"

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
    assert_true(options.request.unfiltered && !options.request.aliased);
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
    assert_false(options.given & GIVEN_CLASS); /* then each command chooses its own */
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

/* --up, --fov and --ortho change the default camera, which frames the model. */
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

/* '=' is refused only where it is attached to a letter. */
static void values_that_begin_with_an_equals_sign(void **state)
{
    (void)state;
    struct options options;
    char why[OPTIONS_WHY_BYTES];
    static const char *const lines[] = {"m.obj -o =a.png", "m.obj --output==a.png",
                                        "m.obj --output =a.png"};
    for (size_t i = 0; i < sizeof(lines) / sizeof(*lines); i++) {
        assert_int_equal(parse(&COMMAND_RENDER, lines[i], &options, why), OPTIONS_RUN);
        assert_string_equal(options.output, "=a.png");
    }
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
        {&COMMAND_RENDER, "m.obj -o a.png --antialias on",
         "--antialias 'on': must be exact or off"},
        {&COMMAND_STREAM, "m.obj --frames 2 --antialias", "--antialias"},
        {&COMMAND_RENDER, "m.obj -o a.png --antialias exact --filter off", "exclude each other"},
        {&COMMAND_STREAM, "m.obj --frames 2 --filter off --antialias exact", "exclude each other"},
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
        {&COMMAND_RENDER, "m.obj -o a.png --nonsense", "--nonsense is no option here"},
        {&COMMAND_RENDER, "m.obj -o a.png -x", "-x"},
        {&COMMAND_RENDER, "m.obj -o a.png --device gpu", "--device 'gpu'"},
        {&COMMAND_RENDER, "m.obj -o a.png --device 0 --server unix:/s", "unix:/s"},
        {&COMMAND_RENDER, "m.obj -o a.png --legend on", "--legend is for"},
        {&COMMAND_STREAM, "m.obj --frames 2 --legend off --show lines", "--legend is for"},
        {&COMMAND_RENDER, "m.obj -o a.png --memory-budget 1G --server unix:/s", "its operator"},
        {&COMMAND_INFO, "m.obj --memory-budget 4GB", "800M or 4G"},
        {&COMMAND_INFO, "m.obj --memory-budget 37748735", "36M or more"},
        {&COMMAND_INFO, "m.obj --memory-budget 99999999T", "36M or more"},
        {&COMMAND_RENDER, "m.obj -o a.png --json=yes", "--json takes no value"},
        {&COMMAND_RENDER, "m.obj -o a.png --wel=1", "--weld takes no value"},
        {&COMMAND_RENDER, "m.obj -o a.png --line",
         "--line may be --lines --line-eye: write more of it"},
        {&COMMAND_RENDER, "m.obj -o a.png --light-=5",
         "--light- may be --light-center --light-u --light-v: write more of it"},
        {&COMMAND_RENDER, "m.obj -o a.png --help=1", "--help takes no value"},
        {&COMMAND_RENDER, "m.obj -o a.png --native",
         "--native may be --native-threads --native-isa: write more of it"},
        {&COMMAND_RENDER, "m.obj -o a.png --dedaline=5", "(did you mean --deadline?)"},
        {&COMMAND_RENDER, "m.obj -o=a.png", "-o takes its value without '=': -o a.png"},
        {&COMMAND_RENDER, "m.obj -qo=a.png", "-o takes its value without '=': -o a.png"},
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

int main(void)
{
    unsetenv("SHEEN_SERVER");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_command_lines),
        cmocka_unit_test(cameras_in_part),
        cmocka_unit_test(values_that_begin_with_an_equals_sign),
        cmocka_unit_test(bad_command_lines_name_the_option),
        cmocka_unit_test(the_environment_names_a_server),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
