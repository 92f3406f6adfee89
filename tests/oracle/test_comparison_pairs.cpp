/* test_comparison_pairs: 40 pairs of surfaces, half of them with a change of twice the limit, half with noise of half of it:
 * server/curves/compare/comparison.h calls the first ones different, and the others not. */
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "tests/oracle/comparisons.h"
#include "tests/oracle/verdict.h"

extern "C" {
#include "server/surface/evaluate.h"
}

using namespace comparisons;

namespace
{

/* The largest ratio of a measure to its limit, by places of equal (u,v): exact to first order where vertices move along
 * normals. */
double change_by_places(const cage_surface &before, const cage_surface &after,
                        const comparison_setup &setup)
{
    double most = 0;
    const int n = 8;
    for (uint32_t face = 0; face < before.tables.n_faces; face++)
        for (int k = 0; k < n * n; k++) {
            limit_point a, b;
            double u = (k % n + 0.5) / n, v = (k / n + 0.5) / n;
            if (!limit_evaluate(&before.tables, face, u, v, &a) ||
                !limit_evaluate(&after.tables, face, u, v, &b))
                continue;
            double distance = std::fabs(vec_dot(vec_sub(b.s, a.s), a.n));
            double normal =
                std::atan2(vec_length(vec_cross(a.n, b.n)), vec_dot(a.n, b.n)) * 180 / M_PI;
            line_position from = line_position_at(&setup.lights[0], a.s, a.n);
            line_position to = line_position_at(&setup.lights[0], b.s, b.n);
            double lines = from.known && to.known && std::fmin(from.sine, to.sine) > 0.05
                               ? line_shift(&setup.lights[0], &from, &to)
                               : 0;
            most = std::fmax(most, std::fmax(distance / setup.limit[COMPARISON_DISTANCE],
                                             std::fmax(normal / setup.limit[COMPARISON_NORMAL],
                                                       lines / setup.limit[COMPARISON_LINES])));
        }
    return most;
}

/* The limit normal near each vertex of a cage: of a corner of a face that has it. */
std::vector<vec3> vertex_normals(const cage_surface &surface, const loose_cage &cage)
{
    std::vector<vec3> normals(cage.position.size());
    uint32_t ptex = 0;
    for (const std::vector<uint32_t> &face : cage.faces) {
        for (size_t k = 0; k < face.size(); k++) {
            const double us[4] = {0.01, 0.99, 0.99, 0.01}, vs[4] = {0.01, 0.01, 0.99, 0.99};
            bool is_quad = face.size() == 4;
            limit_point at;
            if (limit_evaluate(&surface.tables, is_quad ? ptex : ptex + (uint32_t)k,
                               is_quad ? us[k] : 0.01, is_quad ? vs[k] : 0.01, &at))
                normals[face[k]] = {at.n.x, at.n.y, at.n.z};
        }
        ptex += face.size() == 4 ? 1 : (uint32_t)face.size();
    }
    return normals;
}

/* Moves vertices along the surface's normals so that the largest change is `ratio` of its limit. */
void judge_pair(const loose_cage &cage, bool is_noise, unsigned seed, int *n_right,
                verdict *verdict)
{
    std::mt19937 random(seed);
    cage_surface before(cage);
    std::vector<vec3> normals = vertex_normals(before, cage);
    std::vector<double> amount(cage.position.size());
    std::normal_distribution<double> noise;
    if (is_noise)
        for (double &each : amount)
            each = noise(random);
    else
        amount[random() % amount.size()] = random() % 2 ? 1 : -1;
    double ratio = is_noise ? 0.5 : 2, scale = 1e-5 * before.size();
    comparison_setup setup = setup_of(before, before);
    for (int round = 0; round < 2; round++) { /* changes are nearly proportional to the scale */
        loose_cage moved = cage;
        for (size_t i = 0; i < amount.size(); i++)
            moved.position[i] = moved.position[i] + (scale * amount[i]) * normals[i];
        cage_surface after(moved);
        if (round == 0) {
            scale *= ratio / change_by_places(before, after, setup);
            continue;
        }
        comparison_result result = compare(setup_of(before, after));
        bool differs = false;
        for (int k = 0; k < COMPARISON_MEASURES; k++)
            differs |= worst(result, (comparison_measure)k) > setup.limit[k];
        *n_right += differs == !is_noise;
        verdict->check(differs == !is_noise, std::string(is_noise ? "noise" : "a change") +
                                                 " of seed " + std::to_string(seed) +
                                                 " was judged wrong");
    }
}

void judge_pairs(verdict *verdict)
{
    const std::vector<loose_cage> cages = {
        read_loose("tests/models/body.obj"), read_loose("tests/models/fender.obj"),
        read_loose("tests/models/ngons.obj"), torus(12, 0.7),
        sheet(8, [](int i, int j) { return 0.3 * std::sin(i) * std::cos(0.7 * j); })};
    int n_right = 0, n = 0;
    for (unsigned seed = 0; seed < 4; seed++)
        for (const loose_cage &cage : cages)
            for (bool is_noise : {false, true})
                judge_pair(cage, is_noise, 100 + (unsigned)n++, &n_right, verdict);
    std::printf("%d of %d pairs were judged right\n", n_right, n);
}

} // namespace

int main()
{
    verdict verdict;
    judge_pairs(&verdict);
    return verdict.finish();
}
