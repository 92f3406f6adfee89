/* The limit surface as libosd computes it, in double: what sheen is compared with.
 *
 * Feature-adaptive refinement to isolation level 10 with infinitely sharp patches, no single-crease
 * patches (libosd's CPU evaluation ignores their crease), no legacy sharp corners, Gregory end
 * caps. Exact to rounding but inside the end caps, which reach no further than 2^-9 of a Ptex face
 * from its corners (2^-10 for quads): see osd_oracle_is_exact().
 *
 * Evaluation is read-only and may run in several threads. */
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
    /* Whether du and dv span a plane: they need not in cusps and folds, nor at sharp corners. */
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

/* A vertex of the cage (or the middle of an n-gon) that is not regular, and where it is. */
struct osd_irregular {
    uint32_t face;  /* Ptex face that has it at a corner */
    double u, v;    /* that corner, 0 or 1 each */
    size_t valence; /* faces about it */
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
    bool non_manifold() const; /* an edge or a vertex of the cage is */
    const std::vector<osd_irregular> &irregular() const;

    /* False when there is no surface (a hole) or the arguments are out of range. */
    bool evaluate(uint32_t face, double u, double v, osd_sample *sample) const;
    /* The same, position only, in a third of the time. */
    bool evaluate(uint32_t face, double u, double v, vec3 *position) const;

  private:
    struct implementation;
    std::unique_ptr<implementation> m;
};

/* Whether (u, v) is at least 1/512 from all four corners, in u or in v. */
bool osd_oracle_is_exact(double u, double v);

#endif
