/* Is a frame request one that can be rendered? */
#include "server/gpu/gpu.h"

#include <math.h>

#include "server/limit/vec.h"

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
    struct vec m = vec_cross(vec_unit(get(light->u)), vec_unit(get(light->v)));
    if (!(vec_length(m) > 1e-9))
        return error_set(error, ERROR_REQUEST,
                         "light: u and v are zero or parallel, the rectangle has no area");
    return true;
}

static bool check_pattern(const struct pattern *pattern, struct error *error)
{
    if (!(pattern->count > 0 && pattern->count <= 100000))
        return error_set(error, ERROR_REQUEST, "pattern: count %g is not in (0, 100000]",
                         pattern->count);
    if (!(pattern->duty >= 0 && pattern->duty <= 1))
        return error_set(error, ERROR_REQUEST, "pattern: duty %g is not in [0, 1]", pattern->duty);
    if (pattern->kind == PATTERN_IMAGE && !pattern->image)
        return error_set(error, ERROR_REQUEST, "pattern: kind image without an image");
    return true;
}

bool request_check(const struct renderer_info *info, const struct frame_request *request,
                   struct error *error)
{
    if (request->width_px < 1 || request->height_px < 1 || request->width_px > info->max_width_px ||
        request->height_px > info->max_height_px)
        return error_set(
            error, ERROR_REQUEST, "size %ux%u is not in 1x1 to %ux%u, the limit of this device",
            request->width_px, request->height_px, info->max_width_px, info->max_height_px);
    return check_camera(&request->camera, error) && check_light(&request->light, error) &&
           check_pattern(&request->pattern, error);
}
