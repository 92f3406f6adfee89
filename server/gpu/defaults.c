/* The view and the light of a request that names none. */
#include "server/gpu/renderer.h"

#include <math.h>

#include "server/limit/vec.h"

static const double DEGREE = 3.14159265358979323846 / 180;

static struct vec box_middle(const double box_min[3], const double box_max[3])
{
    return (struct vec){0.5 * (box_min[0] + box_max[0]), 0.5 * (box_min[1] + box_max[1]),
                        0.5 * (box_min[2] + box_max[2])};
}

/* Half the box's diagonal; a point gets a sphere of some size too. */
static double box_radius(const double box_min[3], const double box_max[3])
{
    struct vec d = {box_max[0] - box_min[0], box_max[1] - box_min[1], box_max[2] - box_min[2]};
    double radius = 0.5 * vec_length(d);
    return radius > 0 ? radius : 1;
}

/* Without -0, which JSON readers make 0 of: what was chosen, asked for again, is the same request.
 */
static void put(struct vec v, double out[3])
{
    out[0] = v.x + 0.0;
    out[1] = v.y + 0.0;
    out[2] = v.z + 0.0;
}

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

/* Where the eye must be for all of the box to lie inside a picture, as near as can be: from the
 * box's middle by `distance` back along the view and `side` across it. */
struct framing {
    double distance, side;
};

/* Along one axis of the picture, `across`, of whose half angle this is the tangent. A corner is
 * inside when |x - side| <= tangent (distance + depth): each edge of the picture is met by the
 * corner that asks most of it. */
static struct framing frame_axis(const struct vec corners[8], struct vec forward, struct vec across,
                                 double tangent)
{
    double above = -INFINITY, below = -INFINITY;
    for (int i = 0; i < 8; i++) {
        double x = vec_dot(corners[i], across) / tangent, depth = vec_dot(corners[i], forward);
        above = fmax(above, x - depth);
        below = fmax(below, -x - depth);
    }
    return (struct framing){0.5 * (above + below), 0.5 * tangent * (above - below)};
}

/* Puts eye and target, which look along `forward`, for the box to fill a picture whose half angles
 * have these tangents. */
static void frame_box(const double box_min[3], const double box_max[3], struct vec forward,
                      struct vec up, double tan_x, double tan_y, struct camera *camera)
{
    struct vec middle = box_middle(box_min, box_max), corners[8];
    for (int i = 0; i < 8; i++) {
        struct vec corner = {i & 1 ? box_max[0] : box_min[0], i & 2 ? box_max[1] : box_min[1],
                             i & 4 ? box_max[2] : box_min[2]};
        corners[i] = vec_sub(corner, middle);
    }
    struct vec right = vec_unit(vec_cross(forward, up)), above = vec_cross(right, forward);
    struct framing x = frame_axis(corners, forward, right, tan_x);
    struct framing y = frame_axis(corners, forward, above, tan_y);
    double distance = fmax(x.distance, y.distance);
    struct vec target = vec_mad(vec_mad(middle, x.side, right), y.side, above);
    put(target, camera->target);
    put(vec_mad(target, distance > 0 ? -distance : -1, forward), camera->eye);
}

/* Y up is glTF's and most modellers' convention, Z up that of CAD: a body is rarely thinner along a
 * horizontal axis than along its up axis, so the thinner of the two is up. */
static struct vec guess_up(const double box_min[3], const double box_max[3])
{
    bool z_up = box_max[2] - box_min[2] <= box_max[1] - box_min[1];
    return z_up ? (struct vec){0, 0, 1} : (struct vec){0, 1, 0};
}

/* The horizontal direction that azimuth is counted from: the world's x axis, or y where x is up. */
static struct vec horizontal_axis(struct vec up)
{
    bool x_up = fabs(up.x) > 1 - 1e-9;
    struct vec axis = x_up ? (struct vec){0, 1, 0} : (struct vec){1, 0, 0};
    return vec_unit(vec_mad(axis, -vec_dot(axis, up), up));
}

static double extent(const double box_min[3], const double box_max[3], struct vec axis)
{
    return fabs(axis.x) * (box_max[0] - box_min[0]) + fabs(axis.y) * (box_max[1] - box_min[1]) +
           fabs(axis.z) * (box_max[2] - box_min[2]);
}

void renderer_default_camera(const double box_min[3], const double box_max[3], const double up[3],
                             uint32_t width_px, uint32_t height_px, struct camera *camera)
{
    struct vec upward = up ? vec_unit(get(up)) : guess_up(box_min, box_max);
    struct vec e1 = horizontal_axis(upward), e2 = vec_cross(upward, e1);
    /* The longer of the horizontal sides lies across the picture rather than into it; clearly
     * longer, so that rounding does not turn what is as long as wide. */
    bool turned = extent(box_min, box_max, e2) > 1.1 * extent(box_min, box_max, e1);
    double azimuth = (turned ? -30 : -60) * DEGREE;
    double elevation = 45 * DEGREE, fov_deg = 35, margin = 0.92;
    struct vec from = vec_scale(upward, sin(elevation));
    from = vec_mad(from, cos(elevation) * cos(azimuth), e1);
    from = vec_mad(from, cos(elevation) * sin(azimuth), e2);
    double tan_y = margin * tan(0.5 * fov_deg * DEGREE), tan_x = tan_y * width_px / height_px;
    *camera = (struct camera){.kind = CAMERA_PERSPECTIVE, .fov_deg = fov_deg};
    put(up ? get(up) : upward, camera->up);
    frame_box(box_min, box_max, vec_scale(from, -1), upward, tan_x, tan_y, camera);
}

void renderer_default_light(const double box_min[3], const double box_max[3],
                            const struct camera *camera, struct light *light)
{
    /* Low overhead and wide: whatever the surface reflects from within 76 degrees of straight up is
     * light. Its lines run away from the viewer. */
    double radius = box_radius(box_min, box_max), height = 2 * radius, size = 16 * radius;
    struct vec up = vec_unit(get(camera->up));
    struct vec view = vec_unit(vec_sub(get(camera->target), get(camera->eye)));
    struct vec away = vec_unit(vec_mad(view, -vec_dot(view, up), up));
    struct vec middle = box_middle(box_min, box_max);
    put(vec_scale(away, light->kind == LIGHT_SPHERE ? 1 : size), light->v);
    switch (light->kind) {
    case LIGHT_RECTANGLE:
    case LIGHT_PLANE:
        put(vec_mad(middle, height, up), light->centre);
        put(vec_scale(vec_cross(away, up), size), light->u);
        break;
    case LIGHT_TUNNEL:
        put(middle, light->centre);
        put(vec_scale(up, 1.5 * height), light->u);
        break;
    case LIGHT_SPHERE:
        put(middle, light->centre);
        put(up, light->u);
        break;
    }
}
