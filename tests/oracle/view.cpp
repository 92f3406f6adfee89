#include "tests/oracle/view.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace
{

view look(const char *name, vec3 eye, vec3 target, vec3 up, int width_px, int height_px)
{
    view view;
    view.name = name;
    view.eye = eye;
    view.target = target;
    view.up = up;
    view.width_px = width_px;
    view.height_px = height_px;
    return view;
}

/* Any unit vector perpendicular to n. */
vec3 across(vec3 n)
{
    vec3 axis = std::fabs(n.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0};
    return normalized(cross(n, axis));
}

/* A picture a fifth of a face high, a little off the normal, at the irregular vertex with most
 * faces. */
bool close_up(const model &model, int width_px, int height_px, view *view)
{
    const osd_irregular *worst = nullptr;
    for (const osd_irregular &irregular : model.oracle->irregular())
        if (!worst || irregular.valence > worst->valence)
            worst = &irregular;
    osd_sample s, inside, ahead, beside;
    if (!worst || !model.oracle->evaluate(worst->face, worst->u, worst->v, &s) ||
        !model.oracle->evaluate(worst->face, 0.9 * worst->u + 0.05, 0.9 * worst->v + 0.05,
                                &inside) ||
        !model.oracle->evaluate(worst->face, 1 - worst->u, worst->v, &ahead) ||
        !model.oracle->evaluate(worst->face, worst->u, 1 - worst->v, &beside))
        return false;
    vec3 normal = inside.normal();
    double side = std::fmax(length(ahead.p - s.p), length(beside.p - s.p));
    if (!finite(normal) || !(side > 0))
        return false;
    double fov_deg = 30, distance = 0.1 * side / std::tan(fov_deg * M_PI / 360);
    vec3 toward = normalized(normal + 0.3 * across(normal));
    *view = look("close-up", s.p + distance * toward, s.p, across(toward), width_px, height_px);
    view->fov_deg = fov_deg;
    return true;
}

/* Reads the number, or the `count` numbers of the array, that JSON has under a key. */
bool numbers_after(const std::string &text, const std::string &key, int count, double *numbers)
{
    size_t at = text.find("\"" + key + "\":");
    if (at == std::string::npos)
        return false;
    const char *s = text.c_str() + at + key.size() + 3;
    for (int i = 0; i < count; i++) {
        s += std::strspn(s, " \n,[");
        char *end;
        numbers[i] = std::strtod(s, &end);
        if (end == s)
            return false;
        s = end;
    }
    return true;
}

} // namespace

projector::projector(const view &view)
    : is_orthographic(view.orthographic), eye(view.eye), half_width(view.width_px / 2.0),
      half_height(view.height_px / 2.0)
{
    forward = normalized(view.target - view.eye);
    right = normalized(cross(forward, view.up));
    up = cross(right, forward);
    scale = is_orthographic ? view.height_px / view.ortho_height
                            : half_height / std::tan(view.fov_deg * M_PI / 360);
}

projected projector::project(vec3 p) const
{
    vec3 d = p - eye;
    double depth = dot(d, forward);
    double k = is_orthographic ? scale : scale / depth;
    return {half_width + k * dot(d, right), half_height - k * dot(d, up), depth};
}

void projector::ray(double x, double y, vec3 *origin, vec3 *direction) const
{
    vec3 offset = ((x - half_width) / scale) * right + ((half_height - y) / scale) * up;
    *origin = is_orthographic ? eye + offset : eye;
    *direction = is_orthographic ? forward : normalized(forward + offset);
}

bool projector::may_see(vec3 centre, double radius) const
{
    vec3 d = centre - eye;
    double depth = dot(d, forward);
    double x = std::fabs(dot(d, right)), y = std::fabs(dot(d, up));
    double reach_x = half_width / scale, reach_y = half_height / scale; /* at depth 1 */
    if (is_orthographic)
        return x <= reach_x + radius && y <= reach_y + radius;
    return depth >= -radius && x - depth * reach_x <= radius * std::hypot(1, reach_x) &&
           y - depth * reach_y <= radius * std::hypot(1, reach_y);
}

std::string comma_separated(vec3 v)
{
    char text[96];
    std::snprintf(text, sizeof text, "%.17g,%.17g,%.17g", v.x, v.y, v.z);
    return text;
}

std::vector<std::string> view_options(const view &view)
{
    std::vector<std::string> options = {"--size", std::to_string(view.width_px) + "x" +
                                                      std::to_string(view.height_px)};
    if (view.chosen_by_sheen)
        return options;
    char number[32];
    std::snprintf(number, sizeof number, "%.17g",
                  view.orthographic ? view.ortho_height : view.fov_deg);
    for (const std::string &word :
         {std::string("--eye"), comma_separated(view.eye), std::string("--target"),
          comma_separated(view.target), std::string("--up"), comma_separated(view.up),
          std::string(view.orthographic ? "--ortho" : "--fov"), std::string(number)})
        options.push_back(word);
    return options;
}

std::vector<view> model_views(const model &model, int width_px, int height_px)
{
    std::vector<view> views;
    view automatic = look("default", {}, {}, {}, width_px, height_px);
    automatic.chosen_by_sheen = true;
    views.push_back(automatic);

    double radius = 0.5 * model.diagonal();
    vec3 middle = model.middle();
    view side = look("side", middle + (3.9 * radius) * normalized({-0.6, 0.5, 0.62}), middle,
                     {0.1, 0.9, 0.2}, width_px, height_px);
    side.fov_deg = 30;
    views.push_back(side);

    view below = look("ortho", middle + (3 * radius) * normalized({0.35, -0.25, -0.9}), middle,
                      {0, 1, 0}, width_px, height_px);
    below.orthographic = true;
    below.ortho_height = 1.9 * radius;
    views.push_back(below);

    view close;
    if (close_up(model, width_px, height_px, &close))
        views.push_back(close);
    return views;
}

view zoomed_view(const model &model, int width_px, int height_px)
{
    osd_sample s;
    uint32_t face = 0;
    while (face < model.oracle->n_ptex_faces() && !model.oracle->evaluate(face, 0.3, 0.4, &s))
        face++;
    double height = 5e-5 * length(s.du), fov_deg = 30;
    vec3 toward = normalized(s.normal() + 0.3 * across(s.normal()));
    vec3 eye = s.p + (0.5 * height / std::tan(fov_deg * M_PI / 360)) * toward;
    view zoom = look("zoom", eye, s.p, across(toward), width_px, height_px);
    zoom.fov_deg = fov_deg;
    return zoom;
}

bool read_camera(const std::string &json, view *view)
{
    double eye[3], target[3], up[3];
    if (!numbers_after(json, "eye", 3, eye) || !numbers_after(json, "target", 3, target) ||
        !numbers_after(json, "up", 3, up))
        return false;
    view->eye = {eye[0], eye[1], eye[2]};
    view->target = {target[0], target[1], target[2]};
    view->up = {up[0], up[1], up[2]};
    view->orthographic = numbers_after(json, "ortho_height", 1, &view->ortho_height);
    return view->orthographic || numbers_after(json, "fov_deg", 1, &view->fov_deg);
}
