#include "tests/oracle/limit_samples.h"

#include <cmath>
#include <random>

namespace
{

/* A random point of a random face. Half of the points are uniform; half have a distance from a
 * corner whose logarithm is uniform, so that every ring gets points. Some lie on an edge. */
void draw_place(std::mt19937_64 *random, uint32_t n_faces, uint32_t *face, double *u, double *v)
{
    std::uniform_real_distribution<double> unit(0, 1);
    *face = (uint32_t)(unit(*random) * n_faces);
    *u = unit(*random);
    *v = unit(*random);
    if (unit(*random) < 0.5) {
        double reach = std::pow(2.0, -9 * unit(*random));
        *u *= reach;
        *v *= reach;
        (*u > *v ? *u : *v) = reach;
        *u = unit(*random) < 0.5 ? *u : 1 - *u;
        *v = unit(*random) < 0.5 ? *v : 1 - *v;
    }
    if (unit(*random) < 0.05)
        (unit(*random) < 0.5 ? *u : *v) = unit(*random) < 0.5 ? 0 : 1;
}

} // namespace

limit_samples compare_limit(const osd_oracle &oracle, const table_evaluator &tables, size_t n,
                            uint64_t seed)
{
    limit_samples found;
    std::mt19937_64 random(seed);
    for (size_t i = 0; i < n; i++) {
        uint32_t face;
        double u, v;
        draw_place(&random, (uint32_t)tables.tables.n_faces, &face, &u, &v);
        if (!osd_oracle_is_exact(u, v))
            continue;
        osd_sample truth;
        surface_point ours;
        bool has_truth = oracle.evaluate(face, u, v, &truth);
        bool has_ours = tables.evaluate(face, u, v, &ours);
        found.presence += has_truth != has_ours;
        if (!has_truth || !has_ours)
            continue;
        found.position.push_back(length(ours.p - truth.p));
        if (truth.has_normal())
            found.normal_rad.push_back(angle(cross(ours.du, ours.dv), truth.normal()));
    }
    return found;
}
