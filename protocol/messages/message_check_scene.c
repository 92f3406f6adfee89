/* The checks of message.h, of camera, lights and lines. */
#include <stdio.h>

#include "protocol/messages/message_check.h"
#include "protocol/ranges.h"

static bool is_zero(const sheen_Vec3 *v)
{
    const double value[3] = {v->x, v->y, v->z};
    return range_is_zero(value);
}

static bool is_parallel(const sheen_Vec3 *a, const sheen_Vec3 *b)
{
    const double p[3] = {a->x, a->y, a->z}, q[3] = {b->x, b->y, b->z};
    return range_is_parallel(p, q);
}

/* Checks eye, target and up, as far as they are present. */
static bool check_view(const sheen_Camera *camera, char *text)
{
    if ((camera->has_eye && !check_vec3(&camera->eye, "camera.eye", text)) ||
        (camera->has_target && !check_vec3(&camera->target, "camera.target", text)) ||
        (camera->has_up && !check_vec3(&camera->up, "camera.up", text)))
        return false;
    if (camera->has_eye && !camera->has_target)
        return check_refuse(text, "camera.eye comes with camera.target");
    if (camera->has_eye && camera->has_view && camera->view != sheen_View_VIEW_AROUND)
        return check_refuse(
            text, "camera.view is of a camera that frames the model: not with camera.eye");
    const sheen_Vec3 view = {camera->target.x - camera->eye.x, camera->target.y - camera->eye.y,
                             camera->target.z - camera->eye.z};
    if (camera->has_eye && is_zero(&view))
        return check_refuse(text,
                            "camera.eye and camera.target (--eye, --target) are the same point");
    static const sheen_Vec3 y_axis = {0, 1, 0};
    if (camera->has_up &&
        (is_zero(&camera->up) || (camera->has_eye && is_parallel(&view, &camera->up))))
        return check_refuse(
            text,
            "camera.up (--up) is zero or along the line of sight: give another, as --up "
            "%s",
            is_parallel(&view, &y_axis) ? "0,0,1" : "0,1,0");
    return true;
}

bool check_camera(const sheen_Camera *camera, char *text)
{
    if (!check_view(camera, text))
        return false;
    if (camera->has_fov_deg && camera->has_ortho_height)
        return check_refuse(text, "camera.fov_deg and camera.ortho_height exclude each other");
    return (!camera->has_ortho_height ||
            check_number(camera->ortho_height, RANGE_ORTHO_HEIGHT, text)) &&
           (!camera->has_fov_deg || check_number(camera->fov_deg, RANGE_FOV, text)) &&
           check_enum(camera->view, sheen_View_VIEW_ISO, "camera.view", text) &&
           (!camera->has_zoom || check_number(camera->zoom, RANGE_ZOOM, text)) &&
           (!camera->has_zoom_x || check_number(camera->zoom_x, RANGE_ZOOM_AT, text)) &&
           (!camera->has_zoom_y || check_number(camera->zoom_y, RANGE_ZOOM_AT, text));
}

/* A FRAME must have all of the camera that was used. */
static bool check_whole_camera(const sheen_Camera *camera, char *text)
{
    if (!camera->has_eye || !camera->has_target || !camera->has_up ||
        (!camera->has_fov_deg && !camera->has_ortho_height))
        return check_refuse(text, "camera lacks a field; a frame has them all");
    return check_camera(camera, text);
}

static bool check_period(const sheen_Pattern *pattern, char *text)
{
    const struct {
        bool is_there;
        double value;
        enum range_name range;
    } numbers[] = {
        {pattern->has_count, pattern->count, RANGE_PATTERN_COUNT},
        {pattern->has_period, pattern->period, RANGE_PATTERN_PERIOD},
        {pattern->has_duty, pattern->duty, RANGE_PATTERN_DUTY},
        {pattern->has_rotation_deg, pattern->rotation_deg, RANGE_PATTERN_ROTATION},
        {pattern->has_offset, pattern->offset, RANGE_PATTERN_OFFSET},
        {pattern->has_soft, pattern->soft, RANGE_PATTERN_SOFT},
        {pattern->has_opacity, pattern->opacity, RANGE_PATTERN_OPACITY},
        {pattern->has_width, pattern->width, RANGE_PATTERN_WIDTH},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i].is_there && !check_number(numbers[i].value, numbers[i].range, text))
            return false;
    return true;
}

static bool check_single_lines(const sheen_Pattern *pattern, char *text)
{
    bool is_lines = pattern->kind == sheen_PatternKind_PATTERN_LINES;
    if (is_lines != (pattern->at_count > 0))
        return check_refuse(text,
                            "pattern.at: the places of 1 to 16 lines belong to a lines pattern and "
                            "to no other");
    for (size_t i = 0; i < pattern->at_count; i++)
        if (!check_number(pattern->at[i], RANGE_PATTERN_AT, text))
            return false;
    return true;
}

static bool check_pattern(const sheen_Pattern *pattern, char *text)
{
    if (!check_enum(pattern->kind, sheen_PatternKind_PATTERN_DISTANCE, "pattern.kind", text) ||
        !check_period(pattern, text) || !check_single_lines(pattern, text))
        return false;
    if (pattern->has_foreground && !check_colour(&pattern->foreground, "pattern.foreground", text))
        return false;
    if (pattern->has_background && !check_colour(&pattern->background, "pattern.background", text))
        return false;
    if (pattern->has_image_sha256 != (pattern->kind == sheen_PatternKind_PATTERN_IMAGE))
        return check_refuse(text,
                            "pattern.image_sha256 belongs to an image pattern and to no other");
    return true;
}

static bool check_edge(const sheen_Vec3 *edge, const char *field, char *text)
{
    const double value[3] = {edge->x, edge->y, edge->z};
    char name[64];
    snprintf(name, sizeof name, "the length of %s", field);
    return check_vec3(edge, field, text) &&
           check_named(range_length(value), &RANGES[RANGE_LIGHT_SIDE], name, text);
}

static bool check_light(const sheen_Light *light, char *text)
{
    if (!check_enum(light->kind, sheen_LightKind_LIGHT_SPHERE, "light.kind", text) ||
        (light->has_pattern && !check_pattern(&light->pattern, text)))
        return false;
    bool is_tunnel = !light->has_kind && !light->has_centre; /* then the server chooses a tunnel */
    bool has_sides = !is_tunnel && (light->kind == sheen_LightKind_LIGHT_RECTANGLE ||
                                    light->kind == sheen_LightKind_LIGHT_PLANE);
    if (light->one_sided && !has_sides)
        return check_refuse(
            text, "light.one_sided is for rectangles and planes; a tunnel and a sphere are "
                  "seen from inside");
    if (light->has_centre != light->has_u || light->has_u != light->has_v)
        return check_refuse(text, "light.centre, light.u and light.v come together");
    if (!light->has_centre)
        return true;
    if (!check_vec3(&light->centre, "light.centre", text) ||
        !check_edge(&light->u, "light.u", text) || !check_edge(&light->v, "light.v", text))
        return false;
    return !is_parallel(&light->u, &light->v) ||
           check_refuse(text, "light.u and light.v (--light-u, --light-v) span no light: they are "
                              "parallel");
}

bool check_direction(const sheen_Vec3 *v, const char *field, char *text)
{
    if (!check_vec3(v, field, text))
        return false;
    return !is_zero(v) || check_refuse(text, "%s is 0,0,0, no direction", field);
}

/* Checks the fields of line families. */
static bool check_lines(const sheen_Lines *lines, char *text)
{
    if (!check_enum(lines->family, sheen_LineFamily_LINES_ENVIRONMENT, "lines.family", text))
        return false;
    bool takes_direction = lines->family == sheen_LineFamily_LINES_ISOPHOTE ||
                           lines->family == sheen_LineFamily_LINES_ZEBRA ||
                           lines->family == sheen_LineFamily_LINES_ENVIRONMENT;
    if (lines->has_direction && !takes_direction)
        return check_refuse(text, "lines.direction belongs to isophote, zebra and environment");
    if (lines->has_eye && lines->has_eye_direction)
        return check_refuse(text, "lines.eye and lines.eye_direction exclude each other");
    return (!lines->has_direction || check_direction(&lines->direction, "lines.direction", text)) &&
           (!lines->has_eye || check_vec3(&lines->eye, "lines.eye", text)) &&
           (!lines->has_eye_direction ||
            check_direction(&lines->eye_direction, "lines.eye_direction", text));
}

/* Bands of distance need a light that is not at infinity, because only then a ray has a length. */
static bool check_distances(const sheen_Lines *lines, const sheen_Light *light, char *text)
{
    if (!light->has_pattern || light->pattern.kind != sheen_PatternKind_PATTERN_DISTANCE)
        return true;
    bool near = lines->family == sheen_LineFamily_LINES_REFLECTION ||
                lines->family == sheen_LineFamily_LINES_HIGHLIGHT;
    return (near && light->kind != sheen_LightKind_LIGHT_SPHERE) ||
           check_refuse(
               text, "pattern distance needs a light that is not at infinity: rectangle, plane or "
                     "tunnel, with reflection or highlight lines");
}

bool check_lights(const sheen_Lines *lines, const sheen_Light *lights, size_t n, char *text)
{
    if (!check_lines(lines, text))
        return false;
    for (size_t i = 0; i < n; i++)
        if (!check_light(&lights[i], text) || !check_distances(lines, &lights[i], text))
            return false;
    return true;
}

bool check_whole_scene(const sheen_Camera *camera, const sheen_Lines *lines,
                       const sheen_Light *lights, size_t n, char *text)
{
    if (n == 0)
        return check_refuse(text, "an answer has a light");
    for (size_t i = 0; i < n; i++)
        if (!lights[i].has_centre || !lights[i].has_pattern)
            return check_refuse(text, "a light lacks a field; an answer has them all");
    return check_whole_camera(camera, text) && check_lights(lines, lights, n, text);
}
