#include "tests/oracle/lines.h"

#include <algorithm>
#include <cmath>

#include "tests/oracle/fault.h"
#include "tests/oracle/srgb.h"

namespace
{

const double degrees = 180 / M_PI;

/* Read once, because there are many samples. */
const bool duty_is_broken = has_fault("duty"), eye_is_broken = has_fault("eye"),
           isophote_is_broken = has_fault("isophote"), mirror_is_broken = has_fault("mirror"),
           side_is_broken = has_fault("side"), turn_is_broken = has_fault("turn");

vec3 without_part_along(vec3 v, vec3 unit)
{
    return v - dot(v, unit) * unit;
}

/* What counts as 0 by shaders/README.md, "Where rounding decides": a sine, and a ratio of
 * lengths. */
const double least_sine = 1e-6, least_share = std::ldexp(1, -21);

/* The angle of r from u about v, as a part of a full turn: (-1/2, 1/2]. */
double turn_about(vec3 r, vec3 u, vec3 v)
{
    vec3 axis = normalized(v);
    vec3 e1 = normalized(without_part_along(u, axis));
    if (length(cross(r, axis)) < least_sine * length(r))
        return 0;
    if (turn_is_broken)
        r = r + 1e-4 * e1;
    return std::atan2(dot(r, cross(axis, e1)), dot(r, e1)) / (2 * M_PI);
}

/* The elevation of unit r above the plane perpendicular to v, as a part of half a turn: [-1/2,
 * 1/2]. */
double elevation(vec3 r, vec3 v)
{
    vec3 axis = normalized(v);
    return std::atan2(dot(r, axis), length(cross(r, axis))) / M_PI;
}

/* The direction of azimuth 0 about an axis. */
vec3 azimuth_zero(vec3 axis)
{
    return std::fabs(axis.x) < 0.999 * length(axis) ? vec3{1, 0, 0} : vec3{0, 1, 0};
}

/* Meets the light's plane by the ray from x along r, or by the line in both directions. */
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
    /* u and v need not be perpendicular, so coordinates use the reciprocal vectors. */
    vec3 by_u = cross(light.v, normal), by_v = cross(normal, light.u);
    hit.s = 0.5 + dot(offset, by_u) / dot(light.u, by_u);
    hit.t = 0.5 + dot(offset, by_v) / dot(light.v, by_v);
    hit.tau = std::fabs(tau);
    bool bounded = light.kind == line_light_kind::rectangle;
    hit.s_ends = hit.t_ends = bounded;
    hit.inside = bounded ? std::min(std::min(hit.s, 1 - hit.s), std::min(hit.t, 1 - hit.t)) : 1;
    hit.met = std::fabs(approach) > least_sine && (both_ways || tau > 0) && hit.inside >= 0 &&
              !(light.one_sided && ahead >= 0);
    return hit;
}

/* The far side of the cylinder around the axis. */
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
    hit.tau = ((side_is_broken ? -1 : 1) * std::sqrt(root) - along) / sine;
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
    hit.t_ends = true;
    hit.s = 0.5 + turn_about(r, light.u, light.v);
    hit.t = 0.5 + elevation(r, light.v);
    hit.inside = 1;
    return hit;
}

light_hit isophote(vec3 n, vec3 d)
{
    light_hit hit;
    hit.met = true;
    hit.s = angle(n, d) / (isophote_is_broken ? M_PI * (1 + 1e-4) : M_PI);
    hit.t = 0.5;
    hit.width = 180;
    hit.height = 360;
    hit.s_ends = hit.t_ends = true;
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
    hit.s_ends = true;
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
    hit.t_ends = true;
    hit.inside = 1;
    return hit;
}

/* The length of the bright part of phases [0, phase). */
double bright_until(double phase, double duty)
{
    double whole = std::floor(phase);
    return whole * duty + std::min(phase - whole, duty);
}

/* The wave at a phase, convolved with a box of width `soft`. */
double wave(double phase, const line_pattern &pattern)
{
    if (pattern.soft == 0)
        return phase - std::floor(phase) < pattern.duty + (duty_is_broken ? 0.01 : 0) ? 1 : 0;
    double low = phase - pattern.soft / 2, high = phase + pattern.soft / 2;
    return (bright_until(high, pattern.duty) - bright_until(low, pattern.duty)) / pattern.soft;
}

/* The brightness of a line at this distance from its middle. */
double single_line(double distance, const line_pattern &pattern)
{
    double soft = pattern.soft * pattern.width, inside = pattern.width / 2 - distance;
    return soft > 0 ? std::clamp(inside / soft + 0.5, 0.0, 1.0) : inside > 0;
}

/* A hue with full saturation and value. */
rgba hue_colour(double hue)
{
    auto ramp = [&](double shift) {
        double h = 6 * (hue + shift - std::floor(hue + shift));
        return std::clamp(std::fabs(h - 3) - 1, 0.0, 1.0);
    };
    return {ramp(0), ramp(2.0 / 3), ramp(1.0 / 3), 1};
}

/* Both colours are premultiplied. */
rgba over(const rgba &top, const rgba &below)
{
    double share = 1 - top.a;
    return {top.r + share * below.r, top.g + share * below.g, top.b + share * below.b,
            top.a + share * below.a};
}

/* A place in a pattern, by the directions of its periods: across its lines, and along them. */
struct pattern_place {
    double across, along;
};

/* In the light's units from the light's middle, rotated by the pattern's rotation. */
pattern_place turned_place(const line_pattern &p, const light_hit &hit)
{
    double q = p.rotation_deg / degrees;
    double x = (hit.s - 0.5) * hit.width, y = (hit.t - 0.5) * hit.height;
    return {std::cos(q) * x + std::sin(q) * y, std::cos(q) * y - std::sin(q) * x};
}

double period_of(const line_pattern &p, const light_hit &hit)
{
    if (p.period > 0)
        return p.period;
    return p.kind == line_pattern_kind::circles ? std::min(hit.width, hit.height) / (2 * p.count)
                                                : hit.width / p.count;
}

double bright_share(const line_pattern &p, const light_hit &hit)
{
    pattern_place place = turned_place(p, hit);
    double period = period_of(p, hit);
    double across = place.across / period + hit.width / (2 * period) + p.offset;
    double along = place.along / period + hit.height / (2 * period) + p.offset;
    switch (p.kind) {
    case line_pattern_kind::stripes:
        return wave(across, p);
    case line_pattern_kind::lattice:
        return 1 - (1 - wave(across, p)) * (1 - wave(along, p));
    case line_pattern_kind::circles:
        return wave(std::hypot(place.across, place.along) / period + p.offset, p);
    case line_pattern_kind::lines: {
        double sum = 0;
        for (double at : p.at)
            sum += single_line(std::fabs(place.across / hit.width + 0.5 - at), p);
        return std::min(sum, 1.0);
    }
    case line_pattern_kind::distance:
        return wave(hit.tau / period + p.offset, p);
    case line_pattern_kind::rainbow:
    case line_pattern_kind::image:
        break;
    }
    return across; /* rainbow: its hue */
}

/* The index of the texel at i, which may lie beyond the n texels: clamped, or repeated. */
int texel_index(int i, int n, bool ends)
{
    return ends ? std::clamp(i, 0, n - 1) : ((i % n) + n) % n;
}

rgba image_colour(const line_pattern &p, const light_hit &hit)
{
    const line_image &image = *p.image;
    double column = hit.s * image.width_px - 0.5, row = (1 - hit.t) * image.height_px - 0.5;
    double left = std::floor(column), top = std::floor(row);
    auto texel = [&](int i, int j) -> const rgba & {
        int across = texel_index((int)left + i, image.width_px, hit.s_ends);
        int down = texel_index((int)top + j, image.height_px, hit.t_ends);
        return image.texels[(size_t)(down * image.width_px + across)];
    };
    return mixed(mixed(texel(0, 0), texel(1, 0), column - left),
                 mixed(texel(0, 1), texel(1, 1), column - left), row - top);
}

} // namespace

rgba mixed(const rgba &a, const rgba &b, double b_share)
{
    auto mix = [&](double x, double y) { return x + b_share * (y - x); };
    return {mix(a.r, b.r), mix(a.g, b.g), mix(a.b, b.b), mix(a.a, b.a)};
}

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

rgba pattern_colour(const line_pattern &pattern, const light_hit &hit)
{
    if (pattern.kind == line_pattern_kind::image)
        return image_colour(pattern, hit);
    double share = bright_share(pattern, hit);
    if (pattern.kind == line_pattern_kind::rainbow)
        return hue_colour(share);
    return mixed(to_light(pattern.background), to_light(pattern.foreground), share);
}

double pattern_distance(const line_pattern &p, const light_hit &a, const light_hit &b)
{
    light_hit near = b; /* the same place by the shorter way around the light */
    near.s = a.s - coordinate_difference(a.s, b.s, b.s_wraps);
    near.t = a.t - coordinate_difference(a.t, b.t, b.t_wraps);
    pattern_place from = turned_place(p, a), to = turned_place(p, near);
    double period = period_of(p, a), across = std::fabs(to.across - from.across);
    switch (p.kind) {
    case line_pattern_kind::lattice:
    case line_pattern_kind::circles:
        return std::hypot(across, to.along - from.along) / period;
    case line_pattern_kind::lines:
        return across / (p.width * a.width);
    case line_pattern_kind::distance:
        return std::fabs(b.tau - a.tau) / period;
    case line_pattern_kind::image:
        return std::hypot((near.s - a.s) * p.image->width_px, (near.t - a.t) * p.image->height_px);
    case line_pattern_kind::stripes:
    case line_pattern_kind::rainbow:
        break;
    }
    return across / period;
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
    base_light = to_light(setup.base);
    miss_light = to_light(setup.miss);
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
    if (eye_is_broken)
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
    if (mirror_is_broken)
        r = r + 1e-4 * n;
    switch (setup.family) {
    case line_family::isophote:
        return isophote(n, setup.has_axis ? setup.axis : -1 * v);
    case line_family::zebra:
        return zebra(r, setup.has_axis ? setup.axis : camera_up);
    case line_family::environment:
        return environment(r, setup.has_axis ? setup.axis : camera_up);
    case line_family::highlight: /* of the two directions, the one that faces the eye */
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

rgba line_tracer::light(vec3 x, vec3 n, unsigned *met) const
{
    rgba light = {0, 0, 0, 0};
    *met = 0;
    double shade = 0.3 + 0.7 * std::fabs(dot(n, view_from_camera(x)));
    rgba base = {base_light.r * shade, base_light.g * shade, base_light.b * shade, base_light.a};
    for (size_t i = 0; i < setup.lights.size(); i++) {
        const line_light &each = setup.lights[i];
        light_hit hit = meet(x, n, each);
        if (!hit.met)
            continue;
        *met |= 1u << i;
        light = over(light, mixed(base, pattern_colour(each.pattern, hit), each.pattern.opacity));
    }
    return *met ? light : miss_light;
}

rgba line_tracer::colour(vec3 x, vec3 n) const
{
    unsigned met;
    rgba light = this->light(x, n, &met);
    return met ? to_displayed(light) : setup.miss;
}
