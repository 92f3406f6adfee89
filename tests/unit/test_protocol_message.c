/* Bodies of messages: bounds, and the checks the schema cannot make. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "protocol/codec.h"
#include "protocol/limits.h"
#include "protocol/message.h"

static const sheen_Render GOOD = {
    .width_px = 640,
    .height_px = 480,
    .has_camera = true,
    .camera = {.has_eye = true,
               .eye = {3, -4, 2},
               .has_target = true,
               .has_up = true,
               .up = {0, 0, 1},
               .has_fov_deg = true,
               .fov_deg = 35},
    .lights_count = 1,
    .lights = {{.has_centre = true,
                .centre = {0, 0, 4},
                .has_u = true,
                .u = {4, 0, 0},
                .has_v = true,
                .v = {0, 4, 0},
                .has_pattern = true,
                .pattern = {.kind = sheen_PatternKind_PATTERN_STRIPES,
                            .has_count = true,
                            .count = 20,
                            .has_duty = true,
                            .duty = 0.5,
                            .has_foreground = true,
                            .foreground = {1, 1, 1, 1},
                            .has_background = true,
                            .background = {0, 0, 0, 1}}}},
    .has_miss = true,
    .has_empty = true,
    .planes = sheen_Plane_PLANE_COLOUR,
    .encoding = sheen_Encoding_ENCODING_ZSTD,
};

static bool check(const sheen_Render *render, char *text)
{
    return message_check_render(render, 16384, 16384, text);
}

/* The request GOOD with one field changed is refused with a text that names the field. */
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
    /* A device without a limit of its own is held by the protocol's. */
    sheen_Render render = GOOD;
    char text[MESSAGE_TEXT_BYTES];
    render.width_px = render.height_px = 100000;
    assert_false(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
    render.width_px = render.height_px = 65536;
    assert_false(message_check_render(&render, UINT32_MAX, UINT32_MAX, text));
    assert_non_null(strstr(text, "4294967296 bytes"));
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
    ACCEPTED(camera.fov_deg, 179.9);
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
    REFUSED(camera.has_eye, false, "come together");
    REFUSED(camera.has_target, false, "come together");
    REFUSED(lights[0].u, zero, "span no light");
    REFUSED(lights[0].v, GOOD.lights[0].u, "span no light");
    REFUSED(camera.has_ortho_height, true, "exclude");
    /* Another up is suggested than the one that does not do. */
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
    /* Far apart in size, yet a proper rectangle and view. */
    sheen_Vec3 tiny = {0, 1e-200, 0}, huge = {1e30, 0, 0};
    ACCEPTED(lights[0].v, tiny);
    ACCEPTED(lights[0].u, huge);
}

/* The rest of such a camera is the daemon's. */
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
    /* The planes that it is painted from count, too: 28 bytes a pixel. */
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

static void text_is_utf8_without_controls(void **state)
{
    (void)state;
    static const char *const good[] = {"",
                                       "hood.obj",
                                       "Kotfl\xc3\xbcgel",
                                       "\xe2\x82\xac",
                                       "\xf0\x9f\x98\x80",
                                       "\xf4\x8f\xbf\xbf",
                                       "\xc2\xa0"};
    static const char *const bad[] = {"a\nb",
                                      "\x1b[2J",
                                      "\x7f",
                                      "\x80",
                                      "\xc3",
                                      "\xc0\x80", /* overlong */
                                      "\xc1\xbf",
                                      "\xe0\x9f\xbf",     /* overlong */
                                      "\xed\xa0\x80",     /* surrogate */
                                      "\xf0\x80\x80\x80", /* overlong */
                                      "\xf4\x90\x80\x80", /* over U+10FFFF */
                                      "\xf8\x88\x80\x80\x80",
                                      "\xff",
                                      "\xe2\x82",
                                      "\xe2(\xa1",
                                      "\xc2\x9b" /* C1: a terminal's control sequence */};
    for (size_t i = 0; i < sizeof(good) / sizeof(*good); i++)
        assert_true(message_is_text(good[i], false));
    for (size_t i = 0; i < sizeof(bad) / sizeof(*bad); i++)
        assert_false(message_is_text(bad[i], false));
    assert_true(message_is_text("one\ntwo\n", true));
    assert_false(message_is_text("one\rtwo", true));
}

static void uploads_are_checked(void **state)
{
    (void)state;
    const sheen_UploadBegin good = {.size_bytes = 1, .name = "a.obj"};
    char text[MESSAGE_TEXT_BYTES];
    assert_true(message_check_upload_begin(&good, text));
    sheen_UploadBegin bad = good;
    bad.size_bytes = 0;
    assert_false(message_check_upload_begin(&bad, text));
    bad.size_bytes = PROTOCOL_MAX_UPLOAD_BYTES;
    assert_true(message_check_upload_begin(&bad, text));
    bad.size_bytes++;
    assert_false(message_check_upload_begin(&bad, text));
    assert_non_null(strstr(text, "size_bytes"));
    bad = good;
    strcpy(bad.name, "a\x1b.obj");
    assert_false(message_check_upload_begin(&bad, text));
    assert_non_null(strstr(text, "name"));
    bad = good;
    bad.kind = (sheen_UploadKind)2;
    assert_false(message_check_upload_begin(&bad, text));
    const sheen_Hello hello = {.client = "\xff"};
    assert_false(message_check_hello(&hello, text));
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
    render.deadline_ms = PROTOCOL_MAX_DEADLINE_MS;
    assert_true(check(&render, text));
    render.deadline_ms++;
    assert_false(check(&render, text));
}

static void credits_and_replacements_are_checked(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_HelloOk ok = {.credits = PROTOCOL_MAX_CREDITS};
    assert_true(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    ok.credits++;
    assert_false(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    assert_non_null(strstr(text, "credits is 65"));
    ok.credits = 0;
    assert_false(message_check_answer(MESSAGE_HELLO_OK, &ok, text));
    sheen_Superseded superseded = {.by = 7};
    assert_true(message_check_answer(MESSAGE_SUPERSEDED, &superseded, text));
    superseded.by = 0;
    assert_false(message_check_answer(MESSAGE_SUPERSEDED, &superseded, text));
    assert_false(message_check_answer(MESSAGE_CANCEL, NULL, text)); /* no server sends it */

    /* What a server of minor version 0 leaves out. */
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length;
    ok = (sheen_HelloOk){.server = "0"};
    assert_true(message_encode(MESSAGE_HELLO_OK, 1, &ok, buffer, sizeof(buffer), &length));
    assert_true(message_decode(MESSAGE_HELLO_OK, buffer + MESSAGE_HEADER_BYTES,
                               length - MESSAGE_HEADER_BYTES, &ok));
    assert_int_equal(ok.credits, PROTOCOL_MAX_IN_FLIGHT);
}

static void answers_are_checked(void **state)
{
    (void)state;
    char text[MESSAGE_TEXT_BYTES];
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_MODEL, .text = "a.obj: line 3"};
    assert_true(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_NONE;
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_GPU_LOST;
    assert_true(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = (sheen_ErrorCode)14;
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    error.code = sheen_ErrorCode_ERROR_MODEL;
    strcpy(error.text, "a\x1b[2J");
    assert_false(message_check_answer(MESSAGE_ERROR, &error, text));
    static sheen_ModelInfo info;
    strcpy(info.warnings, "one\ntwo");
    assert_true(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    info.box_max.z = NAN;
    assert_false(message_check_answer(MESSAGE_MODEL_INFO, &info, text));
    assert_non_null(strstr(text, "box_max.z"));
    sheen_Frame frame = {.width_px = 2,
                         .height_px = 2,
                         .planes = 1,
                         .data_bytes = 16,
                         .camera = GOOD.camera,
                         .lights_count = 1,
                         .lights = {GOOD.lights[0]}};
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.has_show_range = true;
    frame.show_range = 0.25;
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.show_range = NAN;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "show_range"));
    frame.has_show_range = false;
    frame.has_miss = frame.has_base = true;
    assert_true(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.base.a = 2;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "base.a"));
    frame.base.a = 1;
    frame.camera.has_up = false; /* a request may leave it out, an answer may not */
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_non_null(strstr(text, "camera"));
    frame.camera = GOOD.camera;
    frame.camera.has_fov_deg = false;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.camera = GOOD.camera;
    frame.data_bytes = 0;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.data_bytes = UINT64_MAX;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    frame.data_bytes = 16;
    frame.width_px = UINT32_MAX;
    assert_false(message_check_answer(MESSAGE_FRAME, &frame, text));
    assert_false(message_check_answer(MESSAGE_RENDER, &GOOD, text));
}

static void encoding_stays_within_its_buffer(void **state)
{
    (void)state;
    uint8_t whole[MESSAGE_BUFFER_BYTES], small[MESSAGE_BUFFER_BYTES];
    size_t length = 0, other = 0;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, whole, sizeof(whole), &length));
    for (size_t capacity = 0; capacity < length; capacity++) {
        memset(small, 0xaa, sizeof(small));
        assert_false(message_encode(MESSAGE_RENDER, 9, &GOOD, small, capacity, &other));
        for (size_t i = capacity; i < length; i++)
            assert_int_equal(small[i], 0xaa);
    }
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, small, length, &other));
    assert_memory_equal(small, whole, length);
    assert_false(message_encode(MESSAGE_DATA, 9, &GOOD, whole, sizeof(whole), &length));
    assert_false(message_encode(200, 9, &GOOD, whole, sizeof(whole), &length));
    sheen_Error error = {.code = sheen_ErrorCode_ERROR_MODEL};
    memset(error.text, 'x', sizeof(error.text)); /* a text without its end */
    assert_false(message_encode(MESSAGE_ERROR, 9, &error, whole, sizeof(whole), &length));
}

static void the_largest_messages_fit(void **state)
{
    (void)state;
    static sheen_ModelInfo info;
    uint8_t buffer[MESSAGE_BUFFER_BYTES];
    size_t length = 0;
    memset(info.warnings, 'w', sizeof(info.warnings) - 1);
    memset(info.name, 'n', sizeof(info.name) - 1);
    info.extraordinary_count = 64;
    for (int i = 0; i < 64; i++)
        info.extraordinary[i] = (sheen_ValenceCount){UINT32_MAX, UINT32_MAX};
    assert_true(message_encode(MESSAGE_MODEL_INFO, 1, &info, buffer, sizeof(buffer), &length));
    static sheen_ModelInfo decoded;
    assert_true(message_decode(MESSAGE_MODEL_INFO, buffer + 16, length - 16, &decoded));
    assert_memory_equal(decoded.warnings, info.warnings, sizeof(info.warnings));
}

static void malformed_bodies_are_refused(void **state)
{
    (void)state;
    uint8_t buffer[MESSAGE_BUFFER_BYTES], id[32];
    size_t length = 0;
    sheen_Render render;
    sheen_Hello hello = {.client = "c"};
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, buffer, sizeof(buffer), &length));
    for (size_t n = 0; n + 1 < length - 16; n++)
        assert_false(message_decode(MESSAGE_RENDER, buffer + 16, n, &render));
    /* A string longer than its bound. */
    uint8_t progress[64] = {0x0a, 40};
    memset(progress + 2, 's', 40);
    memcpy(progress + 42, "\x10\x01\x18\x02", 4);
    sheen_Progress body;
    assert_false(message_decode(MESSAGE_PROGRESS, progress, 46, &body));
    progress[1] = 31;
    memcpy(progress + 33, "\x10\x01\x18\x02", 4);
    assert_true(message_decode(MESSAGE_PROGRESS, progress, 37, &body));
    /* An id of another length than 32. */
    assert_false(message_decode(MESSAGE_MODEL_QUERY, (const uint8_t *)"\x0a\x02xy", 4, &render));
    assert_true(message_hello_encode(1, id, &hello, buffer, sizeof(buffer), &length));
    for (size_t n = 0; n < length - 16; n++)
        assert_false(message_hello_decode(buffer + 16, n, id, &hello));
}

#define NOT_WELL_FORMED "it is not well-formed"

/* What is wrong with the request GOOD when `n` bytes of fields follow it. */
static const char *fault_with(const void *fields, size_t n)
{
    static uint8_t buffer[2 * MESSAGE_BUFFER_BYTES];
    static char text[MESSAGE_TEXT_BYTES];
    sheen_Render render;
    size_t length = 0;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, buffer, MESSAGE_BUFFER_BYTES, &length));
    memcpy(buffer + length, fields, n);
    length += n - MESSAGE_HEADER_BYTES;
    assert_false(message_decode(MESSAGE_RENDER, buffer + MESSAGE_HEADER_BYTES, length, &render));
    message_find_fault(MESSAGE_RENDER, buffer + MESSAGE_HEADER_BYTES, length, text);
    return text;
}

static const char *fault_of(uint8_t type, const void *body, size_t n)
{
    static char text[MESSAGE_TEXT_BYTES];
    message_find_fault(type, body, n, text);
    return text;
}

/* limits.h: going over a limit names it. */
static void faults_are_named(void **state)
{
    (void)state;
    uint8_t lights[2 * 8], bytes[400] = {0};
    for (int i = 0; i < 16; i++)
        lights[i] = i % 2 ? 0 : 0x2a; /* a light with nothing in it */
    assert_string_equal(fault_with(lights, 16), "lights has 9 entries; it may have at most 8");
    /* A light, its pattern, which is lines, and 17 places, packed and one by one. */
    memcpy(bytes, "\x2a\x90\x01\x32\x8d\x01\x08\x04\x62\x88\x01", 11);
    assert_string_equal(fault_with(bytes, 11 + 17 * 8),
                        "lights.pattern.at has 17 entries; it may have at most 16");
    memcpy(bytes, "\x2a\x9e\x01\x32\x9b\x01\x08\x04", 8);
    for (int i = 0; i < 17; i++)
        bytes[8 + 9 * i] = 0x61;
    assert_string_equal(fault_with(bytes, 8 + 17 * 9),
                        "lights.pattern.at has 17 entries; it may have at most 16");
    assert_string_equal(fault_with("\x2a\x02\x32\x00", 4), "lights.pattern.kind is missing");
    assert_string_equal(fault_with("\x10\x80\x80\x80\x80\x10", 6),
                        "width_px is 4294967296; it must be at most 4294967295");
    assert_string_equal(fault_with("\x22\xff", 2), NOT_WELL_FORMED);
    assert_string_equal(fault_of(MESSAGE_RENDER, "", 0), "model_sha256 is missing");
    assert_string_equal(fault_of(MESSAGE_MODEL_QUERY, "\x0a\x02xy", 4),
                        "sha256 has 2 bytes; it must have 32");
    memset(bytes, 'n', sizeof(bytes));
    memcpy(bytes, "\x22\x80\x02", 3);
    assert_string_equal(fault_of(MESSAGE_UPLOAD_BEGIN, bytes, 3 + 256),
                        "name has 256 bytes; it may have at most 255");
    memcpy(bytes + MODEL_ID_BYTES, "\x08\x00\x12\x40", 4);
    assert_string_equal(fault_of(MESSAGE_HELLO, bytes, MODEL_ID_BYTES + 4 + 64),
                        "client has 64 bytes; it may have at most 63");
    assert_string_equal(fault_of(MESSAGE_HELLO, bytes, 31), NOT_WELL_FORMED);
    assert_string_equal(fault_of(MESSAGE_STATS_QUERY, bytes, 4), NOT_WELL_FORMED);
}

/* Changes bytes of a request at random: what can be read has no fault, whatever else is said. */
static void faults_are_found_only_where_they_are(void **state)
{
    (void)state;
    uint8_t good[MESSAGE_BUFFER_BYTES], bytes[MESSAGE_BUFFER_BYTES];
    size_t length = 0, n_named = 0;
    uint32_t noise = 1;
    assert_true(message_encode(MESSAGE_RENDER, 9, &GOOD, good, sizeof(good), &length));
    length -= MESSAGE_HEADER_BYTES;
    for (int i = 0; i < 50000; i++) {
        memcpy(bytes, good + MESSAGE_HEADER_BYTES, length);
        for (int k = 0; k < 1 + i % 4; k++) {
            noise = noise * 1664525 + 1013904223;
            bytes[(noise >> 8) % length] = (uint8_t)(noise >> 24);
        }
        sheen_Render render;
        bool reads = message_decode(MESSAGE_RENDER, bytes, length, &render);
        bool named = strcmp(fault_of(MESSAGE_RENDER, bytes, length), NOT_WELL_FORMED) != 0;
        assert_false(reads && named);
        n_named += named;
    }
    assert_true(n_named > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(render_sizes),
        cmocka_unit_test(render_floats),
        cmocka_unit_test(render_geometry),
        cmocka_unit_test(cameras_in_part),
        cmocka_unit_test(render_kinds),
        cmocka_unit_test(render_surfaces),
        cmocka_unit_test(false_colour),
        cmocka_unit_test(left_out_fields_are_not_looked_at),
        cmocka_unit_test(text_is_utf8_without_controls),
        cmocka_unit_test(uploads_are_checked),
        cmocka_unit_test(render_schedules),
        cmocka_unit_test(credits_and_replacements_are_checked),
        cmocka_unit_test(answers_are_checked),
        cmocka_unit_test(encoding_stays_within_its_buffer),
        cmocka_unit_test(the_largest_messages_fit),
        cmocka_unit_test(malformed_bodies_are_refused),
        cmocka_unit_test(faults_are_named),
        cmocka_unit_test(faults_are_found_only_where_they_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
