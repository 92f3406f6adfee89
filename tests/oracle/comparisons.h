/* Comparisons of two cages' surfaces by server/curves/compare/comparison.h, and cages to compare. A failure ends the
 * program with code 2 and a message. */
#ifndef SHEEN_TESTS_ORACLE_COMPARISONS_H
#define SHEEN_TESTS_ORACLE_COMPARISONS_H

#include <atomic>
#include <string>
#include <vector>

#include "tests/oracle/cage_file.h"

using std::atomic_bool; /* what <stdatomic.h> gives C */
extern "C" {
#include "server/curves/compare/comparison.h"
#include "server/surface/tables.h"
}

namespace comparisons
{

/* A cage's tables on demand, as the native device has them. */
class cage_surface
{
  public:
    explicit cage_surface(const loose_cage &parts);
    ~cage_surface();
    cage_surface(const cage_surface &) = delete;
    cage_surface &operator=(const cage_surface &) = delete;

    double size() const; /* the diagonal of the box */
    limit_tables tables = {};
};

/* The default limits of a file of unknown unit, and a tunnel of 40 stripes. The setup points to both surfaces. */
comparison_setup setup_of(const cage_surface &before, const cage_surface &after);
comparison_result compare(const comparison_setup &setup);
comparison_result compare(const loose_cage &before, const loose_cage &after);
/* The largest size of a measure in both directions; 0 where it is unknown. */
double worst(const comparison_result &result, comparison_measure measure);
/* Square units, in both directions together. */
double uncovered(const comparison_result &result);

loose_cage read_loose(const std::string &path);
/* Vertices and faces in another order; faces begin at another corner. */
loose_cage renumbered(const loose_cage &from, unsigned seed);
loose_cage rewound(const loose_cage &from);
/* Catmull and Clark's step (1978) of a closed cage without tags. */
loose_cage refined(const loose_cage &from);
/* A flat or curved sheet of n x n quads over [0,n] x [0,n]. */
template <class height> loose_cage sheet(int n, height z)
{
    loose_cage cage;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++)
            cage.position.push_back({(double)i, (double)j, z(i, j)});
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++) {
            uint32_t k = (uint32_t)(j * (n + 1) + i), row = (uint32_t)n + 1;
            cage.faces.push_back({k, k + 1, k + row + 1, k + row});
        }
    return cage;
}

/* A torus whose tube has the radius r: the control points are moved outwards so that the cubic curves through them
 * meet their circles at the knots, and elsewhere within a millionth. */
loose_cage torus(int n, double r);
/* A flat disc: n quads around vertex 0, then rings of 2 n quads. */
loose_cage disc(int n, int rings);
loose_cage turned(loose_cage cage, vec3 axis, double angle_deg, vec3 shift);

} // namespace comparisons

#endif
