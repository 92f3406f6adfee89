#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <numeric>
#include <random>

#include "tests/oracle/comparisons.h"

extern "C" {
#include "server/surface/subdivision/build.h"
}

namespace comparisons
{

cage_surface::cage_surface(const loose_cage &parts)
{
    solid_cage solid(parts);
    error error = {};
    limit_plan *plan = limit_plan_create(&solid.cage, nullptr, &error);
    if (!plan || !limit_tables_init_on_demand(&tables, limit_plan_size(plan), &error) ||
        !limit_build_faces(&tables, plan, 0, tables.n_faces, nullptr, &error)) {
        std::fprintf(stderr, "%s\n", error.text);
        std::exit(2);
    }
    limit_plan_destroy(plan);
}

cage_surface::~cage_surface()
{
    limit_tables_finish(&tables);
}

double cage_surface::size() const
{
    return std::sqrt(std::pow(tables.box_max[0] - tables.box_min[0], 2) +
                     std::pow(tables.box_max[1] - tables.box_min[1], 2) +
                     std::pow(tables.box_max[2] - tables.box_min[2], 2));
}

comparison_setup setup_of(const cage_surface &before, const cage_surface &after)
{
    comparison_setup setup = {};
    setup.tables[0] = &before.tables;
    setup.tables[1] = &after.tables;
    setup.limit[COMPARISON_DISTANCE] = 1e-5 * before.size();
    setup.limit[COMPARISON_NORMAL] = 0.05;
    setup.limit[COMPARISON_LINES] = 0.1;
    setup.limit[COMPARISON_LINE_LENGTH] = setup.limit[COMPARISON_CURVATURE] =
        std::numeric_limits<double>::infinity();
    setup.n_samples = 20000;
    setup.most_bytes = 300 << 20;
    double size = before.size();
    lines lines = {};
    lines.eye_kind = LINE_EYE_POINT;
    light light = {};
    light.kind = LIGHT_TUNNEL;
    light.pattern.count = 40;
    for (int k = 0; k < 3; k++) {
        double middle = 0.5 * (before.tables.box_min[k] + before.tables.box_max[k]);
        lines.eye[k] = middle + (k == 0 ? 1.5 : k == 1 ? -1 : 2) * size;
        light.centre[k] = middle;
        light.u[k] = (k == 2) * 1.5 * size;
        light.v[k] = (k == 0) * size;
    }
    setup.n_lights = 1;
    line_map_init(&setup.lights[0], &lines, &light);
    return setup;
}

comparison_result compare(const comparison_setup &setup)
{
    error error = {};
    computation *computation = comparison_create(&setup, &error);
    if (!computation || !computation_run(computation, &error)) {
        std::fprintf(stderr, "%s\n", error.text);
        std::exit(2);
    }
    comparison_result result = *comparison_read(computation);
    computation_destroy(computation);
    return result;
}

comparison_result compare(const loose_cage &before, const loose_cage &after)
{
    cage_surface a(before), b(after);
    return compare(setup_of(a, b));
}

double worst(const comparison_result &result, comparison_measure measure)
{
    double most = 0;
    for (const comparison_result_side &side : result.side)
        if (side.figures[measure].is_known)
            most = std::fmax(most, std::fabs(side.figures[measure].worst));
    return most;
}

double uncovered(const comparison_result &result)
{
    return result.side[0].area_uncovered + result.side[1].area_uncovered;
}

/* --- cages */

loose_cage read_loose(const std::string &path)
{
    return loose_cage(*read_cage_file(path));
}

loose_cage renumbered(const loose_cage &from, unsigned seed)
{
    std::mt19937 random(seed);
    loose_cage to = from;
    std::vector<uint32_t> number(from.position.size());
    std::iota(number.begin(), number.end(), 0u);
    std::shuffle(number.begin(), number.end(), random);
    for (size_t i = 0; i < number.size(); i++)
        to.position[number[i]] = from.position[i];
    for (std::vector<uint32_t> &face : to.faces) {
        std::rotate(face.begin(), face.begin() + random() % (long)face.size(), face.end());
        for (uint32_t &vertex : face)
            vertex = number[vertex];
    }
    for (cage_crease &crease : to.creases)
        for (uint32_t &vertex : crease.vertex)
            vertex = number[vertex];
    for (cage_corner &corner : to.corners)
        corner.vertex = number[corner.vertex];
    if (from.holes.empty())
        std::shuffle(to.faces.begin(), to.faces.end(), random);
    return to;
}

loose_cage rewound(const loose_cage &from)
{
    loose_cage to = from;
    for (std::vector<uint32_t> &face : to.faces)
        std::reverse(face.begin(), face.end());
    return to;
}

namespace
{

using edge = std::pair<uint32_t, uint32_t>;

edge edge_of(uint32_t a, uint32_t b)
{
    return {std::min(a, b), std::max(a, b)};
}

} // namespace

loose_cage refined(const loose_cage &from)
{
    size_t n = from.position.size();
    std::vector<vec3> face_sum(n), edge_sum(n);
    std::vector<double> valence(n);
    std::map<edge, std::vector<vec3>> beside; /* the face points at an edge */
    std::map<edge, uint32_t> number;
    loose_cage to;
    to.position = from.position;
    for (const std::vector<uint32_t> &face : from.faces) {
        vec3 middle;
        for (uint32_t vertex : face)
            middle = middle + (1.0 / (double)face.size()) * from.position[vertex];
        to.position.push_back(middle);
        for (size_t k = 0; k < face.size(); k++) {
            beside[edge_of(face[k], face[(k + 1) % face.size()])].push_back(middle);
            face_sum[face[k]] = face_sum[face[k]] + middle;
            valence[face[k]]++;
        }
    }
    for (const auto &[ends, middles] : beside) {
        vec3 a = from.position[ends.first], b = from.position[ends.second];
        number[ends] = (uint32_t)to.position.size();
        to.position.push_back(0.25 * (a + b + middles.at(0) + middles.at(1)));
        edge_sum[ends.first] = edge_sum[ends.first] + b;
        edge_sum[ends.second] = edge_sum[ends.second] + a;
    }
    for (size_t i = 0; i < n; i++) {
        double k = valence[i];
        to.position[i] =
            ((k - 2) / k) * from.position[i] + (1 / (k * k)) * (edge_sum[i] + face_sum[i]);
    }
    for (size_t f = 0; f < from.faces.size(); f++) {
        const std::vector<uint32_t> &face = from.faces[f];
        size_t m = face.size();
        for (size_t k = 0; k < m; k++)
            to.faces.push_back({face[k], number[edge_of(face[k], face[(k + 1) % m])],
                                (uint32_t)(n + f),
                                number[edge_of(face[(k + m - 1) % m], face[k])]});
    }
    return to;
}

loose_cage torus(int n, double r)
{
    double step = 2 * M_PI / n, out = 3 / (2 + std::cos(step));
    loose_cage cage;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double a = i * step, b = j * step, far = out * (2 + out * r * std::cos(b));
            cage.position.push_back({far * std::cos(a), far * std::sin(a), out * r * std::sin(b)});
        }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            int i2 = (i + 1) % n, j2 = (j + 1) % n;
            cage.faces.push_back({(uint32_t)(i * n + j), (uint32_t)(i2 * n + j),
                                  (uint32_t)(i2 * n + j2), (uint32_t)(i * n + j2)});
        }
    return cage;
}

loose_cage disc(int n, int rings)
{
    loose_cage cage;
    cage.position.push_back({0, 0, 0});
    for (int ring = 1; ring <= rings; ring++)
        for (int k = 0; k < 2 * n; k++) {
            double a = k * M_PI / n, r = ring == 1 && k % 2 ? 1.3 : ring;
            cage.position.push_back({r * std::cos(a), r * std::sin(a), 0});
        }
    auto at = [&](int ring, int k) { return (uint32_t)(1 + (ring - 1) * 2 * n + k % (2 * n)); };
    for (int k = 0; k < n; k++)
        cage.faces.push_back({0, at(1, 2 * k), at(1, 2 * k + 1), at(1, 2 * k + 2)});
    for (int ring = 1; ring < rings; ring++)
        for (int k = 0; k < 2 * n; k++)
            cage.faces.push_back(
                {at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)});
    return cage;
}

loose_cage turned(loose_cage cage, vec3 axis, double angle_deg, vec3 shift)
{
    double s = std::sin(angle_deg * M_PI / 180), c = std::cos(angle_deg * M_PI / 180);
    vec3 a = normalized(axis);
    for (vec3 &p : cage.position)
        p = c * p + s * cross(a, p) + ((1 - c) * dot(a, p)) * a + shift;
    return cage;
}

} // namespace comparisons
