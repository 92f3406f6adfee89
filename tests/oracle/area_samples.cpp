#include "tests/oracle/area_samples.h"

#include <cmath>

namespace
{

const size_t side = area_samples_side;

/* Neighbouring samples belong to one sheet if neither lies further off the other's tangent plane
 * than this, in px (on a smooth surface only third derivatives contribute to that distance), and if
 * their normals differ by no larger angle, in rad. */
const double most_off_px = 0.05, most_turn = 0.3;

void add(const rgba &light, double share, rgba *sum)
{
    *sum = {sum->r + share * light.r, sum->g + share * light.g, sum->b + share * light.b,
            sum->a + share * light.a};
}

class sampler
{
  public:
    sampler(const surface_grid &surface_grid, const area_setup &area_setup)
        : grid(surface_grid), setup(area_setup), tracer(setup.lines, setup.camera),
          empty(to_light(setup.empty))
    {
        const view &view = setup.camera;
        double tangent = std::tan(view.fov_deg * M_PI / 360);
        forward = normalized(view.target - view.eye);
        height_per_depth = view.orthographic ? 0 : 2 * tangent / view.height_px;
        height = view.orthographic ? view.ortho_height / view.height_px : 0;
    }

    area_sample of_pixel(size_t x, size_t y) const
    {
        area_sample sample = {};
        sample.light = {0, 0, 0, 0};
        unsigned always = ~0u;
        size_t n_hit = 0;
        for (size_t j = 0; j < side; j++)
            for (size_t i = 0; i < side; i++) {
                size_t at = (y * side + j) * grid.width + x * side + i;
                bool is_hit = grid.hit(at);
                unsigned met = 0;
                rgba light =
                    is_hit ? tracer.light(grid.position(at), grid.normal(at), &met) : empty;
                add(light, 1.0 / (side * side), &sample.light);
                n_hit += is_hit;
                sample.met |= met;
                always &= is_hit ? met : ~0u;
                sample.at_edge |= !is_hit || (i > 0 && is_apart(at, at - 1)) ||
                                  (j > 0 && is_apart(at, at - grid.width));
            }
        for (size_t j : {side / 4, 3 * side / 4})
            for (size_t i : {side / 4, 3 * side / 4}) {
                size_t at = (y * side + j) * grid.width + x * side + i;
                sample.step = std::fmax(sample.step, step(at, at + 1));
                sample.step = std::fmax(sample.step, step(at, at + grid.width));
            }
        sample.coverage = (double)n_hit / (side * side);
        sample.partly = sample.met & ~always;
        return sample;
    }

  private:
    double step(size_t a, size_t b) const
    {
        double most = 0;
        for (const line_light &light : setup.lines.lights) {
            if (!grid.hit(a) || !grid.hit(b))
                break;
            light_hit here = tracer.meet(grid.position(a), grid.normal(a), light);
            light_hit there = tracer.meet(grid.position(b), grid.normal(b), light);
            if (here.met && there.met)
                most = std::fmax(most, pattern_distance(light.pattern, here, there));
        }
        return most;
    }

    bool is_apart(size_t a, size_t b) const
    {
        if (!grid.hit(a) || !grid.hit(b))
            return true;
        vec3 n = grid.normal(a), m = grid.normal(b), d = grid.position(b) - grid.position(a);
        double px = height + height_per_depth * dot(grid.position(a) - setup.camera.eye, forward);
        return std::fabs(dot(d, n + m)) > 2 * most_off_px * px ||
               !(dot(n, m) > std::cos(most_turn));
    }

    const surface_grid &grid;
    const area_setup &setup;
    line_tracer tracer;
    rgba empty;
    vec3 forward;
    /* a pixel's height: height_per_depth times its depth, plus height; in units */
    double height_per_depth, height;
};

} // namespace

std::vector<area_sample> sample_areas(const surface_grid &grid, const area_setup &setup)
{
    std::vector<area_sample> samples;
    sampler sampler(grid, setup);
    for (int i = 0; i < setup.camera.width_px * setup.camera.height_px; i++)
        samples.push_back(sampler.of_pixel((size_t)(i % setup.camera.width_px),
                                           (size_t)(i / setup.camera.width_px)));
    return samples;
}
