#include "tests/oracle/exactness.h"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace
{

/* The bounds by which the project defines "exact". */
const double max_normal_p999_rad = 2e-6;
const double max_position_p999 = 1e-6; /* of the bounding diagonal */
const double max_residual_p999_px = 0.01;
const double max_residual_px = 0.2;
/* Of k.min and k.max, relative to the larger of the curvature and 1/diagonal. */
const double max_curvature_p999 = 1e-4;
const double max_length_error = 5e-7; /* of a unit normal in single precision */
const size_t min_hit_px = 1000;

struct figures {
    size_t hit = 0, near_corner = 0;
    size_t bad_ptex = 0; /* the face does not exist, (u,v) lies outside of it, or it is a hole */
    /* P or N is not finite where the pixel hits, or finite where it does not */
    size_t bad_value = 0;
    size_t backwards = 0; /* angle of N to the face's winding */
    std::vector<double> normal_rad, position, curvature, residual_px, length_error;
    /* angle of N to the normal by the CPU's evaluator of the same tables at (face,u,v) */
    std::vector<double> tables_rad;
};

/* The shaders' descent and evaluation, against the same in double precision on the CPU. */
void measure_against_tables(const table_evaluator &tables, const planes &planes, size_t i,
                            figures *figures)
{
    surface_point point;
    bool found = tables.evaluate(planes.face[i], planes.u[i], planes.v[i], &point);
    if (found && point.has_normal() && osd_oracle_is_exact(planes.u[i], planes.v[i]))
        figures->tables_rad.push_back(angle(planes.normal(i), point.normal()));
}

/* Difference of the pixel's principal curvatures from those of the sample. */
double curvature_difference(const model &model, const planes &planes, size_t i,
                            const osd_sample &truth)
{
    curvatures k = principal_curvatures(truth);
    double size = std::fmax(std::fmax(std::fabs(k.least), std::fabs(k.most)), 1 / model.diagonal());
    double off = std::fmax(std::fabs((double)planes.k_min[i] - k.least),
                           std::fabs((double)planes.k_max[i] - k.most));
    return off / size;
}

void measure_against_oracle(const model &model, const planes &planes, size_t i, figures *figures)
{
    osd_sample truth;
    if (!model.oracle->evaluate(planes.face[i], planes.u[i], planes.v[i], &truth)) {
        figures->bad_ptex++;
        return;
    }
    if (!osd_oracle_is_exact(planes.u[i], planes.v[i])) {
        figures->near_corner++;
        return;
    }
    figures->position.push_back(length(planes.position(i) - truth.p) / model.diagonal());
    if (!truth.has_normal())
        return;
    vec3 normal = truth.normal();
    figures->normal_rad.push_back(angle(planes.normal(i), normal));
    figures->backwards += dot(planes.normal(i), normal) <= 0;
    figures->curvature.push_back(curvature_difference(model, planes, i, truth));
}

/* How far single precision alone may move P away from its pixel, in px: half a unit in the last
 * place of each world coordinate. It matters in close views of models far from the origin. */
double rounding_px(const projector &camera, vec3 p, projected q)
{
    const vec3 half_ulp[3] = {
        {std::ldexp(p.x, -24), 0, 0}, {0, std::ldexp(p.y, -24), 0}, {0, 0, std::ldexp(p.z, -24)}};
    double sum = 0;
    for (vec3 step : half_ulp) {
        projected moved = camera.project(p + step);
        sum += std::hypot(moved.x - q.x, moved.y - q.y);
    }
    return sum;
}

figures measure(const model &model, const table_evaluator &tables, const view &view,
                const planes &planes)
{
    figures figures;
    projector camera(view);
    for (int y = 0; y < view.height_px; y++)
        for (int x = 0; x < view.width_px; x++) {
            size_t i = (size_t)y * (size_t)view.width_px + (size_t)x;
            bool valued = finite(planes.position(i)) && finite(planes.normal(i));
            figures.bad_value += valued != planes.hit(i);
            if (!planes.hit(i) || !valued)
                continue;
            figures.hit++;
            projected q = camera.project(planes.position(i));
            double off_px = std::hypot(q.x - (x + 0.5), q.y - (y + 0.5));
            figures.residual_px.push_back(
                std::fmax(0, off_px - rounding_px(camera, planes.position(i), q)));
            figures.length_error.push_back(std::fabs(length(planes.normal(i)) - 1));
            measure_against_oracle(model, planes, i, &figures);
            measure_against_tables(tables, planes, i, &figures);
        }
    return figures;
}

} // namespace

void print_exactness_header()
{
    std::printf("%-28s %-8s %7s %5s | %31s | %15s | %15s | %15s | %7s | %7s\n", "", "", "", "near",
                "angle of N to libosd's, rad", "|P-P'|/diagonal", "k, relative", "P off pixel, px",
                "||N|-1|", "N, CPU");
    std::printf("%-28s %-8s %7s %5s | %7s %7s %7s %7s | %7s %7s | %7s %7s | %7s %7s | %7s | %7s\n",
                "model", "view", "hit px", "EV px", "p50", "p99", "p99.9", "max", "p99.9", "max",
                "p99.9", "max", "p99.9", "max", "max", "p99.9");
}

void judge_exactness(const model &model, const table_evaluator &tables, const view &view,
                     const planes &planes, verdict *verdict)
{
    figures f = measure(model, tables, view, planes);
    double tables999 = quantile(f.tables_rad, 0.999);
    double n999 = quantile(f.normal_rad, 0.999), p999 = quantile(f.position, 0.999);
    double k999 = quantile(f.curvature, 0.999);
    double r999 = quantile(f.residual_px, 0.999), r_max = quantile(f.residual_px, 1);
    double unit = quantile(f.length_error, 1);
    std::printf("%-28s %-8s %7zu %5zu | %7.1e %7.1e %7.1e %7.1e | %7.1e %7.1e | %7.1e %7.1e | "
                "%7.1e %7.1e | %7.1e | %7.1e\n",
                model.name.c_str(), view.name.c_str(), f.hit, f.near_corner,
                quantile(f.normal_rad, 0.5), quantile(f.normal_rad, 0.99), n999,
                quantile(f.normal_rad, 1), p999, quantile(f.position, 1), k999,
                quantile(f.curvature, 1), r999, r_max, unit, tables999);
    std::string what = model.name + " " + view.name + ": ";
    verdict->check(f.hit >= min_hit_px, what + "only " + std::to_string(f.hit) + " pixels hit");
    verdict->check(2 * f.normal_rad.size() >= f.hit,
                   what + "fewer than half the pixels could be compared");
    verdict->check(f.bad_ptex == 0,
                   what + std::to_string(f.bad_ptex) + " pixels with no surface at (face,u,v)");
    verdict->check(f.bad_value == 0,
                   what + std::to_string(f.bad_value) + " pixels where hit, P and N disagree");
    verdict->check(f.backwards == 0,
                   what + std::to_string(f.backwards) + " normals against the winding");
    verdict->at_most(n999, max_normal_p999_rad, what + "normal p99.9 (rad)");
    verdict->at_most(tables999, max_normal_p999_rad, what + "normal to the tables' p99.9 (rad)");
    verdict->at_most(p999, max_position_p999, what + "position p99.9 (diagonals)");
    verdict->at_most(k999, max_curvature_p999, what + "curvature p99.9 (relative)");
    verdict->at_most(r999, max_residual_p999_px, what + "residual p99.9 (px)");
    verdict->at_most(r_max, max_residual_px, what + "residual max (px)");
    verdict->at_most(unit, max_length_error, what + "| |N| - 1 |");
}
