/* The camera and light of a request that leaves them out. */
#include "server/scene/defaults.h"

#include <math.h>

#include "server/surface/tables.h"
#include "server/surface/vec.h"

static const double DEGREE = 3.14159265358979323846 / 180;

static struct vec box_middle(const double box_min[3], const double box_max[3])
{
    return (struct vec){0.5 * (box_min[0] + box_max[0]), 0.5 * (box_min[1] + box_max[1]),
                        0.5 * (box_min[2] + box_max[2])};
}

/* Half the box's diagonal; at least some size, for a model that is a point. */
static double box_radius(const double box_min[3], const double box_max[3])
{
    struct vec d = {box_max[0] - box_min[0], box_max[1] - box_min[1], box_max[2] - box_min[2]};
    double radius = 0.5 * vec_length(d);
    return radius > 0 ? radius : 1;
}

/* Turns -0 into 0, like readers of JSON, so that a request made from the chosen numbers is the
 * same. */
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

/* The nearest eye from which the whole model lies inside the picture: from the middle of the box,
 * `distance` back along the view and `side` across it. */
struct framing {
    double distance, side;
};

/* Computes the framing along one axis of the picture, `across`; `tangent` is that of half the field
 * of view. A point is inside if |x - side| <= tangent (distance + depth), so one point decides at
 * each edge. */
static struct framing frame_axis(const float (*points)[3], size_t n, struct vec forward,
                                 struct vec across, double tangent)
{
    double above = -INFINITY, below = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        struct vec point = {(double)points[i][0], (double)points[i][1], (double)points[i][2]};
        double x = vec_dot(point, across) / tangent, depth = vec_dot(point, forward);
        above = fmax(above, x - depth);
        below = fmax(below, -x - depth);
    }
    return (struct framing){0.5 * (above + below), 0.5 * tangent * (above - below)};
}

/* Places eye and target, looking along `forward`, so that the model fills a picture with these
 * tangents: by its outermost points, or, if they are not known, by its box. */
static void frame_model(const struct limit_tables *tables, struct vec forward, struct vec up,
                        double tan_x, double tan_y, struct camera *camera)
{
    struct vec middle = box_middle(tables->box_min, tables->box_max);
    float corners[8][3];
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            corners[i][k] =
                (float)((i >> k & 1 ? 0.5 : -0.5) * (tables->box_max[k] - tables->box_min[k]));
    const float(*points)[3] = tables->n_support ? tables->support : corners;
    size_t n = tables->n_support ? tables->n_support : 8;
    struct vec right = vec_unit(vec_cross(forward, up)), above = vec_cross(right, forward);
    struct framing x = frame_axis(points, n, forward, right, tan_x);
    struct framing y = frame_axis(points, n, forward, above, tan_y);
    double distance = fmax(x.distance, y.distance);
    struct vec target = vec_mad(vec_mad(middle, x.side, right), y.side, above);
    put(target, camera->target);
    put(vec_mad(target, distance > 0 ? -distance : -1, forward), camera->eye);
}

/* Most modelling programs have y up, CAD has z up, and a body is rarely thinner along a horizontal
 * axis than along its up axis. So the axis along which it is thinner is up; it must be clearly
 * thinner, so that rounding does not turn a model. */
void scene_guess_up(const double box_min[3], const double box_max[3], double up[3])
{
    bool z_up = 0.99 * (box_max[2] - box_min[2]) <= box_max[1] - box_min[1];
    put(z_up ? (struct vec){0, 0, 1} : (struct vec){0, 1, 0}, up);
}

/* The horizontal direction of azimuth 0: the world's x axis, or y if x is up. */
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

/* Is the box longer along e2 than along e1? It must be clearly longer, so that rounding or a small
 * change does not turn a model that is as long as wide. */
static bool is_deeper(const double box_min[3], const double box_max[3], struct vec e1,
                      struct vec e2)
{
    return extent(box_min, box_max, e2) > 1.1 * extent(box_min, box_max, e1);
}

static struct vec upward_of(const double box_min[3], const double box_max[3], const double up[3])
{
    double guessed[3];
    if (!up)
        scene_guess_up(box_min, box_max, guessed);
    return vec_unit(get(up ? up : guessed));
}

/* The direction from the model to the eye; length 1. */
static struct vec standpoint(enum default_view view, const double box_min[3],
                             const double box_max[3], struct vec up)
{
    struct vec e1 = horizontal_axis(up), e2 = vec_cross(up, e1);
    double elevation = 45 * DEGREE, azimuth = 0;
    switch (view) {
    case VIEW_AROUND:
        /* The longer horizontal side lies across the picture rather than into it. */
        azimuth = (is_deeper(box_min, box_max, e1, e2) ? -30 : -60) * DEGREE;
        break;
    case VIEW_ISO: /* all three axes are equally long in the picture */
        azimuth = -45 * DEGREE;
        elevation = atan(sqrt(0.5));
        break;
    case VIEW_FRONT:
        return vec_scale(e2, -1);
    case VIEW_BACK:
        return e2;
    case VIEW_LEFT:
        return vec_scale(e1, -1);
    case VIEW_RIGHT:
        return e1;
    case VIEW_TOP:
        return up;
    case VIEW_BOTTOM:
        return vec_scale(up, -1);
    }
    struct vec from = vec_scale(up, sin(elevation));
    from = vec_mad(from, cos(elevation) * cos(azimuth), e1);
    return vec_mad(from, cos(elevation) * sin(azimuth), e2);
}

void scene_default_camera(const struct limit_tables *tables, const double up[3],
                          enum default_view view, uint32_t width_px, uint32_t height_px,
                          struct camera *camera)
{
    const double *box_min = tables->box_min, *box_max = tables->box_max;
    double fov_deg = 35, margin = 0.92;
    struct vec upward = upward_of(box_min, box_max, up);
    struct vec from = standpoint(view, box_min, box_max, upward);
    double tan_y = margin * tan(0.5 * fov_deg * DEGREE), tan_x = tan_y * width_px / height_px;
    *camera = (struct camera){.kind = CAMERA_PERSPECTIVE, .fov_deg = fov_deg};
    put(up ? get(up) : upward, camera->up);
    put(vec_scale(from, -1), camera->target);
    scene_default_roll(camera->up, camera);
    frame_model(tables, vec_scale(from, -1), get(camera->up), tan_x, tan_y, camera);
}

void scene_default_roll(const double up[3], struct camera *camera)
{
    struct vec view = vec_unit(vec_sub(get(camera->target), get(camera->eye)));
    struct vec upward = vec_unit(get(up));
    struct vec ahead = vec_cross(upward, horizontal_axis(upward));
    bool along = vec_length(vec_cross(view, upward)) < 1e-6;
    put(!along ? get(up) : vec_dot(view, upward) < 0 ? ahead : vec_scale(ahead, -1), camera->up);
}

void scene_zoom(struct camera *camera, uint32_t width_px, uint32_t height_px, double factor,
                double x, double y)
{
    bool ortho = camera->kind == CAMERA_ORTHOGRAPHIC;
    struct vec eye = get(camera->eye), view = vec_sub(get(camera->target), eye);
    struct vec forward = vec_unit(view), right = vec_unit(vec_cross(forward, get(camera->up)));
    struct vec above = vec_cross(right, forward);
    double tangent = tan(0.5 * camera->fov_deg * DEGREE), distance = vec_length(view);
    double half = ortho ? 0.5 * camera->ortho_height : tangent * distance;
    double across = (2 * x - 1) * half * width_px / height_px, rise = (1 - 2 * y) * half;
    struct vec move = vec_mad(vec_scale(right, across), rise, above);
    put(vec_mad(get(camera->target), 1, move), camera->target);
    if (ortho)
        put(vec_mad(eye, 1, move), camera->eye);
    camera->ortho_height /= factor;
    camera->fov_deg = 2 * atan(tangent / factor) / DEGREE;
}

void scene_default_light(const double box_min[3], const double box_max[3], const double up[3],
                         struct light *light)
{
    struct vec upward = upward_of(box_min, box_max, up), middle = box_middle(box_min, box_max);
    struct vec e1 = horizontal_axis(upward), e2 = vec_cross(upward, e1);
    struct vec along = is_deeper(box_min, box_max, e1, e2) ? e2 : e1;
    double radius = box_radius(box_min, box_max);
    /* Flat lights are low above the model and wide: every direction within 76 degrees of up meets
     * them; u x v points down. Round lights are so large that lines follow the surface's shape
     * rather than the distance to the light, but near enough for several lines on a flat side. */
    double height = 2 * radius, size = 16 * radius, tunnel = 3 * radius;
    put(middle, light->centre);
    put(along, light->v);
    switch (light->kind) {
    case LIGHT_RECTANGLE:
    case LIGHT_PLANE:
        put(vec_mad(middle, height, upward), light->centre);
        put(vec_scale(vec_cross(upward, along), size), light->u);
        put(vec_scale(along, size), light->v);
        break;
    case LIGHT_TUNNEL:
        put(vec_scale(upward, tunnel), light->u);
        /* One period of v is as long as the circumference. */
        put(vec_scale(along, 360 * DEGREE * tunnel), light->v);
        break;
    case LIGHT_SPHERE:
        put(upward, light->u);
        break;
    }
}
