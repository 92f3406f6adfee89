/* test_line_position: server/curves/line_position.h against lines.h, which has the same formulas from another hand:
 * every family, light and line eye with random places and points. The density of lines is compared with shifts over
 * short steps along a paraboloid. */
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/oracle/lines.h"
#include "tests/oracle/product_lines.h"
#include "tests/oracle/verdict.h"

namespace
{

const int n_setups = 600, n_points = 50;
const double max_place_error = 1e-11;  /* s and t, times the sine with where they have no value */
const double max_shift_error = 1e-9;   /* spacings, in the same way */
const double max_density_error = 1e-4; /* relative; 180 directions alone make 4e-5 */

struct random_numbers {
    std::mt19937 source{19};
    double within(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(source);
    }
    vec3 vector(double size)
    {
        return {within(-size, size), within(-size, size), within(-size, size)};
    }
    unsigned below(unsigned n)
    {
        return (unsigned)(source() % n);
    }
};

line_setup random_setup(random_numbers *random)
{
    line_setup setup;
    setup.family = (line_family)random->below(5);
    setup.has_axis = setup.family != line_family::isophote || random->below(2);
    setup.axis = random->vector(1);
    setup.eye_kind = random->below(2) ? line_eye_kind::point : line_eye_kind::direction;
    setup.eye = random->vector(20);
    line_light light;
    light.kind = (line_light_kind)random->below(4);
    bool is_flat = light.kind == line_light_kind::rectangle || light.kind == line_light_kind::plane;
    light.one_sided = is_flat && random->below(4) == 0;
    light.centre = random->vector(is_flat ? 30 : 3);
    light.u = random->vector(20);
    light.v = random->vector(20);
    const line_pattern_kind kinds[] = {line_pattern_kind::stripes, line_pattern_kind::lattice,
                                       line_pattern_kind::circles, line_pattern_kind::rainbow,
                                       line_pattern_kind::distance};
    light.pattern.kind = kinds[random->below(5)];
    light.pattern.rotation_deg = random->below(2) ? random->within(-90, 90) : 0;
    light.pattern.period = random->below(2) ? random->within(0.1, 5) : 0;
    setup.lights = {light};
    return setup;
}

product_setup for_product(const line_setup &setup)
{
    const line_light &light = setup.lights[0];
    product_setup to;
    to.family = (int)setup.family;
    to.light_kind = (int)light.kind;
    to.pattern_kind = (int)light.pattern.kind;
    to.has_axis = setup.has_axis;
    to.eye_is_point = setup.eye_kind == line_eye_kind::point;
    to.one_sided = light.one_sided;
    to.axis = setup.axis;
    to.eye = setup.eye;
    to.centre = light.centre;
    to.u = light.u;
    to.v = light.v;
    to.count = light.pattern.count;
    to.period = light.pattern.period;
    to.rotation_deg = light.pattern.rotation_deg;
    return to;
}

struct figures {
    size_t n_met = 0, n_shifts = 0, n_densities = 0, n_differ = 0;
    double place = 0, shift = 0, density = 0;
};

/* The shift from x in the direction that the paraboloid z = (h0 p^2 + h1 q^2) / 2 over the tangents takes. */
double shift_along(const product_lines &product, vec3 x, vec3 n, const vec3 e[2], const double h[2],
                   double p, double q)
{
    product_place ends[2];
    for (int k = 0; k < 2; k++) {
        double way = k ? 1 : -1, a = way * p, b = way * q;
        vec3 at = x + a * e[0] + b * e[1] + (0.5 * (h[0] * a * a + h[1] * b * b)) * n;
        ends[k] = product.at(at, normalized(n - (h[0] * a) * e[0] - (h[1] * b) * e[1]));
        if (!ends[k].known)
            return NAN;
    }
    return product.shift(ends[0], ends[1]);
}

/* The density is the largest shift for a length over all directions. */
void judge_density(const product_lines &product, vec3 x, vec3 n, random_numbers *random, figures *f)
{
    const vec3 e0 = normalized(cross(n, std::fabs(n.x) < 0.7 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
    const vec3 e[2] = {e0, cross(n, e0)};
    const double h[2] = {random->within(-0.5, 0.5), random->within(-0.5, 0.5)};
    const vec3 turn[2] = {-h[0] * e[0], -h[1] * e[1]};
    const double step = 1e-5;
    double most = 0;
    for (int i = 0; i < 180; i++) {
        double angle = i * M_PI / 180;
        double shift =
            shift_along(product, x, n, e, h, step * std::cos(angle), step * std::sin(angle));
        if (!(shift < 0.3))
            return;
        most = std::fmax(most, shift / (2 * step));
    }
    double density = product.density(x, n, e, turn);
    if (density < 1e-3)
        return;
    f->n_densities++;
    f->density = std::fmax(f->density, std::fabs(density / most - 1));
}

void judge_setup(random_numbers *random, figures *f)
{
    line_setup setup = random_setup(random);
    view camera;
    camera.eye = {0, 0, 30};
    camera.up = {0, 1, 0};
    line_tracer tracer(setup, camera);
    product_lines product(for_product(setup));
    const line_light &light = setup.lights[0];
    light_hit before;
    product_place place_before = {};
    for (int i = 0; i < n_points; i++) {
        vec3 x = random->vector(5), n = normalized(random->vector(1));
        light_hit hit = tracer.meet(x, n, light);
        product_place place = product.at(x, n);
        f->n_differ += hit.met != place.met;
        if (!hit.met || !place.met || place.sine < 1e-3)
            continue;
        f->n_met++;
        double s = coordinate_difference(place.s, hit.s, hit.s_wraps);
        double t = coordinate_difference(place.t, hit.t, hit.t_wraps);
        double size = 1 + std::fabs(hit.s) + std::fabs(hit.t);
        f->place = std::fmax(f->place, place.sine * std::hypot(s, t) / size);
        if (before.met && light.pattern.kind != line_pattern_kind::image) {
            double is = product.shift(place_before, place);
            double size_shift = 1 + pattern_distance(light.pattern, before, hit);
            f->shift = std::fmax(f->shift, std::fmin(place.sine, place_before.sine) *
                                               std::fabs(is + 1 - size_shift) / size_shift);
            f->n_shifts++;
        }
        before = hit;
        place_before = place;
        bool is_straight = light.pattern.kind == line_pattern_kind::stripes;
        if (is_straight && place.sine > 0.1)
            judge_density(product, x, n, random, f);
    }
}

} // namespace

int main()
{
    verdict verdict;
    random_numbers random;
    figures f;
    for (int i = 0; i < n_setups; i++)
        judge_setup(&random, &f);
    std::printf("%zu places off by %.1e, %zu shifts by %.1e, %zu densities by %.1e; %zu met on one "
                "side only\n",
                f.n_met, f.place, f.n_shifts, f.shift, f.n_densities, f.density, f.n_differ);
    verdict.check(f.n_met > 15000 && f.n_shifts > 10000 && f.n_densities > 1500, "too few points");
    verdict.check(f.n_differ == 0, "a light is met on one side only");
    verdict.at_most(f.place, max_place_error, "places on lights");
    verdict.at_most(f.shift, max_shift_error, "shifts");
    verdict.at_most(f.density, max_density_error, "densities");
    return verdict.finish();
}
