/* test_deep: the tables near extraordinary vertices, at distances of 2^-10 to 2^-30 of a face,
 * against repeated local refinement in long double. The vertices have 3 to 50 faces; they are
 * smooth, on boundaries and creases, at the ends of creases, and sharp. Needs no GPU and no
 * libosd. */
#include <cmath>
#include <cstdio>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/fan.h"
#include "tests/oracle/local_surface.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

namespace
{

/* for vertices of up to 8 faces; of up to 50 */
const double max_normal_rad = 2e-6, max_normal_high_rad = 2e-5;
/* of the diagonal of a cage four units wide */
const double max_position = 1e-7;
/* Relative to the larger of the two curvatures. */
/* for vertices of up to 8 faces; of up to 50 */
const double max_curvature = 1e-4, max_curvature_high = 5e-4;
const int first_depth = 10, last_depth = 30;
const int max_sectors_tried = 8, places_per_ring = 4, cages_per_shape = 2;
const size_t min_places = 150;

struct figures {
    std::vector<double> normal_rad[4]; /* by level: 10-14, 15-19, 20-24, 25-30 */
    std::vector<double> curvature, position;
    size_t missing = 0;
    double worst_rad = 0;
    int worst_depth = 0;
};

void compare(const table_evaluator &tables, const local_surface &truth, uint32_t corner, int depth,
             double a, double b, figures *f)
{
    local_sample there;
    surface_point here;
    place at = {corner / 4, corner % 4, a, b};
    if (!truth.evaluate(corner, a, b, &there) || !tables.evaluate(at, &here)) {
        f->missing++;
        return;
    }
    f->position.push_back(length(here.p - there.p));
    double rad = angle(cross(here.du, here.dv), there.normal);
    f->normal_rad[std::min((depth - first_depth) / 5, 3)].push_back(rad);
    if (!(rad <= f->worst_rad)) {
        f->worst_rad = rad;
        f->worst_depth = depth;
    }
    curvatures k = principal_curvatures(here);
    double size = std::fmax(std::fabs(there.k.least), std::fabs(there.k.most));
    f->curvature.push_back(
        std::fmax(std::fabs(k.least - there.k.least), std::fabs(k.most - there.k.most)) / size);
}

void measure(const fan_shape &shape, uint64_t seed, figures *f)
{
    fan cage(shape, seed);
    table_evaluator tables(cage.cage);
    local_surface truth(cage.cage, 0, last_depth + 1);
    std::mt19937_64 random(seed + 1);
    std::uniform_real_distribution<double> unit(0, 1);
    int tried = std::min(shape.sectors, max_sectors_tried);
    for (int i = 0; i < tried; i++)
        for (int depth = first_depth; depth <= last_depth; depth++)
            for (int n = 0; n < places_per_ring; n++) {
                double outer = std::ldexp(0.5 + 0.5 * unit(random), -depth);
                double other = n == 0 ? 0 : outer * unit(random);
                bool swap = unit(random) < 0.5;
                uint32_t corner = cage.corner(i * shape.sectors / tried);
                compare(tables, truth, corner, depth, swap ? other : outer, swap ? outer : other,
                        f);
            }
}

void judge(const fan_shape &shape, verdict *verdict)
{
    figures f;
    for (int i = 0; i < (shape.sectors <= 8 ? cages_per_shape : 1); i++)
        measure(shape, 1000 * (uint64_t)shape.sectors + (uint64_t)i, &f);
    std::vector<double> all;
    std::printf("%-26s %3d |", shape.name.c_str(), shape.sectors);
    for (std::vector<double> &bin : f.normal_rad) {
        all.insert(all.end(), bin.begin(), bin.end());
        std::printf(" %7.1e", quantile(bin, 1));
    }
    double k_max = quantile(f.curvature, 1);
    std::printf(" | %7.1e | %7.1e %7.1e | %7.1e | %d\n", quantile(all, 0.999),
                quantile(f.curvature, 0.5), k_max, quantile(f.position, 1), f.worst_depth);
    std::string what = shape.name + " " + std::to_string(shape.sectors) + ": ";
    verdict->check(all.size() >= min_places, what + "too few places compared");
    verdict->check(f.missing == 0, what + std::to_string(f.missing) + " places without a surface");
    verdict->at_most(quantile(all, 1), shape.sectors <= 8 ? max_normal_rad : max_normal_high_rad,
                     what + "normal (rad)");
    verdict->at_most(quantile(f.position, 1), max_position, what + "position");
    verdict->at_most(k_max, shape.sectors <= 8 ? max_curvature : max_curvature_high,
                     what + "principal curvatures (relative)");
}

std::vector<fan_shape> list_shapes()
{
    const float sharp = CAGE_SHARPNESS_INFINITE;
    std::vector<fan_shape> shapes;
    for (int n : {3, 4, 5, 6, 7, 8, 12, 20, 50}) {
        if (n != 4)
            shapes.push_back({"smooth", n, true, {}, 0});
        shapes.push_back({"boundary", n, false, {}, 0});
        shapes.push_back({"sharp vertex on boundary", n, false, {}, sharp});
        shapes.push_back({"dart", n, true, {{0, sharp}}, 0});
        for (int k : std::set<int>{1, std::max(1, n / 3), n / 2})
            if (n != 4 || k != 2) /* these vertices are regular */
                shapes.push_back({"crease, sector of " + std::to_string(k),
                                  n,
                                  true,
                                  {{0, sharp}, {k, sharp}},
                                  0});
        shapes.push_back({"crease of 2.3", n, true, {{0, 2.3f}, {n / 2, 2.3f}}, 0});
        shapes.push_back({"crease of 1 to 4.5", n, true, {{0, 1}, {n / 2, 4.5f}}, 0});
        shapes.push_back({"dart of 3.5", n, true, {{1, 3.5f}}, 0});
        shapes.push_back({"vertex of 1.7", n, true, {}, 1.7f});
        shapes.push_back({"three creases", n, true, {{0, sharp}, {1, sharp}, {2, sharp}}, 0});
        shapes.push_back({"sharp vertex", n, true, {}, sharp});
    }
    shapes.push_back({"one-face corner", 1, false, {}, 0});
    return shapes;
}

} // namespace

int main()
{
    verdict verdict;
    std::printf("%-26s %3s | %31s | %7s | %15s | %7s | %s\n", "", "", "normal, rad, max at depth",
                "", "curvature, rel.", "", "worst");
    std::printf("%-26s %3s | %7s %7s %7s %7s | %7s | %7s %7s | %7s | %s\n", "vertex", "N", "10-14",
                "15-19", "20-24", "25-30", "p99.9", "p50", "max", "P", "depth");
    for (const fan_shape &shape : list_shapes()) {
        try {
            judge(shape, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, shape.name + ": " + failure.what());
        }
        std::fflush(stdout);
    }
    return verdict.finish();
}
