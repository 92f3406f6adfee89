/* Defaults for what requests leave out, models' own up, and texts that must not get into a
 * message. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "server/output/metadata.h"
#include "server/scene/scene_convert.h"
#include "server/scene/defaults.h"

static const struct limit_tables TABLES = {.box_max = {4, 2, 1}};
static const struct scene_subject SUBJECT = {&TABLES, CAGE_UP_UNSAID};

static void test_defaults_are_valid(void **state)
{
    (void)state;
    sheen_Render render = sheen_Render_init_default;
    render.width_px = 640;
    render.height_px = 480;
    render.planes = sheen_Plane_PLANE_COLOUR;
    struct frame_request request;
    scene_read_request(&render, &SUBJECT, &request);
    const sheen_Pattern pattern = sheen_Pattern_init_default;
    assert_true(request.lights[0].pattern.count == pattern.count);
    assert_true(request.lights[0].pattern.duty == pattern.duty);
    assert_true(request.lights[0].pattern.foreground[0] == 1 &&
                request.lights[0].pattern.background[0] == 0);
    /* The colour `miss` differs from the dark stripes. */
    const float miss[4] = {0.16f, 0.19f, 0.23f, 1};
    assert_memory_equal(request.miss, miss, sizeof miss);

    /* If the answer's fields are sent as a request, the frame is the same. */
    render.has_camera = true;
    render.lights_count = 1;
    render.camera = scene_write_camera(&request.camera);
    render.lights[0] = scene_write_light(&request.lights[0], NULL);
    char text[MESSAGE_TEXT_BYTES] = "";
    if (!message_check_render(&render, 1000, 1000, text))
        fail_msg("%s", text);
    struct frame_request again;
    scene_read_request(&render, &SUBJECT, &again);
    assert_memory_equal(&again.camera.eye, &request.camera.eye, sizeof again.camera.eye);
    /* apart from who chose the light */
    assert_true(request.lights[0].is_chosen && !again.lights[0].is_chosen);
    again.lights[0].is_chosen = true;
    assert_memory_equal(&again.lights[0], &request.lights[0], sizeof again.lights[0]);
}

static void test_what_is_given_is_kept(void **state)
{
    (void)state;
    sheen_Render render = sheen_Render_init_default;
    render.has_camera = true;
    render.camera = (sheen_Camera){.has_eye = true,
                                   .eye = {1, 2, 3},
                                   .has_target = true,
                                   .target = {4, 5, 6},
                                   .has_up = true,
                                   .up = {0, 1, 0},
                                   .has_ortho_height = true,
                                   .ortho_height = 7};
    render.lights_count = 1;
    render.lights[0] = (sheen_Light)sheen_Light_init_default;
    render.lights[0].has_pattern = true;
    render.lights[0].pattern.kind = sheen_PatternKind_PATTERN_CIRCLES;
    render.lights[0].pattern.has_count = true;
    render.lights[0].pattern.count = 3;
    render.has_miss = true;
    render.miss = (sheen_Colour){0.25f, 0.5f, 0.75f, 1};
    struct frame_request request;
    scene_read_request(&render, &SUBJECT, &request);
    assert_int_equal(request.camera.kind, CAMERA_ORTHOGRAPHIC);
    assert_true(request.camera.ortho_height == 7 && request.camera.target[2] == 6);
    assert_true(request.camera.eye[0] == 1 && request.camera.up[1] == 1);
    assert_int_equal(request.lights[0].pattern.kind, PATTERN_CIRCLES);
    assert_true(request.lights[0].pattern.count == 3 && request.lights[0].pattern.duty == 0.5);
    assert_true(request.miss[2] == 0.75f);
    sheen_Camera back = scene_write_camera(&request.camera);
    assert_true(back.has_ortho_height && !back.has_fov_deg && back.eye.y == 2);
}

static struct camera camera_for(const sheen_Camera *asked)
{
    sheen_Render render = sheen_Render_init_default;
    render.width_px = 640;
    render.height_px = 480;
    render.has_camera = asked != NULL;
    if (asked)
        render.camera = *asked;
    struct frame_request request;
    scene_read_request(&render, &SUBJECT, &request);
    return request.camera;
}

/* Fields of a camera that a request leaves out are those of the default camera, which frames the
 * model. */
static void test_cameras_in_part(void **state)
{
    (void)state;
    const struct camera whole = camera_for(NULL);
    const sheen_Camera turned = {.has_up = true, .up = {1, 0, 0}};
    struct camera camera = camera_for(&turned), framed;
    scene_default_camera(&TABLES, (const double[]){1, 0, 0}, VIEW_AROUND, 640, 480, &framed);
    assert_memory_equal(camera.eye, framed.eye, sizeof camera.eye);
    assert_memory_equal(camera.target, framed.target, sizeof camera.target);
    assert_true(camera.up[0] == 1 && camera.fov_deg == whole.fov_deg);

    const sheen_Camera zoomed = {.has_fov_deg = true, .fov_deg = 10};
    camera = camera_for(&zoomed);
    assert_true(camera.fov_deg == 10 && camera.kind == CAMERA_PERSPECTIVE);
    assert_memory_equal(camera.eye, whole.eye, sizeof camera.eye);
    assert_memory_equal(camera.up, whole.up, sizeof camera.up);

    const sheen_Camera placed = {.has_eye = true, .eye = {9, 9, 9}, .has_target = true};
    camera = camera_for(&placed);
    assert_true(camera.eye[1] == 9 && camera.target[1] == 0);
    assert_memory_equal(camera.up, whole.up, sizeof camera.up);

    /* An orthographic camera looks in the same direction, with the whole box in front of it. */
    const sheen_Camera flat = {.has_ortho_height = true, .ortho_height = 3};
    camera = camera_for(&flat);
    assert_int_equal(camera.kind, CAMERA_ORTHOGRAPHIC);
    assert_true(camera.ortho_height == 3);
    double forward[3], before[3], scale = 0;
    for (int i = 0; i < 3; i++) {
        forward[i] = camera.target[i] - camera.eye[i];
        before[i] = whole.target[i] - whole.eye[i];
        scale = fmax(scale, forward[i] / before[i]);
    }
    assert_true(scale > 1);
    for (int i = 0; i < 3; i++)
        assert_true(fabs(forward[i] - scale * before[i]) < 1e-12);
    for (int corner = 0; corner < 8; corner++) {
        double depth = 0;
        for (int i = 0; i < 3; i++)
            depth += forward[i] *
                     ((corner >> i & 1 ? TABLES.box_max : TABLES.box_min)[i] - camera.eye[i]);
        assert_true(depth > 0);
    }
}

/* A number in [-1, 1). */
static double noise(uint64_t *state)
{
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) * 0x1p-52 - 1;
}

static sheen_Vec3 noise_vec3(uint64_t *state, double size)
{
    return (sheen_Vec3){size * noise(state), size * noise(state), size * noise(state)};
}

/* One light of each kind, and one without a kind. */
enum { UNPLACED = 5 };

static void light_every_kind(sheen_Render *render)
{
    render->lights_count = UNPLACED;
    for (int i = 0; i < UNPLACED; i++) {
        render->lights[i] = (sheen_Light)sheen_Light_init_default;
        render->lights[i].has_kind = i < UNPLACED - 1;
        render->lights[i].kind = (sheen_LightKind)(i % (UNPLACED - 1));
    }
}

/* A light without a place of its own does not depend on the camera: not on eye, target, field of
 * view, orthographic height, or size. */
static void test_lights_stay(void **state)
{
    (void)state;
    uint64_t random = 3;
    struct frame_request first, other;
    sheen_Render render = sheen_Render_init_default;
    render.width_px = 640;
    render.height_px = 480;
    light_every_kind(&render);
    scene_read_request(&render, &SUBJECT, &first);
    assert_int_equal(first.lights[UNPLACED - 1].kind, LIGHT_TUNNEL);
    for (int i = 0; i < 50; i++) {
        render.width_px = 1 + (uint32_t)(2000 * fabs(noise(&random)));
        render.height_px = 1 + (uint32_t)(2000 * fabs(noise(&random)));
        render.has_camera = true;
        render.camera = (sheen_Camera)sheen_Camera_init_default;
        render.camera.has_eye = render.camera.has_target = i % 3 > 0;
        render.camera.eye = noise_vec3(&random, 9);
        render.camera.target = noise_vec3(&random, 9);
        render.camera.has_ortho_height = i % 5 == 0;
        render.camera.ortho_height = 2 + noise(&random);
        render.camera.has_fov_deg = !render.camera.has_ortho_height;
        render.camera.fov_deg = 90 + 89 * noise(&random);
        scene_read_request(&render, &SUBJECT, &other);
        for (int k = 0; k < UNPLACED; k++)
            assert_memory_equal(&other.lights[k], &first.lights[k], sizeof first.lights[k]);
    }
    render.camera.has_up = true;
    render.camera.up = (sheen_Vec3){1, 0, 0};
    scene_read_request(&render, &SUBJECT, &other);
    for (int k = 0; k < UNPLACED; k++)
        assert_memory_not_equal(other.lights[k].u, first.lights[k].u, sizeof first.lights[k].u);
}

/* Up is taken from the request, else from the file, else from the shape of the box. A camera that
 * looks along up has the back of the model at the picture's top from above, and the front from
 * below. */
static void test_up(void **state)
{
    (void)state;
    struct frame_request request;
    struct scene_subject subject = SUBJECT;
    sheen_Render render = sheen_Render_init_default;
    double up[3];
    render.width_px = render.height_px = 100;
    assert_int_equal(scene_model_up(&render, &subject, up), sheen_UpSource_UP_GUESSED);
    assert_true(up[0] == 0 && up[1] == 0 && up[2] == 1);
    for (enum cage_up axis = CAGE_UP_X; axis <= CAGE_UP_Z; axis++) {
        subject.up = axis;
        assert_int_equal(scene_model_up(&render, &subject, up), sheen_UpSource_UP_FILE);
        for (int i = 0; i < 3; i++)
            assert_true(up[i] == ((int)axis - CAGE_UP_X == i));
        scene_read_request(&render, &subject, &request);
        assert_memory_equal(request.camera.up, up, sizeof up);
    }
    render.has_camera = true;
    render.camera = (sheen_Camera){.has_eye = true, .eye = {2, 1, 9}, .has_target = true};
    render.camera.target = (sheen_Vec3){2, 1, 0};
    scene_read_request(&render, &subject, &request);
    assert_true(request.camera.up[1] == 1 && request.camera.up[2] == 0);
    render.camera.eye.z = -9;
    scene_read_request(&render, &subject, &request);
    assert_true(request.camera.up[1] == -1 && request.camera.up[2] == 0);
    render.camera.has_up = true;
    render.camera.up = (sheen_Vec3){0, 3, 0};
    assert_int_equal(scene_model_up(&render, &subject, up), sheen_UpSource_UP_GIVEN);
    scene_read_request(&render, &subject, &request);
    assert_true(request.camera.up[1] == 3);
}

/* The axes of zebra and environment are up for every camera, unless the request gives a
 * direction. */
static void test_axes(void **state)
{
    (void)state;
    struct lines lines;
    const double up[3] = {0, 2, 0};
    for (int family = 0; family <= sheen_LineFamily_LINES_ENVIRONMENT; family++) {
        sheen_Lines asked = {.family = (sheen_LineFamily)family};
        scene_read_lines(&asked, up, &lines);
        assert_true(lines.has_direction == (family >= sheen_LineFamily_LINES_ZEBRA));
        assert_true(lines.direction[1] == (lines.has_direction ? 2 : 0));
        asked.has_direction = family >= sheen_LineFamily_LINES_ISOPHOTE;
        asked.direction = (sheen_Vec3){1, 0, 0};
        scene_read_lines(&asked, up, &lines);
        assert_true(!lines.has_direction || (lines.direction[0] == 1 && lines.direction[1] == 0));
    }
}

static void test_metadata_hold_every_digit(void **state)
{
    (void)state;
    struct frame_request request = {0};
    request.camera.eye[0] = 0.1;
    request.camera.fov_deg = 1.0 / 3;
    for (int i = 0; i < 3; i++)
        request.lights[0].u[i] = -1.7976931348623157e308; /* the longest numbers fit */
    request.lights[0].pattern.kind = PATTERN_IMAGE;
    const struct renderer_info info = {.device = "a device", .driver = "4.5", .software = true};
    struct metadata metadata;
    sheen_Render asked = sheen_Render_init_default;
    asked.lights_count = request.n_lights = 1;
    asked.lights[0].pattern.has_image_sha256 = true;
    asked.lights[0].pattern.image_sha256[0] = 0xab;
    metadata_init(&metadata, &request, &asked, &info);
    const char *all = "";
    for (int i = 0; i < METADATA_ATTRIBUTES; i++) {
        const struct image_attribute *attribute = &metadata.attributes[i];
        assert_ptr_equal(strstr(attribute->name, "sheen:"), attribute->name);
        assert_true(strlen(attribute->value) < METADATA_VALUE_BYTES - 1);
        if (strcmp(attribute->name, "sheen:camera") == 0)
            all = attribute->value;
    }
    assert_non_null(strstr(all, "eye=0.10000000000000001,0,0"));
    assert_non_null(strstr(all, "fov_deg=0.33333333333333331"));
    assert_non_null(strstr(metadata.values[7], "u=-1.7976931348623157e+308,"));
    assert_non_null(strstr(metadata.values[7], "image=ab00"));
}

static void test_texts(void **state)
{
    (void)state;
    char good[] = "Kotfl\xc3\xbcgel", cut[] = "Kotfl\xc3", lines[] = "a\nb\x1b[2J";
    message_make_text(good, false);
    assert_string_equal(good, "Kotfl\xc3\xbcgel");
    message_make_text(cut, false);
    assert_string_equal(cut, "Kotfl?");
    message_make_text(lines, true);
    assert_string_equal(lines, "a\nb?[2J");
    message_make_text(lines, false);
    assert_string_equal(lines, "a?b?[2J");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_defaults_are_valid),
        cmocka_unit_test(test_what_is_given_is_kept),
        cmocka_unit_test(test_cameras_in_part),
        cmocka_unit_test(test_lights_stay),
        cmocka_unit_test(test_up),
        cmocka_unit_test(test_axes),
        cmocka_unit_test(test_metadata_hold_every_digit),
        cmocka_unit_test(test_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
