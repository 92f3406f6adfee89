/* The limit surface computed by libosd in double precision: the reference for sheen.
 * Feature-adaptive refinement to isolation level 10 with infinitely sharp patches, no single-crease
 * patches (libosd's CPU evaluation ignores their crease), no legacy sharp corners, Gregory end
 * caps. Exact to rounding except in the end caps, which extend at most 2^-9 of a Ptex face from its
 * corners (2^-10 for quads): see osd_oracle_is_exact(). Evaluation is read-only and may run in
 * several threads. */
#ifndef SHEEN_TESTS_ORACLE_OSD_ORACLE_H
#define SHEEN_TESTS_ORACLE_OSD_ORACLE_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/cage/cage.h"
}

/* Position (file units) and derivatives by the Ptex face's own u and v. */
struct osd_sample {
    vec3 p, du, dv, duu, duv, dvv;
    /* True if du and dv span a plane, which they need not do in cusps, in folds and at sharp
     * corners. */
    bool has_normal() const
    {
        double size = length(du) + length(dv) + length(duu) + length(duv) + length(dvv);
        return length(cross(du, dv)) > 1e-6 * size * size;
    }
    vec3 normal() const /* unit, along the face winding */
    {
        return normalized(cross(du, dv));
    }
};

/* An irregular vertex of the cage (or the middle of an n-gon), and its place. */
struct osd_irregular {
    uint32_t face;  /* Ptex face that has it at a corner */
    double u, v;    /* that corner, 0 or 1 each */
    size_t valence; /* faces around it */
    bool boundary;
};

class osd_oracle
{
  public:
    /* Throws std::runtime_error when the scheme is not Catmull-Clark or libosd refuses the cage.
     * Keeps nothing of the cage. */
    explicit osd_oracle(const cage &cage);
    ~osd_oracle();
    osd_oracle(const osd_oracle &) = delete;
    osd_oracle &operator=(const osd_oracle &) = delete;

    uint32_t n_ptex_faces() const;
    bool non_manifold() const; /* an edge or a vertex of the cage is non-manifold */
    const std::vector<osd_irregular> &irregular() const;

    /* False if there is no surface (a hole), or if the arguments are out of range. */
    bool evaluate(uint32_t face, double u, double v, osd_sample *sample) const;
    /* As evaluate(), only the position, in a third of the time. */
    bool evaluate(uint32_t face, double u, double v, vec3 *position) const;

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

/* True if (u, v) is at least 1/512 away from all four corners, in u or in v. */
bool osd_oracle_is_exact(double u, double v);

#endif
