/* test_sectors: sectors of 1 to 12 faces at boundaries, creases and corners, levels 1 to 30, with
 * random rings, against repeated local refinement in long double: normal and curvature inside the
 * faces, and the vertex's own normal against the limit of the normals inside the faces. On gentle
 * fans the normals have converged at level 30, so that the vertex's own normal is also compared with
 * those of that level; on rough fans of three faces they are still 0.04 degrees from their limit.
 * Needs no GPU, and no libosd, whose tangent across a crease belongs to another edge rule
 * (server/surface/subdivision/ring_limit.c). */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracle/fan.h"
#include "tests/oracle/local_surface.h"
#include "tests/oracle/tables.h"
#include "tests/oracle/verdict.h"

namespace
{

const int max_faces = 12, max_level = 30, deep_level = 24, simple_faces = 4;
const int places_per_level = 8, rays_per_face = 5, cages_per_shape = 3;
const double max_normal_p999_rad = 2e-6;
const double max_curvature_p999 = 1e-4;      /* for up to simple_faces faces and up to deep_level */
const double max_curvature_deep_p999 = 5e-4; /* for more faces, or deeper */
/* angle of the vertex's normal to the limit of the normals */
const double max_vertex_deg = 0.01;
/* At a smooth corner of one face the normal keeps turning by 1/level, so the bound is that of level
 * 32. */
const double max_vertex_one_face_deg = 0.2;
/* If the limits of the normals along several rays differ by more than this, the vertex has no
 * single normal. */
const double min_spread_deg = 0.05;

struct sector {
    fan_shape shape;
    int faces;       /* of the sector, counted from ray 0 */
    bool has_normal; /* as the eigenvalues predict */
};

struct figures {
    std::vector<double> normal_rad, curvature[2]; /* up to deep_level, and deeper */
    double limit_deg = 0,
           /* angle to the vertex's normal: of the extrapolated limit, and of the last level's
            * normal */
        last_deg = 0;
    size_t missing = 0, wrong_kind = 0;
};

double degrees(const vec3 &a, const vec3 &b)
{
    return angle(a, b) * 180 / M_PI;
}

void compare(const table_evaluator &tables, const local_surface &truth, uint32_t corner, int level,
             double a, double b, figures *f)
{
    local_sample there;
    surface_point here;
    place at = {corner / 4, corner % 4, std::ldexp(a, -level), std::ldexp(b, -level)};
    if (!truth.evaluate(corner, at.a, at.b, &there) || !tables.evaluate(at, &here)) {
        f->missing++;
        return;
    }
    curvatures k = principal_curvatures(here);
    double size = std::fmax(std::fabs(there.k.least), std::fabs(there.k.most));
    double off = std::fmax(std::fabs(k.least - there.k.least), std::fabs(k.most - there.k.most));
    f->normal_rad.push_back(angle(cross(here.du, here.dv), there.normal));
    f->curvature[level > deep_level].push_back(off / size);
}

/* The limit of the normals along a ray towards the vertex, from three levels of the reference: if
 * the changes shrink by a constant factor, they are extrapolated by it (Aitken). */
bool follow_ray(const local_surface &truth, uint32_t corner, double a, double b, vec3 *last,
                vec3 *limit)
{
    local_sample s[3];
    for (int i = 0; i < 3; i++) {
        int level = max_level - 10 * (2 - i);
        if (!truth.evaluate(corner, std::ldexp(a, -level), std::ldexp(b, -level), &s[i]))
            return false;
    }
    double before = length(s[1].normal - s[0].normal), now = length(s[2].normal - s[1].normal);
    double left = now < 0.9 * before ? now / before : 0;
    *last = s[2].normal;
    *limit = s[2].normal + (left / (1 - left)) * (s[2].normal - s[1].normal);
    return true;
}

/* The vertex's normal as the face at that corner gives it. */
void compare_vertex(const table_evaluator &tables, const local_surface &truth, uint32_t corner,
                    bool has_normal, figures *f)
{
    limit_place tip = {corner / 4, corner % 4, 0, 0};
    limit_point vertex;
    limit_evaluate_at(&tables.tables, &tip, &vertex);
    f->wrong_kind += vertex.has_normal != has_normal;
    vec3 n = {vertex.n.x, vertex.n.y, vertex.n.z}, last, limit;
    for (int i = 0; i < rays_per_face; i++) {
        double turn = i / (rays_per_face - 1.0);
        if (!follow_ray(truth, corner, std::fmin(1, 2 * (1 - turn)), std::fmin(1, 2 * turn), &last,
                        &limit)) {
            f->missing++;
            continue;
        }
        f->last_deg = std::fmax(f->last_deg, degrees(n, last));
        f->limit_deg = std::fmax(f->limit_deg, degrees(n, limit));
    }
}

void measure(const sector &sector, uint64_t seed, figures *f)
{
    fan cage(sector.shape, seed);
    table_evaluator tables(cage.cage);
    local_surface truth(cage.cage, 0, max_level + 1);
    std::mt19937_64 random(seed + 1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int k = 0; k < sector.faces; k++) {
        uint32_t corner = cage.corner(k);
        compare_vertex(tables, truth, corner, sector.has_normal, f);
        for (int level = 1; level <= max_level; level++)
            for (int i = 0; i < places_per_level; i++) {
                double outer = 1 + unit(random), other = i == 0 ? 0 : outer * unit(random);
                compare(tables, truth, corner, level, i % 2 ? outer : other, i % 2 ? other : outer,
                        f);
            }
    }
}

void judge(const sector &sector, verdict *verdict)
{
    figures f;
    for (int i = 0; i < cages_per_shape; i++)
        measure(sector, 1000 * (uint64_t)sector.faces + (uint64_t)i, &f);
    double n999 = quantile(f.normal_rad, 0.999), k999 = quantile(f.curvature[0], 0.999);
    double deep999 = quantile(f.curvature[1], 0.999);
    std::printf("%-15s %3d | %6zu | %7.1e %7.1e | %7.1e %7.1e | %7.1e %7.1e | ",
                sector.shape.name.c_str(), sector.faces, f.normal_rad.size(), n999,
                quantile(f.normal_rad, 1), k999, quantile(f.curvature[0], 1), deep999,
                quantile(f.curvature[1], 1));
    std::printf(sector.has_normal ? "%7.1e %7.1e\n" : "   none %7.1e\n",
                sector.has_normal ? f.limit_deg : f.last_deg, f.last_deg);
    std::string what = sector.shape.name + " of " + std::to_string(sector.faces) + ": ";
    verdict->check(f.missing == 0, what + std::to_string(f.missing) + " places without a surface");
    verdict->check(f.wrong_kind == 0, what + "one normal at the vertex where it has none, or none");
    verdict->at_most(n999, max_normal_p999_rad, what + "normal p99.9 (rad)");
    verdict->at_most(k999,
                     sector.faces <= simple_faces ? max_curvature_p999 : max_curvature_deep_p999,
                     what + "curvature to level 24, p99.9");
    verdict->at_most(deep999, max_curvature_deep_p999, what + "curvature beyond, p99.9");
    bool turns_on = sector.faces == 1 && sector.shape.sharpness == 0;
    if (turns_on)
        verdict->at_most(f.last_deg, max_vertex_one_face_deg, what + "the vertex's normal (deg)");
    else if (sector.has_normal && sector.shape.gentle > 0)
        verdict->at_most(f.last_deg, max_vertex_deg,
                         what + "the vertex's normal at level 30 (deg)");
    else if (sector.has_normal)
        verdict->at_most(f.limit_deg, max_vertex_deg, what + "the vertex's normal (deg)");
    else
        verdict->check(f.last_deg > min_spread_deg,
                       what + "has one normal at the vertex after all");
}

} // namespace

int main()
{
    const float sharp = CAGE_SHARPNESS_INFINITE;
    verdict verdict;
    std::printf("%-19s | %6s | %15s | %15s | %15s | %15s\n", "", "", "normal, rad",
                "curvature to 24", "and to 30, rel.", "at vertex, deg");
    std::printf("%-15s %3s | %6s | %7s %7s | %7s %7s | %7s %7s | %7s %7s\n", "sector", "K",
                "places", "p99.9", "max", "p99.9", "max", "p99.9", "max", "limit", "lev. 30");
    std::vector<sector> sectors;
    for (int n = 1; n <= max_faces; n++)
        sectors.push_back({{"boundary", n, false, {}, 0}, n, n <= 3});
    for (int n = 1; n <= max_faces; n++)
        sectors.push_back({{"crease", n + 3, true, {{0, sharp}, {n, sharp}}, 0}, n, n <= 3});
    for (int n = 1; n <= max_faces; n++)
        sectors.push_back({{"corner", n, false, {}, sharp}, n, n == 1});
    for (int n = 2; n <= 3; n++) {
        sectors.push_back({{"gentle boundary", n, false, {}, 0, 0.02}, n, true});
        sectors.push_back(
            {{"gentle crease", n + 3, true, {{0, sharp}, {n, sharp}}, 0, 0.02}, n, true});
    }
    for (const sector &sector : sectors) {
        try {
            judge(sector, &verdict);
        } catch (const std::exception &failure) {
            verdict.check(false, sector.shape.name + ": " + failure.what());
        }
    }
    return verdict.finish();
}
