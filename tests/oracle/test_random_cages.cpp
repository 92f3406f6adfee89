/* test_random_cages [SEED]: 300 cages of random_cage.h, each against libosd in double precision:
 * every point of three levels of refinement, and the tables at random places. With a seed only that
 * cage is tested, and written to random_cage_SEED.obj in the working folder. */
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "tests/oracle/limit_samples.h"
#include "tests/oracle/random_cage.h"
#include "tests/oracle/refine_walk.h"
#include "tests/oracle/verdict.h"

extern "C" {
#include "server/surface/topology/nonmanifold.h"
#include "server/surface/topology/topology.h"
}

namespace
{

const uint64_t first_seed = 140000, n_cages = 300;
const int n_levels = 3;
const size_t n_samples = 3000, min_samples = 500;
const double max_refined = 1e-12, max_position_p999 = 1e-6; /* of the cage's diagonal */
const double max_normal_p999_rad = 2e-6;

/* How many cages had each feature that the test is meant for, and the largest errors. */
struct census {
    size_t without_surface = 0, non_manifold = 0;
    size_t worn_off = 0, foreign = 0; /* see look_at_sheets() */
    std::vector<double> normal_p999, position_p999, refined;
};

/* Whether the sheet at a corner ends at two different edges. */
bool runs_through(const topology &t, uint32_t corner)
{
    sector sector = topology_sector(&t, corner);
    uint32_t last = sector.first;
    for (uint32_t k = 1; k < sector.n_faces; k++)
        last = corner_ccw(&t, last);
    return !sector.closed && corner_vertex(&t, corner_next(&t, sector.first)) !=
                                 corner_vertex(&t, corner_prev(&t, last));
}

/* Whether a vertex of several sheets is the end of semi-sharp creases, and whether one of its
 * sheets is a closed fan or lies between two sides of one edge, so that the crease of other sheets
 * passes through the vertex. */
void look_at_sheets(const cage &cage, census *all)
{
    topology t;
    error error;
    bool worn_off = false, foreign = false;
    if (!topology_init(&t, &cage, &error))
        throw std::runtime_error(error.text);
    for (uint32_t c = 0; c < cage.face_start[cage.n_faces]; c++) {
        const nonmanifold_vertex *sheets = nonmanifold_at(&t, c);
        if (!sheets || t.vertex_flags[corner_vertex(&t, c)] & VERTEX_SHARP)
            continue;
        worn_off |= t.vertex_creases[sheets->first_step].semisharp.n > 0;
        foreign |= !runs_through(t, c);
    }
    topology_finish(&t);
    all->worn_off += worn_off;
    all->foreign += foreign;
}

void judge(uint64_t seed, const random_cage &made, census *all, verdict *verdict)
{
    std::string what = "seed " + std::to_string(seed) + " (" + made.story + "): ";
    solid_cage solid(made.parts);
    osd_oracle oracle(solid.cage);
    table_evaluator tables(solid.cage);
    double diagonal = cage_diagonal(solid.cage), refined = 0;
    for (double distance : walk_levels(solid.cage, n_levels).distance)
        refined = distance <= refined ? refined : distance;
    limit_samples at = compare_limit(oracle, tables, n_samples, seed);
    look_at_sheets(solid.cage, all);
    all->non_manifold += oracle.non_manifold();
    all->refined.push_back(refined / diagonal);
    verdict->check(at.presence == 0,
                   what + std::to_string(at.presence) + " places where only one has a surface");
    verdict->at_most(refined / diagonal, max_refined, what + "off libosd's refinement (diagonals)");
    if (at.normal_rad.size() < min_samples) {
        all->without_surface++;
        return;
    }
    all->position_p999.push_back(quantile(at.position, 0.999) / diagonal);
    all->normal_p999.push_back(quantile(at.normal_rad, 0.999));
    verdict->at_most(all->position_p999.back(), max_position_p999,
                     what + "position p99.9 (diagonals)");
    verdict->at_most(all->normal_p999.back(), max_normal_p999_rad, what + "normal p99.9 (rad)");
}

void try_seed(uint64_t seed, bool write, census *all, verdict *verdict)
{
    random_cage made = make_random_cage(seed);
    try {
        if (write)
            made.parts.write_obj("random_cage_" + std::to_string(seed) + ".obj");
        judge(seed, made, all, verdict);
    } catch (const std::exception &failure) {
        verdict->check(false,
                       "seed " + std::to_string(seed) + " (" + made.story + "): " + failure.what());
    }
}

/* Whether every feature occurred. */
void judge_census(const census &all, verdict *verdict)
{
    verdict->check(all.without_surface <= n_cages / 10, "too many cages with hardly any surface");
    verdict->check(all.non_manifold >= n_cages / 3, "too few cages that are not manifold");
    verdict->check(all.worn_off >= n_cages / 20, "too few semi-sharp creases where sheets meet");
    verdict->check(all.foreign >= n_cages / 60, "too few sheets that a spine does not end");
}

} // namespace

int main(int argc, char **argv)
{
    verdict verdict;
    census all;
    if (argc > 1) {
        try_seed(std::strtoull(argv[1], nullptr, 10), true, &all, &verdict);
    } else {
        for (uint64_t seed = first_seed; seed < first_seed + n_cages; seed++)
            try_seed(seed, false, &all, &verdict);
        judge_census(all, &verdict);
    }
    std::printf(
        "%zu cages compared (%zu with hardly any surface), %zu not manifold: %zu with "
        "semi-sharp creases where sheets meet, %zu with sheets that the spine does not end\n",
        all.refined.size(), all.without_surface, all.non_manifold, all.worn_off, all.foreign);
    std::printf(
        "largest of all cages: refined points %.1e, position p99.9 %.1e (diagonals), normal "
        "p99.9 %.1e rad\n",
        quantile(all.refined, 1), quantile(all.position_p999, 1), quantile(all.normal_p999, 1));
    return verdict.finish();
}
