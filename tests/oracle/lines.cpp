#include "tests/oracle/lines.h"

#include <algorithm>
#include <cmath>

#include "tests/oracle/fault.h"
#include "tests/oracle/srgb.h"

namespace
{

const double degrees = 180 / M_PI;

vec3 without_part_along(vec3 v, vec3 unit)
{
    return v - dot(v, unit) * unit;
}

/* What shaders/README.md, "Where rounding decides", takes for 0: a sine, and a share of lengths. */
const double least_sine = 1e-6, least_share = std::ldexp(1, -21);

/* The angle of r from u about v, over a full turn: (-1/2, 1/2]. */
double turn_about(vec3 r, vec3 u, vec3 v)
{
    vec3 axis = normalized(v);
    vec3 e1 = normalized(without_part_along(u, axis));
    if (length(cross(r, axis)) < least_sine * length(r))
        return 0;
    if (has_fault("turn"))
        r = r + 1e-4 * e1;
    return std::atan2(dot(r, cross(axis, e1)), dot(r, e1)) / (2 * M_PI);
}

/* The elevation of unit r over the plane across v, over half a turn: [-1/2, 1/2]. */
double elevation(vec3 r, vec3 v)
{
    vec3 axis = normalized(v);
    return std::atan2(dot(r, axis), length(cross(r, axis))) / M_PI;
}

/* Where azimuths about an axis begin. */
vec3 azimuth_zero(vec3 axis)
{
    return std::fabs(axis.x) < 0.999 * length(axis) ? vec3{1, 0, 0} : vec3{0, 1, 0};
}

/* The ray from x along r, or the line both ways, against the light's plane. */
light_hit meet_plane(vec3 x, vec3 r, bool both_ways, vec3 eye, const line_light &light)
{
    light_hit hit;
    hit.width = length(light.u);
    hit.height = length(light.v);
    vec3 normal = normalized(cross(light.u, light.v));
    double ahead = dot(normal, light.centre - x), approach = dot(normal, r);
    double noise = least_share * (std::fabs(dot(normal, light.centre - eye)) + length(x - eye));
    ahead = std::fabs(ahead) <= noise ? 0 : ahead;
    double tau = ahead / approach;
    vec3 offset = x + tau * r - light.centre;
    /* u and v need not be perpendicular: coordinates by the reciprocal vectors. */
    vec3 by_u = cross(light.v, normal), by_v = cross(normal, light.u);
    hit.s = 0.5 + dot(offset, by_u) / dot(light.u, by_u);
    hit.t = 0.5 + dot(offset, by_v) / dot(light.v, by_v);
    hit.tau = std::fabs(tau);
    bool bounded = light.kind == line_light_kind::rectangle;
    hit.inside = bounded ? std::min(std::min(hit.s, 1 - hit.s), std::min(hit.t, 1 - hit.t)) : 1;
    hit.met = std::fabs(approach) > least_sine && (both_ways || tau > 0) && hit.inside >= 0 &&
              !(light.one_sided && ahead >= 0);
    return hit;
}

/* The far side of the cylinder about the axis. */
light_hit meet_tunnel(vec3 x, vec3 r, const line_light &light)
{
    light_hit hit;
    vec3 axis = normalized(light.v), from = x - light.centre;
    vec3 p = without_part_along(from, axis), q = without_part_along(r, axis);
    double radius = length(without_part_along(light.u, axis));
    double sine = length(q), along = dot(p, q) / sine, pass = length(cross(p, q)) / sine;
    double root = (radius - pass) * (radius + pass);
    hit.width = 2 * M_PI * radius;
    hit.height = length(light.v);
    hit.s_wraps = true;
    hit.inside = root / (radius * radius);
    if (!(root >= 0 && sine >= least_sine))
        return hit;
    hit.tau = ((has_fault("side") ? -1 : 1) * std::sqrt(root) - along) / sine;
    hit.met = hit.tau > 0;
    vec3 y = from + hit.tau * r;
    hit.s = 0.5 + turn_about(y, light.u, light.v);
    hit.t = 0.5 + dot(y, light.v) / dot(light.v, light.v);
    return hit;
}

light_hit meet_sphere(vec3 r, const line_light &light)
{
    light_hit hit;
    hit.met = true;
    hit.width = 360;
    hit.height = 180;
    hit.s_wraps = true;
    hit.s = 0.5 + turn_about(r, light.u, light.v);
    hit.t = 0.5 + elevation(r, light.v);
    hit.inside = 1;
    return hit;
}

light_hit isophote(vec3 n, vec3 d)
{
    light_hit hit;
    hit.met = true;
    hit.s = angle(n, d) / (has_fault("isophote") ? M_PI * (1 + 1e-4) : M_PI);
    hit.t = 0.5;
    hit.width = 180;
    hit.height = 360;
    hit.inside = 1;
    return hit;
}

light_hit zebra(vec3 r, vec3 axis)
{
    light_hit hit;
    hit.met = true;
    hit.s = 0.5 + elevation(r, axis);
    hit.t = 0.5 + turn_about(r, azimuth_zero(axis), axis);
    hit.width = 180;
    hit.height = 360;
    hit.t_wraps = true;
    hit.inside = 1;
    return hit;
}

light_hit environment(vec3 r, vec3 axis)
{
    light_hit hit;
    hit.met = true;
    hit.s = 0.5 - turn_about(r, azimuth_zero(axis), axis);
    hit.t = 0.5 + elevation(r, axis);
    hit.width = 360;
    hit.height = 180;
    hit.s_wraps = true;
    hit.inside = 1;
    return hit;
}

/* How much of phases [0, phase) is bright. */
double bright_until(double phase, double duty)
{
    double whole = std::floor(phase);
    return whole * duty + std::min(phase - whole, duty);
}

/* The wave at a phase, convolved with a box as wide as `soft` says. */
double wave(double phase, const line_pattern &pattern)
{
    if (pattern.soft == 0)
        return phase - std::floor(phase) < pattern.duty + (has_fault("duty") ? 0.01 : 0) ? 1 : 0;
    double low = phase - pattern.soft / 2, high = phase + pattern.soft / 2;
    return (bright_until(high, pattern.duty) - bright_until(low, pattern.duty)) / pattern.soft;
}

/* How bright a line is so far from its middle. */
double single_line(double distance, const line_pattern &pattern)
{
    double soft = pattern.soft * pattern.width, inside = pattern.width / 2 - distance;
    return soft > 0 ? std::clamp(inside / soft + 0.5, 0.0, 1.0) : inside > 0;
}

/* Full saturation and value. */
rgba hue_colour(double hue)
{
    auto ramp = [&](double shift) {
        double h = 6 * (hue + shift - std::floor(hue + shift));
        return std::clamp(std::fabs(h - 3) - 1, 0.0, 1.0);
    };
    return {ramp(0), ramp(2.0 / 3), ramp(1.0 / 3), 1};
}

rgba mixed(const rgba &a, const rgba &b, double b_share)
{
    auto mix = [&](double x, double y) { return x + b_share * (y - x); };
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), mix(a.a, b.a)};
}

/* Both premultiplied. */
rgba over(const rgba &top, const rgba &below)
{
    double share = 1 - top.a;
    return {top.r + share * below.r, top.g + share * below.g, top.b + share * below.b,
            top.a + share * below.a};
}

/* From displayed and straight to light, and back. */
rgba to_light(const rgba &c)
{
    return {c.a * light_of(c.r), c.a * light_of(c.g), c.a * light_of(c.b), c.a};
}

rgba to_displayed(const rgba &c)
{
    if (!(c.a > 0))
        return {0, 0, 0, 0};
    return {displayed_of(c.r / c.a), displayed_of(c.g / c.a), displayed_of(c.b / c.a), c.a};
}

double bright_share(const line_pattern &p, const light_hit &hit)
{
    double q = p.rotation_deg / degrees;
    double x = (hit.s - 0.5) * hit.width, y = (hit.t - 0.5) * hit.height;
    double a = std::cos(q) * x + std::sin(q) * y, b = std::cos(q) * y - std::sin(q) * x;
    double period = p.period > 0 ? p.period : hit.width / p.count;
    double along_a = a / period + hit.width / (2 * period) + p.offset;
    double along_b = b / period + hit.height / (2 * period) + p.offset;
    switch (p.kind) {
    case line_pattern_kind::stripes:
        return wave(along_a, p);
    case line_pattern_kind::lattice:
        return 1 - (1 - wave(along_a, p)) * (1 - wave(along_b, p));
    case line_pattern_kind::circles:
        if (!(p.period > 0))
            period = std::min(hit.width, hit.height) / (2 * p.count);
        return wave(std::hypot(x, y) / period + p.offset, p);
    case line_pattern_kind::lines: {
        double sum = 0;
        for (double at : p.at)
            sum += single_line(std::fabs(a / hit.width + 0.5 - at), p);
        return std::min(sum, 1.0);
    }
    case line_pattern_kind::distance:
        return wave(hit.tau / period + p.offset, p);
    case line_pattern_kind::rainbow:
        break;
    }
    return along_a; /* rainbow: its hue */
}

} // namespace

rgba pattern_colour(const line_pattern &pattern, const light_hit &hit)
{
    double share = bright_share(pattern, hit);
    if (pattern.kind == line_pattern_kind::rainbow)
        return hue_colour(share);
    return mixed(to_light(pattern.background), to_light(pattern.foreground), share);
}

double coordinate_difference(double a, double b, bool wraps)
{
    return wraps ? a - b - std::round(a - b) : a - b;
}

line_tracer::line_tracer(const line_setup &line_setup, const view &view)
    : setup(line_setup), camera(view)
{
    forward = normalized(view.target - view.eye);
    camera_up = normalized(view.up);
}

vec3 line_tracer::view_from_camera(vec3 x) const
{
    return camera.orthographic ? forward : normalized(x - camera.eye);
}

double line_tracer::eye_noise(vec3 x) const
{
    if (setup.eye_kind != line_eye_kind::point)
        return camera.orthographic || setup.eye_kind != line_eye_kind::camera ? 0 : least_share;
    double reach = length(x - camera.eye) + length(setup.eye - camera.eye);
    return least_share * reach / length(x - setup.eye);
}

vec3 line_tracer::sight(vec3 x, vec3 n) const
{
    if (has_fault("eye"))
        return view_from_camera(x);
    switch (setup.eye_kind) {
    case line_eye_kind::point:
        return eye_noise(x) < 1 ? normalized(x - setup.eye) : -1 * n;
    case line_eye_kind::direction:
        return normalized(setup.eye);
    case line_eye_kind::camera:
        break;
    }
    return view_from_camera(x);
}

light_hit line_tracer::meet_along(vec3 v, vec3 x, vec3 n, const line_light &light) const
{
    vec3 r = v - (2 * dot(v, n)) * n;
    if (has_fault("mirror"))
        r = r + 1e-4 * n;
    switch (setup.family) {
    case line_family::isophote:
        return isophote(n, setup.has_axis ? setup.axis : -1 * v);
    case line_family::zebra:
        return zebra(r, setup.has_axis ? setup.axis : camera_up);
    case line_family::environment:
        return environment(r, setup.has_axis ? setup.axis : camera_up);
    case line_family::highlight: /* of the two ways, the one that faces the eye */
        r = dot(v, n) >= std::fmax(least_sine, eye_noise(x)) ? -1 * n : n;
        break;
    case line_family::reflection:
        break;
    }
    if (light.kind == line_light_kind::tunnel)
        return meet_tunnel(x, r, light);
    if (light.kind == line_light_kind::sphere)
        return meet_sphere(r, light);
    return meet_plane(x, r, setup.family == line_family::highlight, camera.eye, light);
}

bool line_tracer::at_turn(vec3 x, vec3 n) const
{
    return setup.family == line_family::highlight && std::fabs(dot(sight(x, n), n)) < 1e-4;
}

rgba line_tracer::colour(vec3 x, vec3 n) const
{
    rgba colour = {0, 0, 0, 0};
    bool any = false;
    double shade = 0.3 + 0.7 * std::fabs(dot(n, view_from_camera(x)));
    rgba base = to_light(setup.base);
    base = {base.r * shade, base.g * shade, base.b * shade, base.a};
    for (const line_light &light : setup.lights) {
        light_hit hit = meet(x, n, light);
        if (!hit.met)
            continue;
        any = true;
        colour =
            over(colour, mixed(base, pattern_colour(light.pattern, hit), light.pattern.opacity));
    }
    return any ? to_displayed(colour) : setup.miss;
}
