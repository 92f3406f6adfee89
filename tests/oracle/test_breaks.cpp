/* test_breaks [SEED]: the breaks of random cages (random_cage.h). Which edges are creases is counted a second time from
 * the cage; at each edge's worst place, and at many places along it, the measures are computed a second time from
 * libosd's derivatives in double precision. No place may be worse than the worst one. With a seed only that cage is
 * tested. */
#include <cstdio>
#include <cstdlib>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/random_cage.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

extern "C" {
#include "server/curves/breaks/breaks.h"
bool computation_run(struct computation *computation, struct error *error);
void computation_destroy(struct computation *computation);
}

namespace
{

const uint64_t first_seed = 515000, n_cages = 120;
const int n_places = 40;
/* Differences that the tables' single precision causes, relative to the edge. Derivatives of a face with corners that
 * nearly coincide lose more. */
const double max_angle_p99_deg = 2e-5, max_curvature_p99 = 1e-5, max_percent_p99 = 0.3;

struct census {
    std::vector<double> angle, curvature, percent, missed; /* differences */
    size_t edges = 0, darts = 0, beside_ngons = 0, joints = 0;
};

/* The number of the cage's infinitely sharp edges with one face on either side, as edges of Ptex faces. False in *known
 * if the cage does not say clearly which they are. */
size_t count_creases(const solid_cage &solid, bool *known)
{
    using edge = std::pair<uint32_t, uint32_t>;
    const cage &c = solid.cage;
    std::map<edge, std::vector<std::pair<uint32_t, bool>>> faces;
    std::map<edge, std::set<float>> sharpness;
    std::set<uint32_t> holes(c.hole, c.hole + c.n_holes);
    for (uint32_t f = 0; f < c.n_faces; f++)
        for (uint32_t k = c.face_start[f]; k < c.face_start[f + 1]; k++) {
            uint32_t next = k + 1 < c.face_start[f + 1] ? k + 1 : c.face_start[f];
            uint32_t a = c.face_vertex[k], b = c.face_vertex[next];
            faces[{std::min(a, b), std::max(a, b)}].push_back({f, a < b});
        }
    for (size_t i = 0; i < c.n_creases; i++) {
        uint32_t a = c.crease[i].vertex[0], b = c.crease[i].vertex[1];
        sharpness[{std::min(a, b), std::max(a, b)}].insert(c.crease[i].sharpness);
    }
    size_t n = 0;
    *known = c.boundary != CAGE_BOUNDARY_NONE; /* which makes further faces holes */
    for (const auto &[ends, values] : sharpness) {
        const auto &beside = faces[ends];
        *known = *known && values.size() == 1;
        if (*values.begin() < CAGE_SHARPNESS_INFINITE || beside.size() != 2 ||
            beside[0].second == beside[1].second || holes.count(beside[0].first) ||
            holes.count(beside[1].first))
            continue;
        bool has_ngon = false;
        for (const auto &face : beside)
            has_ngon |= c.face_start[face.first + 1] - c.face_start[face.first] != 4;
        n += has_ngon ? 2 : 1;
    }
    return n;
}

/* One side by libosd. */
struct side {
    vec3 p, n;
    double across, speed; /* curvature across the edge */
};

/* False beside extraordinary vertices, where libosd is not exact, and where there is no normal. */
bool side_at(const osd_oracle &oracle, uint32_t face, unsigned edge, double at, side *out)
{
    const double u[4] = {at, 1, 1 - at, 0}, v[4] = {0, at, 1, 1 - at};
    osd_sample s;
    if (!osd_oracle_is_exact(u[edge], v[edge]) || !oracle.evaluate(face, u[edge], v[edge], &s) ||
        !s.has_normal())
        return false;
    vec3 along = normalized(edge & 1 ? s.dv : s.du);
    vec3 normal = s.normal(), across = cross(normal, along);
    double e = dot(s.du, s.du), f = dot(s.du, s.dv), g = dot(s.dv, s.dv), det = e * g - f * f;
    double p = dot(across, s.du), q = dot(across, s.dv);
    double a = (g * p - f * q) / det, b = (e * q - f * p) / det;
    out->p = s.p;
    out->n = normal;
    out->across =
        a * a * dot(s.duu, normal) + 2 * a * b * dot(s.duv, normal) + b * b * dot(s.dvv, normal);
    out->speed = length(edge & 1 ? s.dv : s.du);
    return true;
}

struct measured {
    double angle_deg, curvature, percent;
};

/* The place on the second face: where the first side's point lies, by bisection of the distance along the edge; the
 * faces of an n-gon have half an edge. */
bool measure(const osd_oracle &oracle, const break_edge &edge, double at, bool first_is_part,
             bool second_is_part, measured *out)
{
    side a, b;
    double there = 1 - at;
    if (first_is_part && !second_is_part)
        there = edge.edge[0] == 0 ? 1 - at / 2 : (1 - at) / 2;
    if (!side_at(oracle, edge.face[0], edge.edge[0], at, &a) ||
        !side_at(oracle, edge.face[1], edge.edge[1], there, &b))
        return false;
    out->angle_deg = angle(a.n, b.n) * 180 / M_PI;
    out->curvature = std::fabs(a.across - b.across);
    out->percent = 200 * out->curvature /
                   std::max(std::fabs(a.across) + std::fabs(b.across), 1e-3 / edge.length);
    return length(a.p - b.p) < 1e-5 * edge.length;
}

void judge_edge(const osd_oracle &oracle, const limit_tables &tables, const break_edge &edge,
                census *all)
{
    bool part[2];
    for (int i = 0; i < 2; i++)
        part[i] = tables.nodes[edge.face[i]].ngon_size > 0;
    const int measures[] = {BREAK_ANGLE, BREAK_CURVATURE, BREAK_PERCENT};
    std::vector<double> *const differences[] = {&all->angle, &all->curvature, &all->percent};
    measured there;
    for (int m = 0; m < 3; m++) {
        const break_worst &worst = edge.worst[measures[m]];
        if (std::isnan(worst.value) || !measure(oracle, edge, worst.at, part[0], part[1], &there))
            continue;
        const double values[] = {there.angle_deg, there.curvature, there.percent};
        double scale = m == 1 ? std::max(values[1], 1 / edge.length) : 1;
        differences[m]->push_back(std::fabs(values[m] - worst.value) / scale);
    }
    /* 1/256 of the edge at its ends is not looked at for curvature; libosd's part is smaller. */
    for (int k = 0; k < n_places; k++) {
        double at = 1.0 / 200 + (0.99 * k) / (n_places - 1);
        if (!measure(oracle, edge, at, part[0], part[1], &there))
            continue;
        double over = (there.curvature - edge.worst[BREAK_CURVATURE].value) /
                      std::max(edge.worst[BREAK_CURVATURE].value, 1 / edge.length);
        all->missed.push_back(
            std::max(over, (there.angle_deg - edge.worst[BREAK_ANGLE].value) / 180));
    }
    all->edges++;
    all->darts += edge.has_dart;
    all->beside_ngons += part[0] != part[1];
}

void judge(uint64_t seed, const random_cage &made, census *all, verdict *verdict)
{
    const std::string what = "seed " + std::to_string(seed) + " (" + made.story + "): ";
    solid_cage solid(made.parts);
    osd_oracle oracle(solid.cage);
    table_evaluator built(solid.cage);
    light light = {};
    light.kind = LIGHT_SPHERE;
    light.u[0] = light.v[2] = 1;
    lines family = {};
    family.eye_kind = LINE_EYE_DIRECTION;
    family.eye[2] = -1;
    const break_lines lines = {&family, &light, 1};
    const break_limits limits = {1e-5, 0.1, 10};
    error error = {};
    computation *computation = breaks_create(&built.tables, &lines, &limits, &error);
    if (!computation || !computation_run(computation, &error))
        throw std::runtime_error(error.text);
    const breaks_found result = breaks_result(computation);
    bool known;
    size_t creases = count_creases(solid, &known);
    verdict->check(!known || creases == result.counts.creases,
                   what + std::to_string(result.counts.creases) + " creases, the cage has " +
                       std::to_string(creases));
    for (size_t i = 0; i < result.n_edges; i++)
        if (result.edges[i].kind == BREAK_CREASE)
            judge_edge(oracle, built.tables, result.edges[i], all);
    all->joints += result.counts.joints;
    computation_destroy(computation);
}

void try_seed(uint64_t seed, census *all, verdict *verdict)
{
    random_cage made = make_random_cage(seed);
    try {
        judge(seed, made, all, verdict);
    } catch (const std::exception &failure) {
        verdict->check(false,
                       "seed " + std::to_string(seed) + " (" + made.story + "): " + failure.what());
    }
}

} // namespace

int main(int argc, char **argv)
{
    verdict verdict;
    census all;
    if (argc > 1) {
        try_seed(std::strtoull(argv[1], nullptr, 10), &all, &verdict);
    } else {
        for (uint64_t seed = first_seed; seed < first_seed + n_cages; seed++)
            try_seed(seed, &all, &verdict);
        verdict.check(all.edges > 100 && all.darts > 40 && all.beside_ngons > 30 &&
                          all.joints > 500,
                      "too few edges of some kind");
    }
    std::printf("%zu creases, %zu with darts, %zu between a quad and an n-gon; %zu joints; %zu "
                "places compared\n",
                all.edges, all.darts, all.beside_ngons, all.joints, all.missed.size());
    for (double q : {0.5, 0.99, 1.0})
        std::printf("quantile %.2f of differences: angle %.1e degrees, curvature %.1e, percent "
                    "%.1e; worse than the worst by %.1e\n",
                    q, quantile(all.angle, q), quantile(all.curvature, q), quantile(all.percent, q),
                    quantile(all.missed, q));
    verdict.at_most(quantile(all.angle, 0.99), max_angle_p99_deg, "angle p99 (degrees)");
    verdict.at_most(quantile(all.curvature, 0.99), max_curvature_p99, "curvature p99");
    verdict.at_most(quantile(all.percent, 0.99), max_percent_p99, "percent p99");
    verdict.at_most(quantile(all.missed, 1), 1e-4, "places that are worse than the worst");
    return verdict.finish();
}
