#include "server/scene/request_check.h"

#include <math.h>

#include "protocol/ranges.h"
#include "server/surface/vec.h"

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

static bool check_number(double value, enum range_name name, const char *what, struct error *error)
{
    char wanted[RANGE_TEXT_BYTES];
    return range_holds(&RANGES[name], value) ||
           error_set(error, ERROR_REQUEST, "%s is %.9g; it must be %s", what, value,
                     range_text(&RANGES[name], wanted));
}

static bool check_point(const double v[3], const char *what, struct error *error)
{
    for (int i = 0; i < 3; i++)
        if (!check_number(v[i], RANGE_COORDINATE, what, error))
            return false;
    return true;
}

static bool check_direction(const double v[3], const char *what, struct error *error)
{
    return check_point(v, what, error) &&
           (!range_is_zero(v) ||
            error_set(error, ERROR_REQUEST, "%s is 0,0,0, no direction", what));
}

static bool check_window(const struct frame_request *request, struct error *error)
{
    const struct camera_window *window = &request->camera.window;
    return (window->width_px == 0 && window->height_px == 0) ||
           (check_number(window->x, RANGE_WINDOW_AT, "window: x", error) &&
            check_number(window->y, RANGE_WINDOW_AT, "window: y", error) &&
            check_number(window->width_px, RANGE_WINDOW_SIDE, "window: width", error) &&
            check_number(window->height_px, RANGE_WINDOW_SIDE, "window: height", error) &&
            ((floor(window->x) + request->width_px <= window->width_px &&
              floor(window->y) + request->height_px <= window->height_px) ||
             error_set(error, ERROR_REQUEST,
                       "window: %ux%u pixels at %.9g,%.9g are not inside of a picture of %ux%u",
                       request->width_px, request->height_px, window->x, window->y,
                       window->width_px, window->height_px)));
}

static bool check_camera_place(const struct camera *camera, struct error *error)
{
    double view[3];
    if (!check_point(camera->eye, "camera: eye", error) ||
        !check_point(camera->target, "camera: target", error) ||
        !check_point(camera->up, "camera: up", error))
        return false;
    for (int i = 0; i < 3; i++)
        view[i] = camera->target[i] - camera->eye[i];
    if (range_is_zero(view))
        return error_set(error, ERROR_REQUEST, "camera: eye and target are the same point");
    if (range_is_parallel(view, camera->up))
        return error_set(error, ERROR_REQUEST,
                         "camera: up is zero or parallel to the line from eye to target: choose "
                         "another (--up 0,1,0)");
    return true;
}

static bool check_lens(const struct camera *camera, struct error *error)
{
    return camera->kind == CAMERA_PERSPECTIVE
               ? check_number(camera->fov_deg, RANGE_FOV, "camera: fov", error)
               : check_number(camera->ortho_height, RANGE_ORTHO_HEIGHT,
                              "camera: orthographic height", error);
}

/* What is wrong with a camera or light that was chosen by the model is the model's size. */
static bool blame_model(const struct frame_request *request, const char *what, struct error *error)
{
    const struct error why = *error;
    return error_set(error, ERROR_REQUEST,
                     "the model's box has a diagonal of %.9g units, for which no %s can be chosen "
                     "(%s): scale the model, or give the %s",
                     request->model_size, what, why.text, what);
}

static bool check_light(const struct light *light, struct error *error)
{
    if (!check_point(light->centre, "light: centre", error) ||
        !check_point(light->u, "light: u", error) || !check_point(light->v, "light: v", error) ||
        !check_number(range_length(light->u), RANGE_LIGHT_SIDE, "light: the length of u", error) ||
        !check_number(range_length(light->v), RANGE_LIGHT_SIDE, "light: the length of v", error))
        return false;
    if (range_is_parallel(light->u, light->v))
        return error_set(error, ERROR_REQUEST,
                         "light: u and v are parallel, the light has no area");
    if (light->one_sided && light->kind != LIGHT_RECTANGLE && light->kind != LIGHT_PLANE)
        return error_set(error, ERROR_REQUEST,
                         "light: one-sided is for rectangles and planes; tunnel and sphere are "
                         "seen from inside");
    return true;
}

static bool check_colour(const float colour[4], const char *what, struct error *error)
{
    for (int k = 0; k < 4; k++)
        if (!check_number((double)colour[k], RANGE_COLOUR, what, error))
            return false;
    return true;
}

static bool check_pattern(const struct pattern *pattern, struct error *error)
{
    if (!check_number(pattern->count, RANGE_PATTERN_COUNT, "pattern: count", error) ||
        (pattern->period != 0 &&
         !check_number(pattern->period, RANGE_PATTERN_PERIOD, "pattern: period", error)) ||
        !check_number(pattern->duty, RANGE_PATTERN_DUTY, "pattern: duty", error) ||
        !check_number(pattern->rotation_deg, RANGE_PATTERN_ROTATION, "pattern: rotation", error) ||
        !check_number(pattern->offset, RANGE_PATTERN_OFFSET, "pattern: offset", error) ||
        !check_number(pattern->soft, RANGE_PATTERN_SOFT, "pattern: soft", error) ||
        !check_number(pattern->opacity, RANGE_PATTERN_OPACITY, "pattern: opacity", error) ||
        !check_colour(pattern->foreground, "pattern: foreground", error) ||
        !check_colour(pattern->background, "pattern: background", error))
        return false;
    if (pattern->kind == PATTERN_IMAGE && !pattern->image)
        return error_set(error, ERROR_REQUEST, "pattern: kind image without an image");
    if (pattern->kind != PATTERN_LINES)
        return true;
    if (!check_number(pattern->n_at, RANGE_PATTERN_LINES, "pattern: the number of lines", error) ||
        !check_number(pattern->width, RANGE_PATTERN_WIDTH, "pattern: width", error))
        return false;
    for (uint32_t i = 0; i < pattern->n_at; i++)
        if (!check_number(pattern->at[i], RANGE_PATTERN_AT, "pattern: at", error))
            return false;
    return true;
}

static bool check_lines(const struct lines *lines, struct error *error)
{
    if (lines->has_direction && !check_direction(lines->direction, "lines: direction", error))
        return false;
    switch (lines->eye_kind) {
    case LINE_EYE_POINT:
        return check_point(lines->eye, "lines: eye", error);
    case LINE_EYE_DIRECTION:
        return check_direction(lines->eye, "lines: the direction of view", error);
    case LINE_EYE_CAMERA:
        break;
    }
    return true;
}

/* Refuses an eye in the plane of a flat light: it sees the light as a line, also in a flat mirror,
 * so the picture would show nothing. */
static bool check_eye_off_light(const struct frame_request *request, const struct light *light,
                                struct error *error)
{
    bool is_flat = light->kind == LIGHT_RECTANGLE || light->kind == LIGHT_PLANE;
    bool is_far =
        request->lines.eye_kind == LINE_EYE_DIRECTION ||
        (request->lines.eye_kind == LINE_EYE_CAMERA && request->camera.kind == CAMERA_ORTHOGRAPHIC);
    if (!is_flat || is_far || request->lines.family != LINES_REFLECTION)
        return true;
    bool own = request->lines.eye_kind == LINE_EYE_POINT;
    struct vec eye = get(own ? request->lines.eye : request->camera.eye);
    struct vec u = get(light->u), v = get(light->v), to_eye = vec_sub(eye, get(light->centre));
    double off = vec_dot(vec_unit(vec_cross(vec_unit(u), vec_unit(v))), to_eye);
    double size = light->kind == LIGHT_RECTANGLE ? vec_length(u) : 0;
    return fabs(off) > 1e-9 * (size + vec_length(to_eye)) ||
           error_set(error, ERROR_REQUEST,
                     "light: the eye lies in the light's plane: move the eye or the light");
}

static bool check_surface(const struct surface *surface, struct error *error)
{
    if (surface->kind > SURFACE_WIREFRAME)
        return error_set(error, ERROR_REQUEST, "surface: there is no kind %d", surface->kind);
    return check_number(surface->level, RANGE_LEVEL, "surface: level", error);
}

static bool check_planes(const struct frame_request *request, struct error *error)
{
    return request_has_coverage(request) || !(request->planes & PLANE_COVERAGE) ||
           error_set(error, ERROR_REQUEST,
                     "planes: coverage is known for the exact surface with antialiasing only");
}

bool request_check_view(const struct frame_request *request, struct error *error)
{
    if (!check_camera_place(&request->camera, error))
        return request->has_chosen_camera && blame_model(request, "camera", error);
    if (!check_lens(&request->camera, error) || !check_lines(&request->lines, error))
        return false;
    for (uint32_t i = 0; i < request->n_lights; i++)
        if (!check_light(&request->lights[i], error))
            return request->lights[i].is_chosen && blame_model(request, "light", error);
    return true;
}

bool request_check(const struct frame_request *request, uint32_t max_width_px,
                   uint32_t max_height_px, struct error *error)
{
    if (request->width_px < 1 || request->height_px < 1 || request->width_px > max_width_px ||
        request->height_px > max_height_px)
        return error_set(error, ERROR_REQUEST,
                         "size %ux%u is not in 1x1 to %ux%u, the limit of this device",
                         request->width_px, request->height_px, max_width_px, max_height_px);
    if (request->n_lights < 1)
        return error_set(error, ERROR_REQUEST, "no light: there must be one");
    if (!check_number(request->n_lights, RANGE_LIGHTS, "the number of lights", error))
        return false;
    if (!check_window(request, error))
        return false;
    if (!request_check_view(request, error))
        return false;
    for (uint32_t i = 0; i < request->n_lights; i++)
        if (!check_pattern(&request->lights[i].pattern, error) ||
            !check_eye_off_light(request, &request->lights[i], error))
            return false;
    return check_colour(request->miss, "miss", error) &&
           check_colour(request->empty, "empty", error) &&
           check_colour(request->base, "base", error) && check_surface(&request->surface, error) &&
           check_planes(request, error);
}
