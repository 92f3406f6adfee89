/* test_lines SHEEN MODEL...: families, lights, patterns and line eyes against the formulas of
 * shaders/README.md in double precision. Light coordinates are judged twice: on the frame's own P
 * and N, and on libosd's surface at the frame's (face, u, v). Their change over a pixel is judged
 * by differences on libosd's surface, colours as single samples. */
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/frame_loop.h"
#include "tests/oracle/line_setups.h"
#include "tests/oracle/lines.h"
#include "tests/oracle/solve.h"

namespace
{

const int width_px = 320, height_px = 240;
/* Of a light's width or height; where a turn of the normal moves lines further than that, by that
 * turn in radians. */
const double max_formula_error = 6e-7;
const double max_surface_p999 = 1e-6;
const double max_change_p999 = 1e-3; /* relative */
const double max_locked_p999 = 1e-6;
/* Differences are not judged where a pixel spans this share of a light or more (at silhouettes and
 * horizons), nor where a quarter of the step changes them by more than `settled` (beside
 * extraordinary vertices and creases). Both are rare. */
const double max_change = 0.25, settled = 2e-5;
const double min_change = 1e-3; /* 1000 pixels from one border of the light to the other */
const double max_unsettled = 0.03;
const double step_px = 0.002;   /* of the differences */
const double edge_width = 1e-5; /* within this distance of an edge, both colours are right */
/* share of pixels; near a place where edges meet, the colour of one side may be absent */
const double max_wrong_colours = 2e-4;
const double rounding = 0.6 / 255; /* of a colour */

/* Libosd's surface around one pixel: at the pixel's (face, u, v); one step to the left, right, up
 * and down; and the same with a quarter of the step. */
struct surroundings {
    bool at_centre = false, about = false;
    vec3 p[9], n[9];
};

surroundings look_about(const model &model, const projector &camera, const planes &planes, size_t i)
{
    surroundings around;
    double u = planes.u[i], v = planes.v[i];
    osd_sample sample;
    if (!osd_oracle_is_exact(u, v) || !model.oracle->evaluate(planes.face[i], u, v, &sample) ||
        !sample.has_normal())
        return around;
    around.at_centre = around.about = true;
    around.p[0] = sample.p;
    around.n[0] = sample.normal();
    /* The steps are made around the surface's own point: at silhouettes, lines change within the
     * hundredth of a pixel by which that point may miss the pixel's centre. */
    projected at = camera.project(sample.p);
    for (int k = 0; k < 8 && around.about; k++) {
        double step = (k < 4 ? step_px : step_px / 4) * (k % 2 ? 1 : -1);
        double dx = k % 4 < 2 ? step : 0, dy = k % 4 < 2 ? 0 : step;
        around.about = solve_ray(*model.oracle, camera, at.x + dx, at.y + dy, 4, planes.face[i], u,
                                 v, &sample) &&
                       sample.has_normal();
        around.p[k + 1] = sample.p;
        around.n[k + 1] = sample.normal();
    }
    return around;
}

struct figures {
    size_t hit = 0, met = 0, wrong_miss = 0, wrong_colour = 0, judged_colours = 0, unsettled = 0;
    double formula = 0;
    std::vector<double> surface, change;
};

/* The distance between two places on a light. */
double apart(double s, double t, const light_hit &hit)
{
    return std::hypot(coordinate_difference(s, hit.s, hit.s_wraps),
                      coordinate_difference(t, hit.t, hit.t_wraps));
}

/* How far the place on the light moves when the normal turns, in 1/rad; at least 1. */
double sensitivity(const line_tracer &tracer, vec3 p, vec3 n, const light_hit &hit)
{
    const double turn = 1e-6;
    vec3 h = normalized(cross(n, std::fabs(n.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
    double sum = 0;
    for (vec3 side : {h, cross(n, h)}) {
        light_hit moved = tracer.meet(p, normalized(n + turn * side), tracer.setup.lights[0]);
        sum += apart(moved.s, moved.t, hit) / turn;
    }
    return std::fmax(1, sum);
}

/* The change of the light coordinates over a pixel, by central differences of the points from
 * `first` on. */
bool change_by_differences(const line_tracer &tracer, const surroundings &around, int first,
                           double step, double change[4])
{
    light_hit at[4];
    for (int k = 0; k < 4; k++) {
        at[k] = tracer.meet(around.p[first + k], around.n[first + k], tracer.setup.lights[0]);
        if (!at[k].met)
            return false;
    }
    for (int k = 0; k < 2; k++) {
        const light_hit &low = at[2 * k], &high = at[2 * k + 1];
        change[k] = coordinate_difference(high.s, low.s, low.s_wraps) / (2 * step);
        change[k + 2] = coordinate_difference(high.t, low.t, low.t_wraps) / (2 * step);
    }
    return true;
}

/* As a share of the change, or of the smallest change that affects any pattern. */
double relative_difference(const double a[4], const double b[4])
{
    double off = 0, size = min_change;
    for (int k = 0; k < 4; k++) {
        off = std::hypot(off, a[k] - b[k]);
        size = std::hypot(size, b[k]);
    }
    return off / size;
}

void measure_change(const line_tracer &tracer, const surroundings &around, const planes &planes,
                    size_t i, figures *f)
{
    double coarse[4], expected[4];
    if (!around.about || !change_by_differences(tracer, around, 1, step_px, coarse) ||
        !change_by_differences(tracer, around, 5, step_px / 4, expected))
        return;
    const double found[4] = {planes.dsdx[i], planes.dsdy[i], planes.dtdx[i], planes.dtdy[i]};
    double size = std::hypot(std::hypot(found[0], found[1]), std::hypot(found[2], found[3]));
    if (size > max_change)
        return;
    if (relative_difference(coarse, expected) > settled)
        f->unsettled++;
    else
        f->change.push_back(relative_difference(found, expected));
}

/* The colour must lie between the colours at places so near that single precision cannot
 * distinguish them. */
void measure_colour(const line_tracer &tracer, const planes &planes, size_t i, double turn,
                    figures *f)
{
    vec3 n = planes.normal(i), p = planes.position(i);
    vec3 h = normalized(cross(n, std::fabs(n.x) < 0.6 ? vec3{1, 0, 0} : vec3{0, 1, 0}));
    vec3 k = cross(n, h);
    double low[3] = {2, 2, 2}, high[3] = {-1, -1, -1};
    for (vec3 side : {vec3{}, h, -1 * h, k, -1 * k}) {
        rgba c = tracer.colour(p, normalized(n + turn * side));
        const double part[3] = {c.r, c.g, c.b};
        for (int j = 0; j < 3; j++) {
            low[j] = std::fmin(low[j], part[j]);
            high[j] = std::fmax(high[j], part[j]);
        }
    }
    const float found[3] = {planes.red[i], planes.green[i], planes.blue[i]};
    f->judged_colours += high[0] - low[0] + high[1] - low[1] + high[2] - low[2] < 0.1;
    for (int j = 0; j < 3; j++)
        if (!(found[j] >= low[j] - rounding && found[j] <= high[j] + rounding)) {
            f->wrong_colour++;
            std::printf("%zu %d: %g not in %g %g (x255)  base %g\n", i, j, found[j] * 255.,
                        low[j] * 255., high[j] * 255, 0.0);
            return;
        }
}

figures measure(const line_tracer &tracer, const std::vector<surroundings> &around,
                const planes &planes)
{
    figures f;
    const line_light &light = tracer.setup.lights[0];
    for (size_t i = 0; i < planes.face.size(); i++) {
        if (!planes.hit(i))
            continue;
        f.hit++;
        vec3 p = planes.position(i), n = planes.normal(i);
        light_hit hit = tracer.meet(p, n, light);
        double k = sensitivity(tracer, p, n, hit);
        bool found = std::isfinite(planes.s[i]) && std::isfinite(planes.t[i]);
        if (std::fabs(hit.inside) < edge_width * k || !(k < 1e4) || tracer.at_turn(p, n))
            continue;
        f.wrong_miss += found != hit.met;
        if (found && hit.met) {
            f.met++;
            f.formula = std::fmax(f.formula, apart(planes.s[i], planes.t[i], hit) / k);
            light_hit truth = tracer.meet(around[i].p[0], around[i].n[0], light);
            if (around[i].at_centre && truth.met)
                f.surface.push_back(apart(planes.s[i], planes.t[i], truth) / k);
            measure_change(tracer, around[i], planes, i, &f);
        }
        if (k < 100) /* else many lines lie within the width that is not judged */
            measure_colour(tracer, planes, i, edge_width, &f);
    }
    return f;
}

void judge(const model &model, const view &view, const named_setup &named,
           const std::vector<surroundings> &around, const planes &planes, verdict *verdict)
{
    figures f = measure(line_tracer(named.setup, view), around, planes);
    double surface = quantile(f.surface, 0.999), change = quantile(f.change, 0.999);
    std::printf("%-14s %-6s %-22s %6zu %6zu | %7.1e | %7.1e | %7.1e %7.1e %5zu | %6zu %4zu\n",
                model.name.c_str(), view.name.c_str(), named.name.c_str(), f.hit, f.met, f.formula,
                surface, quantile(f.change, 0.5), change, f.unsettled, f.judged_colours,
                f.wrong_colour);
    std::string what = model.name + " " + view.name + " " + named.name + ": ";
    verdict->check(f.met >= 500, what + "only " + std::to_string(f.met) + " pixels meet the light");
    verdict->check(2 * f.change.size() >= f.met, what + "too few changes to judge");
    verdict->at_most((double)f.unsettled / (double)f.met, max_unsettled,
                     what + "share of pixels whose changes say nothing");
    verdict->check(2 * f.judged_colours >= f.hit, what + "too few colours to judge");
    verdict->check(f.wrong_miss == 0,
                   what + std::to_string(f.wrong_miss) + " pixels on the wrong side of a border");
    verdict->at_most(f.formula, max_formula_error, what + "(s,t) of P and N");
    verdict->at_most(
        surface, named.locked() && named.setup.meets_lights() ? max_locked_p999 : max_surface_p999,
        what + "(s,t) of the surface p99.9");
    verdict->at_most(change, max_change_p999, what + "change of (s,t) p99.9");
    verdict->check((double)f.wrong_colour <= max_wrong_colours * (double)f.judged_colours,
                   what + std::to_string(f.wrong_colour) + " pixels of the wrong colour");
}

/* Every setup, or every second one, from the given one on. */
void judge_view(const std::string &sheen, const model &model, view view, size_t from, size_t stride,
                verdict *verdict)
{
    std::vector<surroundings> around;
    std::vector<named_setup> setups = line_setups(model, view);
    for (size_t k = from; k < setups.size(); k += stride) {
        const named_setup &named = setups[k];
        std::vector<std::string> options = line_options(named.setup);
        options.insert(options.end(), {"--filter", "off"});
        planes planes;
        int exit_code;
        std::string wrong = render_view(sheen, model.path, &view, "P,N,ptex,light,dlight", options,
                                        &planes, &exit_code);
        if (!verdict->check(wrong.empty(), named.name + ": " + wrong))
            continue;
        if (around.empty()) { /* all frames of this view have the same surface */
            around.resize(planes.face.size());
            for (size_t i = 0; i < around.size(); i++)
                if (planes.hit(i))
                    around[i] = look_about(model, projector(view), planes, i);
        }
        judge(model, view, named, around, planes, verdict);
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 3) {
        std::fprintf(stderr, "usage: test_lines SHEEN MODEL...\n");
        return 2;
    }
    verdict verdict;
    std::printf("%-14s %-6s %-22s %6s %6s | %7s | %7s | %21s | %s\n", "model", "view", "lines",
                "hit", "met", "formula", "surface", "change p50 99.9 left", "colours wrong");
    size_t stride = 1;
    for (const std::string &path : list_models(std::vector<std::string>(argv + 2, argv + argc))) {
        model model = read_model(path);
        std::vector<view> views = model_views(model, width_px, height_px);
        /* All setups in both views for the first model; in one of the views for the others. */
        judge_view(argv[1], model, views[1], 0, stride, &verdict);
        judge_view(argv[1], model, views[2], stride - 1, stride, &verdict);
        stride = 2;
        std::fflush(stdout);
    }
    return verdict.finish();
}
