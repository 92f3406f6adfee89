#include "server/render/light_block.h"

#include <float.h>
#include <math.h>

#include "protocol/srgb.h"
#include "server/surface/vec.h"

static const double PI = 3.14159265358979323846;

/* Rounds to single precision; a number out of range becomes the largest one. */
static float single(double value)
{
    return (float)fmax(-(double)FLT_MAX, fmin(value, (double)FLT_MAX));
}

static void put(struct vec v, float out[4])
{
    out[0] = single(v.x);
    out[1] = single(v.y);
    out[2] = single(v.z);
}

/* Converts a colour (sRGB, straight alpha) to what the shaders mix: linear light (IEC 61966-2-1),
 * premultiplied. */
static void put_colour(const float in[4], float out[4])
{
    for (int k = 0; k < 3; k++)
        out[k] = in[3] * (float)srgb_to_linear((double)in[k]);
    out[3] = in[3];
}

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

static void fill_eye(struct light_block *block, const struct frame_request *request)
{
    const struct camera *camera = &request->camera;
    struct vec eye = get(request->lines.eye), view = vec_sub(get(camera->target), get(camera->eye));
    switch (request->lines.eye_kind) {
    case LINE_EYE_CAMERA:
        if (camera->kind == CAMERA_PERSPECTIVE)
            block->line_eye[3] = 1; /* the line eye is the camera's eye */
        else
            put(vec_unit(view), block->line_eye);
        break;
    case LINE_EYE_POINT:
        put(vec_sub(eye, get(camera->eye)), block->line_eye);
        block->line_eye[3] = 1;
        break;
    case LINE_EYE_DIRECTION:
        put(vec_unit(eye), block->line_eye);
        break;
    }
}

/* `eye` here and below is the camera's eye relative to the light's centre. */
static void fill_plane(struct light_block *block, struct vec u, struct vec v, struct vec eye)
{
    struct vec m = vec_cross(u, v), n = vec_unit(m);
    double area2 = vec_dot(m, m);
    /* The dual basis in the plane: dual_u . u = 1, dual_u . v = 0. */
    struct vec dual_u = vec_scale(vec_cross(v, m), 1 / area2);
    struct vec dual_v = vec_scale(vec_cross(m, u), 1 / area2);
    put(n, block->axis_n);
    put(dual_u, block->axis_u);
    put(dual_v, block->axis_v);
    block->size[0] = (float)vec_length(u);
    block->size[1] = (float)vec_length(v);
    /* Use the rounded sizes, because the shaders divide by them. */
    double s = (double)block->size[0] * vec_dot(dual_u, eye);
    double t = (double)block->size[1] * vec_dot(dual_v, eye);
    put((struct vec){s, t, vec_dot(n, eye)}, block->origin);
}

/* An axis and the direction of azimuth 0: along `start`, without its part along the axis. */
struct axis {
    struct vec n, u, v;
};

static struct axis axis_of(struct vec axis, struct vec start)
{
    struct vec n = vec_unit(axis), u = vec_unit(vec_mad(start, -vec_dot(start, n), n));
    return (struct axis){n, u, vec_cross(n, u)};
}

static void fill_axis(struct light_block *block, const struct axis *axis)
{
    put(axis->n, block->axis_n);
    put(axis->u, block->axis_u);
    put(axis->v, block->axis_v);
}

static void fill_tunnel(struct light_block *block, struct vec u, struct vec v, struct vec eye)
{
    struct axis axis = axis_of(v, u);
    double radius = vec_dot(u, axis.u), x = vec_dot(eye, axis.u), y = vec_dot(eye, axis.v);
    double away = hypot(x, y);
    fill_axis(block, &axis);
    block->axis_n[3] = (float)radius;
    block->size[0] = (float)(2 * PI * radius);
    block->size[1] = (float)vec_length(v);
    double along = (double)block->size[1] * (vec_dot(eye, axis.n) / vec_length(v));
    put((struct vec){x, y, along}, block->origin);
    block->origin[3] = single((radius - away) * (radius + away));
}

static void fill_light(struct light_block *block, const struct light *light, struct vec camera_eye)
{
    struct vec u = get(light->u), v = get(light->v), eye = vec_sub(camera_eye, get(light->centre));
    block->is_one_sided = light->one_sided;
    switch (light->kind) {
    case LIGHT_RECTANGLE:
    case LIGHT_PLANE:
        fill_plane(block, u, v, eye);
        break;
    case LIGHT_TUNNEL:
        fill_tunnel(block, u, v, eye);
        break;
    case LIGHT_SPHERE: {
        struct axis axis = axis_of(v, u);
        fill_axis(block, &axis);
        block->size[0] = 360;
        block->size[1] = 180;
        break;
    }
    }
}

/* The axis of families that need no light: the given one, or the camera's up. */
static void fill_family(struct light_block *block, const struct frame_request *request)
{
    const struct lines *lines = &request->lines;
    struct vec x = {1, 0, 0}, y = {0, 1, 0};
    struct vec along = vec_unit(get(lines->has_direction ? lines->direction : request->camera.up));
    struct axis axis = axis_of(along, fabs(along.x) < 0.999 ? x : y);
    fill_axis(block, &axis);
    block->has_direction = lines->has_direction;
    bool wide = lines->family == LINES_ENVIRONMENT;
    block->size[0] = wide ? 360 : 180;
    block->size[1] = wide ? 180 : 360;
}

/* Phases are measured from the light's centre, and only their fractions matter. */
static void fill_pattern(struct light_block *block, const struct pattern *pattern)
{
    double w = (double)block->size[0], h = (double)block->size[1];
    double period = pattern->period > 0                ? pattern->period
                    : pattern->kind == PATTERN_CIRCLES ? 0.5 * fmin(w, h) / pattern->count
                                                       : w / pattern->count;
    double a = 0.5 * w / period + pattern->offset, b = 0.5 * h / period + pattern->offset;
    double angle = fmod(pattern->rotation_deg, 360) * PI / 180;
    block->turn[0] = (float)cos(angle);
    block->turn[1] = (float)sin(angle);
    block->turn[2] = (float)(1 / period);
    block->turn[3] = (float)(pattern->offset - floor(pattern->offset));
    block->wave[0] = (float)(a - floor(a));
    block->wave[1] = (float)(b - floor(b));
    block->wave[2] = (float)pattern->duty;
    block->wave[3] = (float)pattern->soft;
    for (uint32_t i = 0; i < pattern->n_at; i++)
        block->single[i] = (float)((pattern->at[i] - 0.5) * w);
    block->n_single = (int32_t)pattern->n_at;
    block->half_width = (float)(0.5 * pattern->width * w);
    block->opacity = (float)pattern->opacity;
    put_colour(pattern->foreground, block->foreground);
    put_colour(pattern->background, block->background);
}

void light_block_fill(struct light_block *block, const struct frame_request *request, uint32_t i)
{
    const struct light *light = &request->lights[i];
    *block = (struct light_block){.is_hindmost = i + 1 == request->n_lights, .is_foremost = i == 0};
    fill_eye(block, request);
    if (family_is_at_infinity(request->lines.family))
        fill_family(block, request);
    else
        fill_light(block, light, get(request->camera.eye));
    fill_pattern(block, &light->pattern);
    put_colour(request->miss, block->miss);
    put_colour(request->empty, block->empty);
    put_colour(request->base, block->base);
    block->want[0] = (request->planes & PLANE_LIGHT) != 0;
    block->want[1] = (request->planes & PLANE_CURVATURE) != 0;
    block->want[2] = (request->planes & PLANE_LIGHT_CHANGE) != 0;
    block->want[3] = request_has_coverage(request);
}

bool light_image_repeats_s(const struct frame_request *request, const struct light *light)
{
    enum line_family family = request->lines.family;
    return family_is_at_infinity(family) ? family == LINES_ENVIRONMENT
                                         : light->kind != LIGHT_RECTANGLE;
}

bool light_image_repeats_t(const struct frame_request *request, const struct light *light)
{
    enum line_family family = request->lines.family;
    return family_is_at_infinity(family)
               ? family == LINES_ZEBRA
               : light->kind == LIGHT_PLANE || light->kind == LIGHT_TUNNEL;
}
