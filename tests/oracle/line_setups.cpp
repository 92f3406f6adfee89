#include "tests/oracle/line_setups.h"

namespace
{

const rgba orange = {1, 128 / 255.0, 32 / 255.0, 1},
           night = {16 / 255.0, 32 / 255.0, 64 / 255.0, 1};

line_pattern make_pattern(line_pattern_kind kind, double count, double duty, double rotation_deg,
                          double offset, double soft)
{
    line_pattern p;
    p.kind = kind;
    p.count = count;
    p.duty = duty;
    p.rotation_deg = rotation_deg;
    p.offset = offset;
    p.soft = soft;
    p.foreground = orange;
    p.background = night;
    return p;
}

/* 1 for a view from above, -1 for one from below. Lights are placed on that side. */
double side_seen(const view &view)
{
    return view.eye.z > view.target.z ? 1 : -1;
}

/* Lights with the size and place of sheen's default, but oblique. */
line_light make_light(const model &model, const view &view, line_light_kind kind,
                      const line_pattern &pattern)
{
    double r = 0.5 * model.diagonal();
    line_light light;
    light.kind = kind;
    double above = side_seen(view);
    light.centre = model.middle() + (above * r) * vec3{0.1, 0.2, 2};
    light.u = (16 * r) * normalized({1, 0.2, 0.1});
    light.v = (16 * r) * normalized({-0.1, 1, -0.2});
    light.pattern = pattern;
    if (kind == line_light_kind::tunnel) {
        light.centre = model.middle() + r * vec3{0.1, 0.2, 0.3};
        light.u = (3 * r) * normalized({0.2, 0.1, 1});
    } else if (kind == line_light_kind::sphere) {
        light.u = {0.2, 0.1, 1};
    }
    return light;
}

line_setup with_light(line_family family, const line_light &light)
{
    line_setup setup;
    setup.family = family;
    setup.lights = {light};
    return setup;
}

void add_reflections(const model &model, const view &view, std::vector<named_setup> *list)
{
    const line_family family = line_family::reflection;
    line_pattern stripes = make_pattern(line_pattern_kind::stripes, 40, 0.3, 25, 0.2, 0);
    line_pattern lattice = make_pattern(line_pattern_kind::lattice, 30, 0.2, -10, 0.4, 0.1);
    line_pattern circles = make_pattern(line_pattern_kind::circles, 12, 0.6, 0, 0.1, 0);
    line_pattern rainbow = make_pattern(line_pattern_kind::rainbow, 3, 0, 40, 0.3, 0);
    line_pattern distance = make_pattern(line_pattern_kind::distance, 0, 0.4, 0, 0.3, 0.2);
    distance.period = 0.3 * model.diagonal();
    auto add = [&](const char *name, line_light_kind kind, const line_pattern &pattern) {
        list->push_back({name, with_light(family, make_light(model, view, kind, pattern))});
    };
    add("rectangle stripes", line_light_kind::rectangle, stripes);
    add("plane distance", line_light_kind::plane, distance);
    add("tunnel lattice", line_light_kind::tunnel, lattice);
    add("sphere rainbow", line_light_kind::sphere, rainbow);
    line_light narrow = make_light(model, view, line_light_kind::tunnel, distance);
    narrow.centre = model.middle() + (0.8 * side_seen(view) * model.diagonal()) * vec3{0, 0, 1};
    narrow.u = 0.2 * narrow.u;
    list->push_back({"narrow tunnel distance", with_light(family, narrow)});

    line_setup two =
        with_light(family, make_light(model, view, line_light_kind::rectangle, circles));
    two.lights[0].one_sided = true;
    two.lights[0].u = 0.4 * two.lights[0].u;
    /* u x v must point away from the model, so that the light's front faces the model. */
    two.lights[0].v = (-0.4 * side_seen(view)) * two.lights[0].v;
    two.lights[0].pattern.opacity = 0.4;
    two.lights.push_back(make_light(model, view, line_light_kind::sphere, stripes));
    list->push_back({"two lights", two});
}

void add_highlights(const model &model, const view &view, std::vector<named_setup> *list)
{
    const line_family family = line_family::highlight;
    line_pattern lines = make_pattern(line_pattern_kind::lines, 0, 0, 15, 0, 0);
    lines.at = {0.3, 0.5, 0.62};
    lines.width = 0.05;
    line_pattern soft = make_pattern(line_pattern_kind::circles, 20, 0.3, 0, 0, 0.3);
    auto add = [&](const char *name, line_light_kind kind, const line_pattern &pattern) {
        list->push_back({name, with_light(family, make_light(model, view, kind, pattern))});
    };
    add("highlight rectangle", line_light_kind::rectangle, lines);
    add("highlight plane", line_light_kind::plane, soft);
    add("highlight tunnel", line_light_kind::tunnel, soft);
    lines.soft = 0.4;
    add("highlight sphere", line_light_kind::sphere, lines);
}

/* The families that use no light. */
void add_directions(const model &model, const view &view, std::vector<named_setup> *list)
{
    line_pattern stripes = make_pattern(line_pattern_kind::stripes, 24, 0.4, 0, 0.25, 0.2);
    stripes.opacity = 0.75;
    line_pattern lattice = make_pattern(line_pattern_kind::lattice, 0, 0.3, 30, 0, 0);
    lattice.period = 12; /* degrees */
    auto add = [&](const char *name, line_family family, vec3 axis, const line_pattern &pattern) {
        line_setup setup =
            with_light(family, make_light(model, view, line_light_kind::rectangle, pattern));
        setup.has_axis = length(axis) > 0;
        setup.axis = axis;
        list->push_back({name, setup});
    };
    add("isophote", line_family::isophote, {}, stripes);
    add("isophote axis", line_family::isophote, {0.3, -0.2, 2}, stripes);
    add("zebra", line_family::zebra, {}, stripes);
    add("zebra axis", line_family::zebra, {3, 0.4, -1}, lattice);
    add("environment", line_family::environment, {}, lattice);
    add("environment x", line_family::environment, {2, 0, 0}, lattice);
}

/* Computed for a fixed eye that is not the camera's. */
void add_locked(const model &model, const view &view, std::vector<named_setup> *list)
{
    line_pattern stripes = make_pattern(line_pattern_kind::stripes, 40, 0.5, 0, 0, 0);
    line_setup setup = with_light(line_family::reflection,
                                  make_light(model, view, line_light_kind::rectangle, stripes));
    setup.eye_kind = line_eye_kind::point;
    setup.eye = model.middle() + model.diagonal() * vec3{0.5, -1.5, 1.1 * side_seen(view)};
    list->push_back({"eye at a point", setup});
    setup.eye_kind = line_eye_kind::direction;
    setup.eye = {0.2, 1, -1.5 * side_seen(view)};
    list->push_back({"eye far away", setup});
    setup.family = line_family::isophote;
    list->push_back({"isophote, eye far away", setup});
}

} // namespace

std::vector<named_setup> line_setups(const model &model, const view &view)
{
    std::vector<named_setup> list;
    add_reflections(model, view, &list);
    add_highlights(model, view, &list);
    add_directions(model, view, &list);
    add_locked(model, view, &list);
    return list;
}
