/* A setup of lines as options of `sheen render`. */
#include <cstdio>

#include "tests/oracle/lines.h"

namespace
{

std::string number(double value)
{
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

std::string colour_name(const rgba &colour)
{
    char text[16];
    unsigned byte[4], n = 0;
    for (double part : {colour.r, colour.g, colour.b, colour.a})
        byte[n++] = (unsigned)(part * 255 + 0.5);
    std::snprintf(text, sizeof text, "#%02x%02x%02x%02x", byte[0], byte[1], byte[2], byte[3]);
    return text;
}

const char *family_name(line_family family)
{
    static const char *const names[] = {"reflection", "highlight", "isophote", "zebra",
                                        "environment"};
    return names[(int)family];
}

const char *light_name(line_light_kind kind)
{
    static const char *const names[] = {"rectangle", "plane", "tunnel", "sphere"};
    return names[(int)kind];
}

std::string pattern_option(const line_pattern &p)
{
    static const char *const names[] = {"stripes", "lattice",  "circles", "lines",
                                        "rainbow", "distance", "image"};
    std::string text = names[(int)p.kind];
    auto part = [&](const char *key, const std::string &value) {
        text += (text.find(':') == std::string::npos ? ":" : ",") + std::string(key) + "=" + value;
    };
    if (p.kind == line_pattern_kind::image)
        return text + ":" + p.image->path;
    part("rotation", number(p.rotation_deg));
    part("opacity", number(p.opacity));
    if (p.kind == line_pattern_kind::lines) {
        std::string places;
        for (double at : p.at)
            places += (places.empty() ? "" : "/") + number(at);
        part("at", places);
        part("width", number(p.width));
    } else {
        part(p.period > 0 ? "period" : "count", number(p.period > 0 ? p.period : p.count));
        part("offset", number(p.offset));
    }
    if (p.kind == line_pattern_kind::rainbow)
        return text;
    part("fg", colour_name(p.foreground));
    part("bg", colour_name(p.background));
    part("soft", number(p.soft));
    if (p.kind != line_pattern_kind::lines)
        part("duty", number(p.duty));
    return text;
}

} // namespace

std::vector<std::string> line_options(const line_setup &setup)
{
    std::vector<std::string> options = {
        "--lines",
        family_name(setup.family) + (setup.has_axis ? ":" + comma_separated(setup.axis) : ""),
        "--base",
        colour_name(setup.base),
        "--miss",
        colour_name(setup.miss)};
    auto add = [&](const char *name, const std::string &value) {
        options.push_back(name);
        options.push_back(value);
    };
    if (setup.eye_kind != line_eye_kind::camera)
        add("--line-eye", (setup.eye_kind == line_eye_kind::direction ? "dir:" : "") +
                              comma_separated(setup.eye));
    for (const line_light &light : setup.lights) {
        add("--light", light_name(light.kind) + std::string(light.one_sided ? ":one-sided" : ""));
        add("--light-center", comma_separated(light.centre));
        add("--light-u", comma_separated(light.u));
        add("--light-v", comma_separated(light.v));
        add("--pattern", pattern_option(light.pattern));
    }
    return options;
}
