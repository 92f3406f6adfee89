/* test_comparison [CAR.obj]: server/curves/compare/comparison.h against closed forms: equal surfaces from different files, parallel
 * surfaces, a moved vertex, a rotated body, a missing face. */
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "tests/oracle/comparisons.h"
#include "tests/oracle/verdict.h"

using namespace comparisons;

namespace
{

const double normal_floor_deg = 1e-5; /* of 99 % of the area; the rest: result.normal_floor_deg */

/* --- equal surfaces ------------------------------------------------------------------------------ */

void judge_equal(const std::string &name, const loose_cage &cage, bool is_smooth, verdict *verdict)
{
    cage_surface before(cage);
    comparison_result same = compare(setup_of(before, before));
    for (int k = 0; k < COMPARISON_MEASURES; k++) {
        double most = worst(same, (comparison_measure)k);
        verdict->check(most == 0, name + ": the same file differs");
    }
    verdict->check(uncovered(same) == 0 && !same.is_rewound,
                   name + ": the same file is not covered");
    struct twin {
        const char *what;
        loose_cage cage;
        bool is_rewound;
    };
    std::vector<twin> twins = {{"renumbered", renumbered(cage, 5), false}};
    if (cage.holes.empty())
        twins.push_back({"rewound", rewound(cage), true});
    if (is_smooth)
        twins.push_back({"refined", refined(cage), false});
    for (const twin &twin : twins) {
        cage_surface after(twin.cage);
        comparison_result result = compare(setup_of(before, after));
        double p99 = std::fmax(result.side[0].figures[COMPARISON_NORMAL].p99,
                               result.side[1].figures[COMPARISON_NORMAL].p99);
        std::printf("%-10s %-10s distance %.1e (floor %.1e), normals %.1e, p99 %.1e, lines %.1e\n",
                    name.c_str(), twin.what, worst(result, COMPARISON_DISTANCE),
                    result.distance_floor, worst(result, COMPARISON_NORMAL), p99,
                    worst(result, COMPARISON_LINES));
        std::string what = name + " " + twin.what;
        verdict->at_most(worst(result, COMPARISON_DISTANCE), result.distance_floor,
                         what + ": distance");
        verdict->at_most(p99, normal_floor_deg, what + ": 99 % of the normals");
        /* Beside semi-sharp creases patches are hundreds of times as long as they are wide. */
        verdict->at_most(worst(result, COMPARISON_NORMAL),
                         is_smooth ? result.normal_floor_deg : 2e-4, what + ": normals");
        verdict->at_most(worst(result, COMPARISON_LINES), 1e-3, what + ": lines");
        verdict->check(uncovered(result) == 0, what + ": surface is missing");
        verdict->check(result.is_rewound == twin.is_rewound, what + ": winding");
        verdict->check((result.side[0].area_rewound > 0.99 * result.side[0].area) ==
                           twin.is_rewound,
                       what + ": area of other winding");
    }
}

/* --- closed forms -------------------------------------------------------------------------------- */

void judge_parallel(verdict *verdict)
{
    const double d = 0.01;
    comparison_result plane =
        compare(sheet(6, [](int, int) { return 0.0; }), sheet(6, [=](int, int) { return d; }));
    comparison_result tori = compare(torus(64, 0.7), torus(64, 0.7 + d));
    for (int k = 0; k < 2; k++) {
        const comparison_figures &flat = plane.side[k].figures[COMPARISON_DISTANCE],
                                 &round = tori.side[k].figures[COMPARISON_DISTANCE];
        std::printf(
            "parallel: plane %.9f, rms %.9f, torus %.9f, rms %.9f, for 0.01; normals %.1e %.1e\n",
            flat.worst, flat.rms, round.worst, round.rms, worst(plane, COMPARISON_NORMAL),
            worst(tori, COMPARISON_NORMAL));
        verdict->at_most(std::fabs(flat.worst / d - 1), 1e-6, "plane: distance");
        verdict->at_most(std::fabs(flat.rms / d - 1), 1e-6, "plane: rms");
        verdict->at_most(std::fabs(round.worst / d - 1), 3e-5, "torus: distance");
        verdict->at_most(std::fabs(round.rms / d - 1), 1e-5, "torus: rms");
    }
    verdict->at_most(worst(plane, COMPARISON_NORMAL), normal_floor_deg, "plane: normals");
    verdict->at_most(worst(tori, COMPARISON_NORMAL), 1e-4, "torus: normals");
    verdict->check(uncovered(plane) == 0 && uncovered(tori) == 0,
                   "parallel surfaces are not covered");
}

/* The largest |p| of a surface, by places of a grid that contains all vertices and middles of faces and edges. */
double farthest(const cage_surface &of)
{
    double most = 0;
    const int n = 8;
    for (uint32_t face = 0; face < of.tables.n_faces; face++)
        for (int k = 0; k < (n + 1) * (n + 1); k++) {
            limit_point at;
            if (limit_evaluate(&of.tables, face, (double)(k % (n + 1)) / n,
                               (double)(k / (n + 1)) / n, &at))
                most = std::fmax(most, vec_length(at.s));
        }
    return most;
}

/* A convex body and the same one larger by the share e. At the body's farthest point, R away from the middle, the normal
 * points away from the middle; seen from there, the larger body is e R away. Nowhere it is farther along a normal n: let
 * the line from p meet the larger body at p + D n. Since the body is convex, none of its points q has q.n > p.n, so that
 * (p + D n).n <= (1 + e) p.n, and D <= e p.n <= e R. Seen from the larger body, the distance is at least as large. All
 * this is exact too where a cage makes a sphere only nearly. */
void judge_larger_body(const std::string &name, const loose_cage &cage, double known,
                       verdict *verdict)
{
    const double e = 0.2;
    loose_cage larger = cage;
    for (vec3 &p : larger.position)
        p = (1 + e) * p;
    cage_surface before(cage), after(larger);
    double far = farthest(before);
    if (known > 0)
        verdict->at_most(std::fabs(far / known - 1), 1e-7, name + ": its farthest point");
    comparison_setup setup = setup_of(before, after);
    setup.limit[COMPARISON_DISTANCE] = 1e-3 * before.size();
    comparison_result result = compare(setup);
    double found[2] = {result.side[0].figures[COMPARISON_DISTANCE].worst,
                       result.side[1].figures[COMPARISON_DISTANCE].worst};
    std::printf("%s, larger by %.1f: %.9f of %.9f, floor %.1e\n", name.c_str(), e, found[0],
                e * far, result.distance_floor);
    verdict->at_most(std::fabs(found[0] / (e * far) - 1), 1e-6, name + ": distance");
    verdict->at_most(1 - found[1] / (e * far), 1e-6, name + ": distance from the larger body");
    verdict->check(uncovered(result) == 0, name + ": the larger body is covered");
}

void judge_larger_bodies(verdict *verdict)
{
    loose_cage cube, ball;
    for (int k = 0; k < 8; k++)
        cube.position.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
    cube.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    ball = refined(refined(cube));
    for (vec3 &p : ball.position)
        p = normalized(p);
    judge_larger_body("cube", cube, std::sqrt(0.75),
                      verdict); /* a corner is at 3/8 + 4/24 - 1/24 */
    judge_larger_body("sphere", ball, 0, verdict);
}

/* A vertex of valence n of a flat cage, moved upwards, lifts the surface there by n / (n + 5) of that. */
void judge_moved_vertex(verdict *verdict)
{
    for (int n : {3, 4, 5, 7, 12})
        for (double h : {1e-3, 0.05}) {
            loose_cage before = disc(n, 4), after = before;
            after.position[0].z += h;
            comparison_result result = compare(before, after);
            double expected = h * n / (n + 5.0);
            for (int k = 0; k < 2; k++) {
                const comparison_figures &figures = result.side[k].figures[COMPARISON_DISTANCE];
                std::string what =
                    "valence " + std::to_string(n) + ", moved by " + std::to_string(h);
                verdict->at_most(std::fabs(figures.worst / expected - 1), 1e-3, what);
                verdict->at_most(std::hypot(figures.at[0].position.x, figures.at[0].position.y),
                                 0.05, what + ": place");
            }
        }
}

void judge_rotation(verdict *verdict)
{
    loose_cage flat = sheet(6, [](int, int) { return 0.0; });
    comparison_result tilted = compare(flat, turned(flat, {1, 0, 0}, 0.1, {}));
    std::printf("rotated by 0.1 degrees: normals %.7f\n", worst(tilted, COMPARISON_NORMAL));
    verdict->at_most(std::fabs(worst(tilted, COMPARISON_NORMAL) - 0.1), 2e-5,
                     "normals of a tilted plane");
    loose_cage body = read_loose("tests/models/body.obj");
    cage_surface before(body), after(turned(body, {1, 2, 3}, 0.1, {0.004, -0.002, 0.003}));
    comparison_setup setup = setup_of(before, after);
    setup.is_aligned = true;
    comparison_result aligned = compare(setup);
    std::printf("aligned: %.7f degrees, rms %.2e to %.2e, then distance %.1e, normals %.1e\n",
                aligned.rotation_deg, aligned.rms_before, aligned.rms_after,
                worst(aligned, COMPARISON_DISTANCE), worst(aligned, COMPARISON_NORMAL));
    verdict->at_most(std::fabs(aligned.rotation_deg - 0.1), 2e-5, "angle of the alignment");
    verdict->at_most(worst(aligned, COMPARISON_DISTANCE), 1e-7 * before.size(),
                     "aligned: distance");
    verdict->at_most(worst(aligned, COMPARISON_NORMAL), 2e-5, "aligned: normals");
}

/* A flat square whose height grows with y: the distances are spread evenly from 0 to the largest one. */
void judge_figures(verdict *verdict)
{
    const double side = 4, slope = 1e-3, most = slope * side;
    loose_cage square = sheet((int)side, [](int, int) { return 0.0; });
    for (uint32_t vertex : {0u, 4u, 20u, 24u})
        square.corners.push_back({vertex, 10});
    loose_cage tilted = square;
    for (vec3 &p : tilted.position)
        p.z = slope * p.y;
    cage_surface before(square), after(tilted);
    comparison_setup setup = setup_of(before, after);
    setup.limit[COMPARISON_DISTANCE] = 0.3 * most;
    comparison_result result = compare(setup);
    for (const comparison_result_side &of : result.side) {
        const comparison_figures &figures = of.figures[COMPARISON_DISTANCE];
        verdict->at_most(std::fabs(of.area / (side * side) - 1), 1e-6, "area of a square");
        verdict->at_most(std::fabs(figures.worst / most - 1), 2e-3, "tilted: worst");
        verdict->at_most(std::fabs(figures.rms / (most / std::sqrt(3.0)) - 1), 1e-3, "tilted: rms");
        verdict->at_most(std::fabs(figures.p95 / most - 0.95), 0.01, "tilted: 95 %");
        verdict->at_most(std::fabs(figures.p99 / most - 0.99), 0.01, "tilted: 99 %");
        verdict->at_most(std::fabs(figures.area_out / (side * side) - 0.7), 0.01,
                         "tilted: area out");
    }
}

/* The area that a closed uniform cubic B-spline curve encloses (Green's theorem, by a fine polygon). */
double area_of_curve(const std::vector<vec3> &points)
{
    std::vector<vec3> polygon;
    size_t n = points.size();
    for (size_t k = 0; k < n; k++)
        for (int i = 0; i < 1000; i++) {
            double t = i / 1000.0, r = 1 - t;
            polygon.push_back((r * r * r / 6) * points[k] +
                              ((4 + t * t * (3 * t - 6)) / 6) * points[(k + 1) % n] +
                              ((4 + r * r * (3 * r - 6)) / 6) * points[(k + 2) % n] +
                              (t * t * t / 6) * points[(k + 3) % n]);
        }
    double sum = 0;
    for (size_t k = 0; k < polygon.size(); k++)
        sum += 0.5 * cross(polygon[k], polygon[(k + 1) % polygon.size()]).z;
    return std::fabs(sum);
}

/* A face of a flat sheet is missing: its border is the curve of its corners. */
void judge_hole(verdict *verdict)
{
    loose_cage whole = sheet(6, [](int, int) { return 0.0; }), open = whole;
    open.faces.erase(open.faces.begin() + 14);
    double expected = area_of_curve({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    cage_surface a(whole), b(open);
    comparison_setup to_open = setup_of(a, b), to_whole = setup_of(b, a);
    to_open.n_samples = to_whole.n_samples = 60000;
    comparison_result removed = compare(to_open), closed = compare(to_whole);
    std::printf("hole: %.5f removed, %.5f closed, of %.5f\n", removed.side[0].area_uncovered,
                closed.side[1].area_uncovered, expected);
    verdict->at_most(std::fabs(removed.side[0].area_uncovered / expected - 1), 0.01,
                     "a face removed");
    verdict->at_most(std::fabs(closed.side[1].area_uncovered / expected - 1), 0.01,
                     "a hole closed");
    verdict->check(removed.side[1].area_uncovered == 0 && closed.side[0].area_uncovered == 0,
                   "the other side is covered");
    comparison_place place = removed.side[0].uncovered_at;
    verdict->check(place.position.x > 2 && place.position.x < 3 && place.position.y > 2 &&
                       place.position.y < 3,
                   "the place of the hole");
}

/* A flat square whose sides x = 0 and x = 4 are moved inwards and outwards: strips without a sample inside. */
void judge_strips(verdict *verdict)
{
    auto flat = [](int, int) { return 0.0; };
    loose_cage square = sheet(4, flat);
    for (uint32_t vertex : {0u, 4u, 20u, 24u})
        square.corners.push_back({vertex, 10});
    cage_surface before(square);
    double limit = 1e-5 * before.size();
    for (double strip : {0.5 * limit, 2 * limit, 35 * limit}) {
        for (bool is_wider : {false, true}) {
            loose_cage scaled = square;
            for (vec3 &p : scaled.position)
                p.x *= 1 + (is_wider ? strip : -strip) / 4;
            cage_surface after(scaled);
            comparison_result result = compare(setup_of(before, after));
            const comparison_result_side &beyond = result.side[is_wider],
                                         &within = result.side[!is_wider];
            double exact = strip > limit ? 4 * strip : 0;
            std::string what = "a strip of " + std::to_string(strip / limit) + " limits";
            std::printf("%s: %.4e of %.4e uncovered\n", what.c_str(), beyond.area_uncovered, exact);
            verdict->at_most(std::fabs(beyond.area_uncovered - exact), 0.01 * exact, what);
            verdict->check(within.area_uncovered == 0, what + ": the smaller square is covered");
            if (exact > 0)
                verdict->check(
                    std::fabs(beyond.uncovered_at.position.x - (is_wider ? 4 + strip : 4)) < 1e-5,
                    what + ": the place lies on the border");
        }
    }
}

/* --- as a computation ---------------------------------------------------------------------------- */

/* The order of slices does not matter, and less memory than needed is refused. */
void judge_computation(verdict *verdict)
{
    loose_cage body = read_loose("tests/models/body.obj"), moved = body;
    moved.position[20].z += 0.01;
    cage_surface a(body), b(moved);
    comparison_setup setup = setup_of(a, b);
    setup.has_curvature = true;
    comparison_result forwards = compare(setup);
    error error = {};
    setup.task_us = 1; /* each sample interrupts its slice */
    computation *computation = comparison_create(&setup, &error);
    size_t n_begun = 0;
    bool has_begun = true;
    for (unsigned phase = 0; computation->kind->stages[phase];
         phase += !computation_repeats(computation)) {
        size_t n_slices = 0;
        n_begun++;
        has_begun &= computation->kind->begin(computation, phase, &n_slices, &error);
        while (n_slices-- > 0)
            computation->kind->slice(computation, n_slices);
    }
    verdict->check(has_begun, "each phase begins");
    verdict->check(std::memcmp(&forwards, comparison_read(computation), sizeof forwards) == 0,
                   "interrupted slices in another order give another result");
    verdict->check(n_begun > 1000, "slices of samples are interrupted");
    setup.task_us = 0;
    computation_destroy(computation);
    verdict->check(forwards.side[0].figures[COMPARISON_CURVATURE].is_known,
                   "curvature was asked for");
    for (size_t bytes = 1000; bytes < 4 << 20; bytes *= 4) {
        setup.most_bytes = bytes;
        computation = comparison_create(&setup, &error);
        error.kind = ERROR_NONE;
        bool is_done = computation_run(computation, &error);
        computation_destroy(computation);
        if (is_done)
            break;
        verdict->check(error.kind == ERROR_SERVER, "too little memory is refused");
        verdict->check(bytes < 2 << 20, "more memory than expected is needed");
    }
}

} // namespace

int main(int argc, char **argv)
{
    verdict verdict;
    judge_equal("body", read_loose("tests/models/body.obj"), true, &verdict);
    judge_equal("ngons", read_loose("tests/models/ngons.obj"), true, &verdict);
    judge_equal("torus", torus(12, 0.7), true, &verdict);
    judge_equal("fender", read_loose("tests/models/fender.obj"), false, &verdict);
    judge_equal("creases", read_loose("tests/models/creases.obj"), false, &verdict);
    if (argc > 1)
        judge_equal("car", read_loose(argv[1]), false, &verdict);
    judge_parallel(&verdict);
    judge_larger_bodies(&verdict);
    judge_moved_vertex(&verdict);
    judge_rotation(&verdict);
    judge_figures(&verdict);
    judge_hole(&verdict);
    judge_strips(&verdict);
    judge_computation(&verdict);
    return verdict.finish();
}
