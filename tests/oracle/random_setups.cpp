#include "tests/oracle/random_setups.h"

#include <cmath>

random_setups::random_setups(vec3 model_middle, double model_size, int width, int height,
                             unsigned seed)
    : random(seed), middle(model_middle), size(model_size), width_px(width), height_px(height)
{
}

seen_setup random_setups::choose(line_family family, line_light_kind kind)
{
    seen_setup seen;
    seen.camera = choose_camera();
    line_setup &setup = seen.setup;
    setup.family = family;
    setup.has_axis = !setup.meets_lights() && chance(0.7);
    setup.axis = direction();
    choose_eye(&setup);
    setup.lights = {choose_light(kind)};
    return seen;
}

seen_setup random_setups::choose_thin_tunnel()
{
    seen_setup seen = choose(line_family::highlight, line_light_kind::tunnel);
    line_light &light = seen.setup.lights[0];
    light.centre = middle + 6 * size * vec3{0, 0, seen.camera.eye.z > middle.z ? 1.0 : -1.0};
    light.u = size / 16 * vec3{1, 0, 0};
    light.v = size / 5 * vec3{0, 1, 0};
    return seen;
}

double random_setups::uniform(double low, double high)
{
    return low + (high - low) * (random() / 4294967296.0);
}

bool random_setups::chance(double share)
{
    return uniform(0, 1) < share;
}

double random_setups::sizes(double low, double high)
{
    return size * std::pow(10, uniform(low, high));
}

vec3 random_setups::direction()
{
    for (;;) {
        vec3 v = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        if (length(v) > 0.1 && length(v) < 1)
            return normalized(v);
    }
}

vec3 random_setups::direction_off(vec3 axis)
{
    vec3 v = direction();
    while (length(cross(v, axis)) < 0.1)
        v = direction();
    return v;
}

view random_setups::choose_camera()
{
    view view;
    vec3 back = direction();
    double distance = chance(0.3) ? sizes(0, 4) : sizes(0, 0.5);
    view.target = middle + (0.1 * size) * direction();
    view.eye = view.target + distance * back;
    view.up = direction_off(back);
    view.width_px = width_px;
    view.height_px = height_px;
    view.orthographic = chance(0.3);
    view.ortho_height = 0.6 * size;
    view.fov_deg = 2 * std::atan(0.3 * size / distance) * 180 / M_PI;
    return view;
}

void random_setups::choose_eye(line_setup *setup)
{
    double kind = uniform(0, 1);
    setup->eye_kind = kind < 0.4   ? line_eye_kind::camera
                      : kind < 0.8 ? line_eye_kind::point
                                   : line_eye_kind::direction;
    setup->eye = setup->eye_kind == line_eye_kind::point ? middle + sizes(-0.5, 4) * direction()
                                                         : uniform(0.1, 10) * direction();
}

line_light random_setups::choose_light(line_light_kind kind)
{
    line_light light;
    light.kind = kind;
    vec3 to_light = direction();
    double distance = sizes(-0.5, 4);
    light.centre = middle + distance * to_light;
    if (kind == line_light_kind::tunnel)
        choose_tunnel(&light, distance, to_light);
    else
        choose_flat(&light, distance, to_light);
    return light;
}

/* Also for the vectors of a sphere. The light is as wide as its distance, within a factor of ten or
 * so. */
void random_setups::choose_flat(line_light *light, double distance, vec3 to_light)
{
    vec3 u = chance(0.7) ? cross(to_light, direction_off(to_light)) : direction();
    vec3 v = direction_off(u);
    light->u = (distance * std::pow(10, uniform(-0.5, 1))) * normalized(u);
    light->v = (distance * std::pow(10, uniform(-0.5, 1))) * v;
    light->one_sided = light->kind != line_light_kind::sphere && chance(0.3);
    /* the centre far away within the light's plane */
    if (light->kind == line_light_kind::plane && chance(0.4))
        light->centre = light->centre + sizes(0, 4) * normalized(v);
    if (light->kind == line_light_kind::plane && chance(0.3)) /* with very fine stripes */
        light->u = (0.01 * size / length(light->u)) * light->u;
}

void random_setups::choose_tunnel(line_light *light, double distance, vec3 to_light)
{
    light->v = sizes(-1, 1) * direction_off(to_light);
    vec3 across = normalized(cross(light->v, direction_off(light->v)));
    double kind = uniform(0, 1), radius;
    if (kind < 0.3) /* a thin tunnel */
        radius = distance * std::pow(10, uniform(-2.5, -0.5));
    else if (kind < 0.6) /* a tunnel around the model */
        radius = distance * uniform(1.5, 3) + 2 * size;
    else /* a wide tunnel whose wall is near the model */
        radius =
            length(cross(light->centre - middle, normalized(light->v))) + uniform(-0.2, 2) * size;
    radius = std::fmax(radius, 1e-3 * distance);
    light->u = radius * across + uniform(-2, 2) * light->v;
    if (chance(0.4)) /* the centre far away along the axis */
        light->centre = light->centre + sizes(0, 4) * normalized(light->v);
}
