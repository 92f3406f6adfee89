#include "tests/oracle/area_setups.h"

#include <cmath>
#include <stdexcept>

#include <png.h>

namespace
{

const int n_patterns = 7, n_lights = 4;

struct box {
    vec3 middle;
    double radius;
};

/* A colour whose components are bytes. */
rgba any_colour(chance *chance)
{
    auto byte = [&] { return chance->below(256) / 255.0; };
    double alpha = chance->with(0.3) ? byte() : 1;
    rgba colour = {byte(), byte(), byte(), alpha};
    return chance->with(0.1) ? rgba{colour.r, colour.g, colour.b, 0} : colour;
}

/* From above, so that lights above are visible, and so near that the surface fills most of the
 * picture. */
view any_view(chance *chance, const box &box, int width_px, int height_px)
{
    view view;
    view.width_px = width_px;
    view.height_px = height_px;
    vec3 from = chance->direction();
    from.z = 0.15 + std::fabs(from.z);
    from = normalized(from);
    view.target = box.middle + (0.3 * box.radius) * chance->direction();
    view.up = normalized(vec3{0, 0, 1} + 0.3 * chance->direction());
    view.orthographic = chance->with(0.3);
    view.fov_deg = chance->between(8, 60);
    double height = chance->scaled(0.25, 1.8) * box.radius;
    view.ortho_height = height;
    double distance = 0.5 * height / std::tan(view.fov_deg * M_PI / 360);
    view.eye = view.target + std::fmax(distance, 1.3 * box.radius) * from;
    if (!view.orthographic && distance < 1.3 * box.radius)
        view.fov_deg = 360 / M_PI * std::atan(0.5 * height / (1.3 * box.radius));
    return view;
}

line_pattern any_pattern(chance *chance, line_pattern_kind kind, double width, double radius,
                         std::shared_ptr<const line_image> image)
{
    line_pattern p;
    p.kind = kind;
    p.count = chance->scaled(2, 400);
    if (kind == line_pattern_kind::rainbow)
        p.count = chance->scaled(1, 60);
    if (kind == line_pattern_kind::distance)
        p.period = chance->scaled(0.02, 2) * radius;
    else if (chance->with(0.3))
        p.period = width / p.count;
    p.duty = chance->between(0.05, 0.95);
    p.rotation_deg = chance->between(-180, 180);
    p.offset = chance->between(-1, 1);
    p.soft = chance->with(0.4) ? chance->between(0, 1) : 0;
    p.opacity = kind != line_pattern_kind::image && chance->with(0.3) ? chance->between(0.2, 1) : 1;
    p.at.clear();
    for (int n = 1 + chance->below(8); n > 0; n--)
        p.at.push_back(chance->between(0.2, 0.8));
    p.width = chance->scaled(0.001, 0.1);
    p.foreground = any_colour(chance);
    p.background = any_colour(chance);
    p.image = std::move(image);
    return p;
}

line_light any_light(chance *chance, line_light_kind kind, const box &box)
{
    double r = box.radius;
    line_light light;
    light.kind = kind;
    light.centre = box.middle + r * chance->direction() + vec3{0, 0, chance->between(1.5, 4) * r};
    vec3 u = normalized(vec3{1, 0, 0} + 0.7 * chance->direction());
    vec3 v = normalized(cross({0, 0, 1}, u) + 0.5 * chance->direction());
    light.u = chance->scaled(1, 16) * r * u;
    light.v = chance->scaled(1, 16) * r * v;
    light.one_sided = false;
    if (kind == line_light_kind::tunnel) {
        light.centre = box.middle + (0.5 * r) * chance->direction();
        light.u = chance->between(2, 5) * r * cross(u, v);
        light.v = chance->between(1, 5) * r * v;
    }
    return light;
}

line_family any_family(chance *chance)
{
    static const line_family rest[] = {line_family::highlight, line_family::isophote,
                                       line_family::zebra, line_family::environment};
    return chance->with(0.6) ? line_family::reflection : rest[chance->below(4)];
}

std::string colour_word(const rgba &colour)
{
    char text[16];
    auto byte = [](double part) { return (unsigned)std::lround(part * 255); };
    std::snprintf(text, sizeof text, "#%02x%02x%02x%02x", byte(colour.r), byte(colour.g),
                  byte(colour.b), byte(colour.a));
    return text;
}

} // namespace

vec3 chance::direction()
{
    double z = between(-1, 1), turn = between(0, 2 * M_PI), flat = std::sqrt(1 - z * z);
    return {flat * std::cos(turn), flat * std::sin(turn), z};
}

std::shared_ptr<const line_image> make_image(chance *chance, const std::string &path, bool opaque)
{
    auto image = std::make_shared<line_image>();
    image->path = path;
    image->width_px = 96;
    image->height_px = 64;
    const int patch = 8, across = image->width_px / patch;
    std::vector<rgba> patches;
    for (int i = across * image->height_px / patch; i > 0; i--)
        patches.push_back(any_colour(chance));
    std::vector<uint8_t> bytes;
    for (int i = 0; i < image->width_px * image->height_px; i++) {
        int x = i % image->width_px, y = i / image->width_px;
        rgba colour = chance->with(0.2) ? any_colour(chance)
                                        : patches[(size_t)(y / patch * across + x / patch)];
        colour.a = opaque ? 1 : colour.a;
        image->texels.push_back(to_light(colour));
        for (double part : {colour.r, colour.g, colour.b, colour.a})
            bytes.push_back((uint8_t)std::lround(255 * part));
    }
    png_image file = {};
    file.version = PNG_IMAGE_VERSION;
    file.width = (png_uint_32)image->width_px;
    file.height = (png_uint_32)image->height_px;
    file.format = PNG_FORMAT_RGBA;
    if (!png_image_write_to_file(&file, path.c_str(), 0, bytes.data(), 0, nullptr))
        throw std::runtime_error(path + ": " + file.message);
    return image;
}

area_setup make_area_setup(chance *chance, int number, vec3 box_min, vec3 box_max,
                           std::shared_ptr<const line_image> image, int width_px, int height_px)
{
    box box = {0.5 * (box_min + box_max), 0.5 * length(box_max - box_min)};
    area_setup setup;
    setup.camera = any_view(chance, box, width_px, height_px);
    setup.empty = any_colour(chance);
    setup.lines.miss = any_colour(chance);
    setup.lines.base = any_colour(chance);
    setup.lines.family = any_family(chance);
    setup.lines.has_axis = !setup.lines.meets_lights() && chance->with(0.5);
    setup.lines.axis = chance->direction();
    int n = 1 + chance->below(3);
    for (int i = 0; i < n; i++) {
        auto kind =
            (line_light_kind)(i == 0 ? number / n_patterns % n_lights : chance->below(n_lights));
        auto pattern =
            (line_pattern_kind)(i == 0 ? number % n_patterns : chance->below(n_patterns));
        bool far = kind == line_light_kind::sphere || !setup.lines.meets_lights();
        /* a light at infinity has no distance */
        if (far && pattern == line_pattern_kind::distance) {
            kind = line_light_kind::plane;
            setup.lines.family = line_family::reflection;
            setup.lines.has_axis = false;
        }
        line_light light = any_light(chance, kind, box);
        light.pattern =
            any_pattern(chance, pattern, far ? 360 : length(light.u), box.radius, image);
        setup.lines.lights.push_back(light);
    }
    return setup;
}

std::vector<std::string> area_setup::options() const
{
    std::vector<std::string> all = view_options(camera), lines_part = line_options(lines);
    all.insert(all.end(), lines_part.begin(), lines_part.end());
    all.insert(all.end(), {"--empty", colour_word(empty)});
    return all;
}
