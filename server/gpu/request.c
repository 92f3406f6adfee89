/* Is a frame request one that can be rendered? */
#include "server/gpu/gpu.h"

#include <math.h>

#include "server/gpu/mesh.h"
#include "server/limit/vec.h"

/* Squares of lengths on the light stay normal numbers in single precision. */
static const double LEAST_LENGTH = 1e-18, LARGEST_LENGTH = 1e18;

static bool finite3(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

static bool check_camera(const struct camera *camera, struct error *error)
{
    if (!finite3(camera->eye) || !finite3(camera->target) || !finite3(camera->up))
        return error_set(error, ERROR_REQUEST, "camera: eye, target and up must be finite numbers");
    struct vec forward = vec_sub(get(camera->target), get(camera->eye));
    if (!(vec_length(forward) > 0) || !isfinite(vec_length(forward)))
        return error_set(error, ERROR_REQUEST, "camera: eye and target are the same point");
    struct vec side = vec_cross(vec_unit(forward), vec_unit(get(camera->up)));
    if (!(vec_length(side) > 1e-9))
        return error_set(error, ERROR_REQUEST,
                         "camera: up is zero or parallel to the line from eye to target: choose "
                         "another (--up 0,1,0)");
    if (camera->kind == CAMERA_PERSPECTIVE && !(camera->fov_deg >= 1e-6 && camera->fov_deg <= 179))
        return error_set(error, ERROR_REQUEST, "camera: fov %g is not in 1e-6 to 179 degrees",
                         camera->fov_deg);
    if (camera->kind == CAMERA_ORTHOGRAPHIC &&
        !(camera->ortho_height > 0 && camera->ortho_height <= 1e30))
        return error_set(error, ERROR_REQUEST, "camera: orthographic height %g is not above 0",
                         camera->ortho_height);
    return true;
}

static bool check_light(const struct light *light, struct error *error)
{
    if (!finite3(light->centre) || !finite3(light->u) || !finite3(light->v))
        return error_set(error, ERROR_REQUEST, "light: centre, u and v must be finite numbers");
    const double sides[] = {vec_length(get(light->u)), vec_length(get(light->v))};
    for (int k = 0; k < 2; k++)
        if (!(sides[k] == 0) && !(sides[k] >= LEAST_LENGTH && sides[k] <= LARGEST_LENGTH))
            return error_set(error, ERROR_REQUEST,
                             "light: %c is %g units long; lines are computed for %g to %g", "uv"[k],
                             sides[k], LEAST_LENGTH, LARGEST_LENGTH);
    struct vec m = vec_cross(vec_unit(get(light->u)), vec_unit(get(light->v)));
    if (!(vec_length(m) > 1e-9))
        return error_set(error, ERROR_REQUEST,
                         "light: u and v are zero or parallel, the light has no area");
    if (light->one_sided && light->kind != LIGHT_RECTANGLE && light->kind != LIGHT_PLANE)
        return error_set(error, ERROR_REQUEST,
                         "light: one-sided is for rectangles and planes; tunnel and sphere are "
                         "seen from inside");
    return true;
}

static bool check_pattern(const struct pattern *pattern, struct error *error)
{
    if (!(pattern->count > 0 && pattern->count <= 100000))
        return error_set(error, ERROR_REQUEST, "pattern: count %g is not in (0, 100000]",
                         pattern->count);
    const struct {
        const char *name;
        double value;
    } shares[] = {{"duty", pattern->duty}, {"soft", pattern->soft}, {"opacity", pattern->opacity}};
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++)
        if (!(shares[i].value >= 0 && shares[i].value <= 1))
            return error_set(error, ERROR_REQUEST, "pattern: %s %g is not in [0, 1]",
                             shares[i].name, shares[i].value);
    if (!isfinite(pattern->period) || !isfinite(pattern->rotation_deg) ||
        !isfinite(pattern->offset) || pattern->period < 0)
        return error_set(error, ERROR_REQUEST,
                         "pattern: period, rotation and offset must be finite numbers");
    if (pattern->period > 0 &&
        !(pattern->period >= LEAST_LENGTH && pattern->period <= LARGEST_LENGTH))
        return error_set(error, ERROR_REQUEST, "pattern: period %g is not in %g to %g",
                         pattern->period, LEAST_LENGTH, LARGEST_LENGTH);
    if (pattern->kind == PATTERN_IMAGE && !pattern->image)
        return error_set(error, ERROR_REQUEST, "pattern: kind image without an image");
    if (pattern->kind == PATTERN_LINES &&
        !(pattern->n_at > 0 && pattern->n_at <= MAX_LINES && pattern->width > 0))
        return error_set(error, ERROR_REQUEST,
                         "pattern: lines needs 1 to %d places and a width above 0", MAX_LINES);
    return true;
}

static bool check_lines(const struct lines *lines, struct error *error)
{
    if (!finite3(lines->direction) || !finite3(lines->eye))
        return error_set(error, ERROR_REQUEST, "lines: direction and eye must be finite numbers");
    if (lines->has_direction && !(vec_length(get(lines->direction)) > 0))
        return error_set(error, ERROR_REQUEST, "lines: direction is 0,0,0");
    if (lines->eye_kind == LINE_EYE_DIRECTION && !(vec_length(get(lines->eye)) > 0))
        return error_set(error, ERROR_REQUEST, "lines: the direction of view is 0,0,0");
    return true;
}

/* Seen from its own plane a flat light is a line, and so is its picture in a flat mirror. */
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
    return surface->level <= MESH_MAX_LEVEL ||
           error_set(error, ERROR_REQUEST, "surface: level %u is not in 0 to %d", surface->level,
                     MESH_MAX_LEVEL);
}

static bool check_planes(const struct frame_request *request, struct error *error)
{
    bool has_coverage = request->surface.kind == SURFACE_EXACT && !request->unfiltered;
    return has_coverage || !(request->planes & PLANE_COVERAGE) ||
           error_set(error, ERROR_REQUEST,
                     "planes: coverage is known for the exact surface, filtered, only");
}

bool request_check(const struct renderer_info *info, const struct frame_request *request,
                   struct error *error)
{
    if (request->width_px < 1 || request->height_px < 1 || request->width_px > info->max_width_px ||
        request->height_px > info->max_height_px)
        return error_set(
            error, ERROR_REQUEST, "size %ux%u is not in 1x1 to %ux%u, the limit of this device",
            request->width_px, request->height_px, info->max_width_px, info->max_height_px);
    if (request->n_lights < 1 || request->n_lights > MAX_LIGHTS)
        return error_set(error, ERROR_REQUEST, "%u lights; there must be 1 to %d",
                         request->n_lights, MAX_LIGHTS);
    if (!check_camera(&request->camera, error) || !check_lines(&request->lines, error))
        return false;
    for (uint32_t i = 0; i < request->n_lights; i++)
        if (!check_light(&request->lights[i], error) ||
            !check_pattern(&request->lights[i].pattern, error) ||
            !check_eye_off_light(request, &request->lights[i], error))
            return false;
    return check_surface(&request->surface, error) && check_planes(request, error);
}
