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

static void put(struct vec v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static struct vec get(const double a[3])
{
    return (struct vec){a[0], a[1], a[2]};
}

/* How far from the box's middle the eye must be, looking along `forward`, for all of the box to lie
 * inside a picture whose half angles have these tangents. */
static double framing_distance(const double box_min[3], const double box_max[3], struct vec forward,
                               struct vec up, double tan_x, double tan_y)
{
    struct vec middle = box_middle(box_min, box_max);
    struct vec right = vec_unit(vec_cross(forward, up)), above = vec_cross(right, forward);
    double distance = 0;
    for (int i = 0; i < 8; i++) {
        struct vec corner = {i & 1 ? box_max[0] : box_min[0], i & 2 ? box_max[1] : box_min[1],
                             i & 4 ? box_max[2] : box_min[2]};
        struct vec d = vec_sub(corner, middle);
        double side = fmax(fabs(vec_dot(d, right)) / tan_x, fabs(vec_dot(d, above)) / tan_y);
        distance = fmax(distance, side - vec_dot(d, forward));
    }
    return distance > 0 ? distance : 1;
}

void renderer_default_camera(const double box_min[3], const double box_max[3], uint32_t width_px,
                             uint32_t height_px, struct camera *camera)
{
    /* Y up is glTF's and most modellers' convention, Z up that of CAD: a body is rarely thinner
     * along a horizontal axis than along its up axis, so the thinner of the two is up. */
    bool z_up = box_max[2] - box_min[2] <= box_max[1] - box_min[1];
    struct vec up = z_up ? (struct vec){0, 0, 1} : (struct vec){0, 1, 0};
    double azimuth = -60 * DEGREE, elevation = 45 * DEGREE, fov_deg = 35, margin = 0.92;
    double east = cos(elevation) * cos(azimuth), south = cos(elevation) * sin(azimuth);
    struct vec from = z_up ? (struct vec){east, south, sin(elevation)}
                           : (struct vec){east, sin(elevation), -south};
    double tan_y = margin * tan(0.5 * fov_deg * DEGREE), tan_x = tan_y * width_px / height_px;
    double distance = framing_distance(box_min, box_max, vec_scale(from, -1), up, tan_x, tan_y);
    struct vec middle = box_middle(box_min, box_max);
    *camera = (struct camera){.kind = CAMERA_PERSPECTIVE, .fov_deg = fov_deg};
    put(vec_mad(middle, distance, from), camera->eye);
    put(middle, camera->target);
    put(up, camera->up);
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
