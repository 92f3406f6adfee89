#include "tests/oracle/product_lines.h"

extern "C" {
#include "server/curves/line_position.h"
}

struct product_lines::implementation {
    line_map map;
};

namespace
{

vec in_c(vec3 v)
{
    return {v.x, v.y, v.z};
}

void write(vec3 v, double out[3])
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

line_position in_c(const product_place &place)
{
    return {place.met, place.known, place.s, place.t, place.tau, place.sine};
}

/* By the order of line_pattern_kind in lines.h. */
const pattern_kind pattern_kinds[] = {PATTERN_STRIPES, PATTERN_LATTICE, PATTERN_CIRCLES,
                                      PATTERN_LINES,   PATTERN_RAINBOW, PATTERN_DISTANCE,
                                      PATTERN_IMAGE};

} // namespace

product_lines::product_lines(const product_setup &setup) : m(new implementation)
{
    lines lines = {};
    lines.family = (line_family)setup.family;
    lines.has_direction = setup.has_axis;
    write(setup.axis, lines.direction);
    lines.eye_kind = setup.eye_is_point ? LINE_EYE_POINT : LINE_EYE_DIRECTION;
    write(setup.eye, lines.eye);
    light light = {};
    light.kind = (light_kind)setup.light_kind;
    light.one_sided = setup.one_sided;
    write(setup.centre, light.centre);
    write(setup.u, light.u);
    write(setup.v, light.v);
    light.pattern.kind = pattern_kinds[setup.pattern_kind];
    light.pattern.count = setup.count;
    light.pattern.period = setup.period;
    light.pattern.rotation_deg = setup.rotation_deg;
    line_map_init(&m->map, &lines, &light);
}

product_lines::~product_lines() = default;

product_place product_lines::at(vec3 x, vec3 n) const
{
    line_position place = line_position_at(&m->map, in_c(x), in_c(n));
    return {place.met, place.known, place.s, place.t, place.tau, place.sine};
}

double product_lines::shift(const product_place &from, const product_place &to) const
{
    line_position a = in_c(from), b = in_c(to);
    return line_shift(&m->map, &a, &b);
}

double product_lines::density(vec3 x, vec3 n, const vec3 along[2], const vec3 turn[2]) const
{
    const vec tangents[2] = {in_c(along[0]), in_c(along[1])};
    const vec turns[2] = {in_c(turn[0]), in_c(turn[1])};
    return line_density(&m->map, in_c(x), in_c(n), tangents, turns);
}
