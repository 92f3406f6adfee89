/* message_check_render(): which requests for frames are valid. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "protocol/messages/message.h"
#include "tests/unit/good_render.h"

static bool check(const sheen_Render *render, char *text)
{
    return message_check_render(render, 16384, 16384, text);
}

/* Expects that the request GOOD with one changed field is refused with a text that names this
 * field. */
#define REFUSED(field, value, word)                                                                \
    do {                                                                                           \
        sheen_Render changed = GOOD;                                                               \
        char why[MESSAGE_TEXT_BYTES] = "";                                                         \
        assert_true(check(&changed, why));                                                         \
        changed.field = value;                                                                     \
        assert_false(check(&changed, why));                                                        \
        assert_non_null(strstr(why, word));                                                        \
    } while (0)
#define ACCEPTED(field, value)                                                                     \
    do {                                                                                           \
        sheen_Render changed = GOOD;                                                               \
        char why[MESSAGE_TEXT_BYTES] = "";                                                         \
        changed.field = value;                                                                     \
        assert_true(check(&changed, why));                                                         \
    } while (0)

static void render_sizes(void **state)
{
    (void)state;
    REFUSED(width_px, 0, "width is 0");
    REFUSED(height_px, 0, "height is 0");
    REFUSED(width_px, 16385, "1 to 16384");
    REFUSED(height_px, 100000, "height is 100000");
    REFUSED(width_px, UINT32_MAX, "width");
    ACCEPTED(width_px, 16384);
    /* The protocol's limit holds for a device that has none of its own. */
    sheen_Render render = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    render.width_px = render.height_px = 100000;
    assert_false(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
    render.width_px = render.height_px = 65536;
    assert_false(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
    assert_non_null(strstr(text, "4294967296 bytes"));
}

static void render_jpeg_sizes(void **state)
{
    (void)state;
    for (int side = 0; side < 2; side++) {
        sheen_Render render = GOOD;
        char text[MESSAGE_TEXT_BYTES];
        uint32_t *side_px = side ? &render.height_px : &render.width_px;
        render.encoding = sheen_Encoding_ENCODING_JPEG;
        *side_px = 65500;
        assert_true(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
        *side_px = 65501;
        assert_false(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
        assert_non_null(strstr(text, side ? "height is 65501" : "width is 65501"));
        assert_non_null(strstr(text, "JPEG file has at most 65500 pixels"));
        render.encoding = sheen_Encoding_ENCODING_PNG;
        assert_true(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
    }
}

static void render_jpeg_options(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_Render render = GOOD;
    render.encoding = sheen_Encoding_ENCODING_JPEG;
    render.has_jpeg_quality = render.has_jpeg_subsampling = true;
    for (uint32_t quality = 0; quality <= 101; quality++) {
        render.jpeg_quality = quality;
        assert_int_equal(check(&render, text), quality >= 1 && quality <= 100);
    }
    assert_non_null(strstr(text, "jpeg_quality (--jpeg-quality) is 101; it must be from 1 to 100"));
    render.jpeg_quality = 50;
    for (int kind = 0; kind <= 3; kind++) {
        render.jpeg_subsampling = (sheen_JpegSubsampling)kind;
        assert_int_equal(check(&render, text), kind < 3);
    }
    assert_non_null(strstr(text, "jpeg_subsampling"));
    render.jpeg_subsampling = sheen_JpegSubsampling_JPEG_420;
    for (int e = 0; e <= (int)_sheen_Encoding_MAX; e++) {
        render.encoding = (sheen_Encoding)e;
        render.has_jpeg_quality = e % 2;
        render.has_jpeg_subsampling = true;
        assert_int_equal(check(&render, text), e == sheen_Encoding_ENCODING_JPEG);
        render.has_jpeg_quality = true;
        render.has_jpeg_subsampling = false;
        assert_int_equal(check(&render, text), e == sheen_Encoding_ENCODING_JPEG);
    }
    assert_non_null(strstr(text, "are for JPEG files"));
}

static void render_floats(void **state)
{
    (void)state;
    REFUSED(camera.eye.x, NAN, "camera.eye.x");
    REFUSED(camera.target.y, INFINITY, "camera.target.y");
    REFUSED(camera.up.z, 1.1e30, "camera.up.z");
    REFUSED(lights[0].centre.z, -INFINITY, "light.centre.z");
    REFUSED(lights[0].u.x, NAN, "light.u.x");
    REFUSED(lights[0].v.y, 1e308, "light.v.y");
    REFUSED(camera.fov_deg, 0, "fov_deg");
    REFUSED(camera.fov_deg, 180, "fov_deg");
    REFUSED(camera.fov_deg, NAN, "fov_deg");
    REFUSED(lights[0].pattern.count, 0, "pattern.count");
    REFUSED(lights[0].pattern.count, 100001, "pattern.count");
    REFUSED(lights[0].pattern.count, NAN, "pattern.count");
    REFUSED(lights[0].pattern.duty, -0.001, "pattern.duty");
    REFUSED(lights[0].pattern.duty, 1.001, "pattern.duty");
    REFUSED(lights[0].pattern.duty, NAN, "pattern.duty");
    REFUSED(lights[0].pattern.foreground.r, 1.01f, "pattern.foreground.r");
    REFUSED(lights[0].pattern.background.a, NAN, "pattern.background.a");
    REFUSED(miss.g, -0.01f, "miss.g");
    REFUSED(empty.b, INFINITY, "empty.b");
    REFUSED(camera.fov_deg, 179.5, "from 1e-6 to 179 degrees");
    ACCEPTED(camera.fov_deg, 179);
    ACCEPTED(lights[0].pattern.count, 100000);
    ACCEPTED(lights[0].pattern.duty, 0);
    ACCEPTED(camera.eye.x, 1e30);
}

static void render_geometry(void **state)
{
    (void)state;
    sheen_Vec3 along = {-3, 4, -2}, zero = {0, 0, 0};
    REFUSED(camera.eye, GOOD.camera.target, "same point");
    REFUSED(camera.up, along, "line of sight");
    REFUSED(camera.up, zero, "line of sight");
    REFUSED(camera.up, along, "--up 0,1,0");
    REFUSED(camera.has_target, false, "comes with camera.target");
    ACCEPTED(camera.has_eye, false); /* the default camera turns to the target */
    sheen_Render framed = GOOD;
    char why_framed[MESSAGE_TEXT_BYTES];
    framed.camera.has_view = true;
    framed.camera.view = sheen_View_VIEW_TOP;
    assert_false(check(&framed, why_framed));
    assert_non_null(strstr(why_framed, "not with camera.eye"));
    framed.camera.has_eye = false;
    assert_true(check(&framed, why_framed));
    framed.camera.view = (sheen_View)(sheen_View_VIEW_ISO + 1);
    assert_false(check(&framed, why_framed));
    REFUSED(lights[0].u, zero, "length of light.u");
    REFUSED(lights[0].v, GOOD.lights[0].u, "span no light");
    REFUSED(camera.has_ortho_height, true, "exclude");
    /* The text suggests another up than the one that was refused. */
    sheen_Render along_y = GOOD;
    along_y.camera.eye = (sheen_Vec3){0, 5, 0};
    along_y.camera.up = (sheen_Vec3){0, 1, 0};
    char why_y[MESSAGE_TEXT_BYTES];
    assert_false(check(&along_y, why_y));
    assert_non_null(strstr(why_y, "--up 0,0,1"));
    sheen_Render ortho = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    ortho.camera.has_fov_deg = false;
    ortho.camera.has_ortho_height = true;
    ortho.camera.ortho_height = 2;
    assert_true(check(&ortho, text));
    ortho.camera.ortho_height = 0;
    assert_false(check(&ortho, text));
    /* Lengths of very different size that still make a valid rectangle and view. */
    sheen_Vec3 tiny = {0, 1e-18, 0}, huge = {1e18, 0, 0};
    ACCEPTED(lights[0].v, tiny);
    ACCEPTED(lights[0].u, huge);
}

/* The daemon supplies the missing parts of such a camera. */
static void cameras_in_part(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_Render render = GOOD;
    render.camera = (sheen_Camera){0};
    assert_true(check(&render, text));
    render.camera = (sheen_Camera){.has_up = true, .up = {0, 1, 0}};
    assert_true(check(&render, text));
    render.camera.up.y = 0;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "--up"));
    render.camera = (sheen_Camera){.has_fov_deg = true, .fov_deg = 10};
    assert_true(check(&render, text));
    render.camera.fov_deg = NAN;
    assert_false(check(&render, text));
    render.camera = (sheen_Camera){.has_ortho_height = true, .ortho_height = 10};
    assert_true(check(&render, text));
    render.camera.ortho_height = -1;
    assert_false(check(&render, text));
    render.camera = GOOD.camera;
    render.camera.has_up = render.camera.has_fov_deg = false;
    assert_true(check(&render, text));
}

static void render_kinds(void **state)
{
    (void)state;
    REFUSED(planes, 0, "planes");
    REFUSED(planes, CODEC_ALL_PLANES + 1, "planes");
    REFUSED(planes, UINT32_MAX, "planes");
    REFUSED(encoding, (sheen_Encoding)6, "encoding");
    REFUSED(lights[0].pattern.kind, (sheen_PatternKind)7, "pattern.kind");
    REFUSED(lights[0].pattern.kind, sheen_PatternKind_PATTERN_IMAGE, "image_sha256");
    REFUSED(lights[0].pattern.has_image_sha256, true, "image_sha256");
    sheen_Render png = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    png.encoding = sheen_Encoding_ENCODING_PNG;
    assert_true(check(&png, text));
    png.planes = 3;
    assert_false(check(&png, text));
    png.encoding = sheen_Encoding_ENCODING_EXR;
    assert_true(check(&png, text));
}

static void render_surfaces(void **state)
{
    (void)state;
    char why[MESSAGE_TEXT_BYTES];
    sheen_Render render = GOOD;
    render.has_surface = render.has_surface_level = true;
    for (unsigned level = 0; level <= PROTOCOL_MAX_SURFACE_LEVEL + 1; level++) {
        bool fits = level <= PROTOCOL_MAX_SURFACE_LEVEL;
        render.surface_level = level;
        render.surface = sheen_SurfaceKind_SURFACE_POLYGON;
        assert_int_equal(check(&render, why), fits);
        render.surface = sheen_SurfaceKind_SURFACE_WIREFRAME;
        assert_int_equal(check(&render, why), fits);
        render.surface = sheen_SurfaceKind_SURFACE_EXACT;
        assert_int_equal(check(&render, why), level == 0);
    }
    assert_non_null(strstr(why, "surface_level"));
    render.surface = (sheen_SurfaceKind)3;
    assert_false(check(&render, why));
    assert_non_null(strstr(why, "surface is 3"));
    render = GOOD;
    render.has_surface_level = true;
    render.surface_level = 1; /* of the exact surface, which is the default */
    assert_false(check(&render, why));
}

static void false_colour(void **state)
{
    (void)state;
    const sheen_Show mean = {.kind = sheen_ShowKind_SHOW_MEAN, .has_range = true, .range = 0.5};
    const sheen_Show normal = {.kind = sheen_ShowKind_SHOW_NORMAL};
    const sheen_Show draft = {.kind = sheen_ShowKind_SHOW_DRAFT,
                              .has_direction = true,
                              .direction = {0, 0, 1},
                              .has_range = true,
                              .range = 90};
    sheen_Show bad = mean;
    ACCEPTED(show, mean);
    ACCEPTED(show, normal);
    ACCEPTED(show, draft);
    bad.kind = (sheen_ShowKind)7;
    REFUSED(show, bad, "show.kind is 7");
    const double ranges[] = {0, -1, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        bad = mean;
        bad.range = ranges[i];
        REFUSED(show, bad, "show.range");
    }
    bad = mean;
    bad.has_direction = true;
    REFUSED(show, bad, "show.direction");
    bad = normal;
    bad.has_range = true;
    bad.range = 1;
    REFUSED(show, bad, "show.range");
    bad = draft;
    bad.range = 90.1;
    REFUSED(show, bad, "at most 90");
    bad = draft;
    bad.has_direction = false;
    REFUSED(show, bad, "show.direction");
    bad = draft;
    bad.direction.z = 0;
    REFUSED(show, bad, "0,0,0");
    bad.direction.z = NAN;
    REFUSED(show, bad, "show.direction.z");

    sheen_Render render = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    assert_int_equal(message_render_planes(&render), sheen_Plane_PLANE_COLOUR);
    render.show = mean;
    assert_int_equal(message_render_planes(&render),
                     sheen_Plane_PLANE_COLOUR | sheen_Plane_PLANE_POSITION |
                         sheen_Plane_PLANE_CURVATURE | sheen_Plane_PLANE_COVERAGE);
    render.unfiltered = true;
    assert_false(message_render_planes(&render) & sheen_Plane_PLANE_COVERAGE);
    render.unfiltered = false;
    render.aliased = true;
    assert_false(message_render_planes(&render) & sheen_Plane_PLANE_COVERAGE);
    render.aliased = false;
    render.surface = sheen_SurfaceKind_SURFACE_POLYGON;
    assert_false(message_render_planes(&render) & sheen_Plane_PLANE_COVERAGE);
    render.surface = sheen_SurfaceKind_SURFACE_EXACT;
    render.planes = sheen_Plane_PLANE_CURVATURE;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "colour"));
    render.planes = sheen_Plane_PLANE_COLOUR;
    render.has_surface = true;
    render.surface = sheen_SurfaceKind_SURFACE_POLYGON;
    assert_true(check(&render, text));
    render.surface = sheen_SurfaceKind_SURFACE_WIREFRAME;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "wireframe"));
    /* The planes from which false colour is painted count as well: 28 bytes for each pixel. */
    render.surface = sheen_SurfaceKind_SURFACE_EXACT;
    render.width_px = render.height_px = 16384;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "bytes"));
    render.show = (sheen_Show){0};
    assert_true(check(&render, text));
}

static void left_out_fields_are_not_looked_at(void **state)
{
    (void)state;
    sheen_Render render = {.width_px = 1, .height_px = 1, .planes = 1};
    char text[MESSAGE_TEXT_BYTES];
    render.camera.eye.x = NAN;
    render.lights[0].u.x = NAN;
    render.lights[0].pattern.count = NAN;
    render.miss.r = NAN;
    assert_true(check(&render, text));
}

static void render_schedules(void **state)
{
    (void)state;
    REFUSED(request_class, (sheen_RequestClass)3, "request_class is 3");
    ACCEPTED(request_class, sheen_RequestClass_CLASS_INTERACTIVE);
    sheen_Render render = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    render.has_view = render.has_request_class = true;
    render.view = UINT32_MAX;
    assert_true(check(&render, text));
    render.request_class = sheen_RequestClass_CLASS_BATCH;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "view"));
    render = GOOD;
    render.has_deadline_ms = true;
    assert_false(check(&render, text));
    assert_non_null(strstr(text, "deadline_ms (--deadline) is 0"));
    render.deadline_ms = 3600000;
    assert_true(check(&render, text));
    render.deadline_ms++;
    assert_false(check(&render, text));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(render_sizes),        cmocka_unit_test(render_jpeg_sizes),
        cmocka_unit_test(render_jpeg_options), cmocka_unit_test(render_floats),
        cmocka_unit_test(render_geometry),     cmocka_unit_test(cameras_in_part),
        cmocka_unit_test(render_kinds),        cmocka_unit_test(render_surfaces),
        cmocka_unit_test(false_colour),        cmocka_unit_test(left_out_fields_are_not_looked_at),
        cmocka_unit_test(render_schedules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
