/* The tables of server/surface built from a cage and evaluated by server/surface/evaluate.h, in
 * double precision from the single-precision points: like the shaders, but without their
 * arithmetic. */
#ifndef SHEEN_TESTS_ORACLE_TABLES_H
#define SHEEN_TESTS_ORACLE_TABLES_H

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/vec.h"

extern "C" {
#include "server/surface/evaluate.h"
#include "server/surface/subdivision/build.h"
#include "server/surface/texels.h"
}

/* Derivatives are by the coordinates in which the place was given; for evaluate_ring() by those of
 * the ring. */
struct surface_point {
    vec3 p, du, dv;
    double luu, luv, lvv; /* second derivatives along the normal */

    vec3 normal() const /* unit */
    {
        return normalized(cross(du, dv));
    }
    /* False in cusps and folds, where du and dv do not span a plane. */
    bool has_normal() const
    {
        return length(cross(du, dv)) > 1e-6 * length(du) * length(dv);
    }
};

/* Signed by the normal; least <= most. */
struct curvatures {
    double least, most;
};
curvatures principal_curvatures(const surface_point &s);
/* Needs sample.has_normal(). */
curvatures principal_curvatures(const osd_sample &sample);

/* A place on a Ptex face: (a, b) seen from one of its corners, whose next corner is at (1, 0). Near
 * that corner doubles distinguish places that (u, v) would not. */
struct place {
    uint32_t face;
    unsigned corner;
    double a, b;
};

class table_evaluator
{
  public:
    /* Throws std::runtime_error if the cage is refused, or if a node is not the part of its parent
     * that the descent expects. */
    explicit table_evaluator(const cage &cage);
    ~table_evaluator();
    table_evaluator(const table_evaluator &) = delete;
    table_evaluator &operator=(const table_evaluator &) = delete;

    /* False if there is no surface, and at an extraordinary vertex itself. */
    bool evaluate(uint32_t face, double u, double v, surface_point *out) const;
    bool evaluate(const place &place, surface_point *out) const;
    /* (u, v) in [0,1] on any node and its descendants. */
    bool evaluate_node(uint32_t node, double u, double v, surface_point *out) const;

    limit_tables tables = {};

  private:
    bool evaluate(const limit_place &at, surface_point *out) const;
};

/* Evaluates level n (from 1) of a CORNER at local (a, b), where 1 <= 2^n max(a,b) <= 2. */
surface_point evaluate_ring(const limit_tables &tables, const limit_node &node, int n, double a,
                            double b);

#endif
