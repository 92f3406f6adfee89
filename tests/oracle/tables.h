/* The tables of server/limit evaluated on the CPU as server/limit/tables.h describes them, in
 * double from the single precision points: what the shaders do, without their arithmetic. */
#ifndef SHEEN_TESTS_ORACLE_TABLES_H
#define SHEEN_TESTS_ORACLE_TABLES_H

#include "tests/oracle/vec.h"

extern "C" {
#include "server/limit/tables.h"
}

/* Derivatives are by the table's own cell coordinates: up to one positive factor for each of the
 * two directions, and turned with the node. */
struct surface_point {
    vec3 p, du, dv, duu, duv, dvv;

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

/* Signed against the normal; least <= most. */
struct curvatures {
    double least, most;
};
curvatures principal_curvatures(const surface_point &s);

/* Where on a Ptex face: (a, b) as seen from one of its corners, whose next corner is at (1, 0).
 * Near that corner doubles tell places apart that (u, v) would not. */
struct place {
    uint32_t face;
    unsigned corner;
    double a, b;
};

class table_evaluator
{
  public:
    /* Throws std::runtime_error when the cage is refused. */
    explicit table_evaluator(const cage &cage);
    ~table_evaluator();
    table_evaluator(const table_evaluator &) = delete;
    table_evaluator &operator=(const table_evaluator &) = delete;

    /* False where there is no surface, and at an extraordinary vertex itself. Throws when a node is
     * not where the descent led. */
    bool evaluate(uint32_t face, double u, double v, surface_point *out) const;
    bool evaluate(const place &place, surface_point *out) const;
    /* (u, v) in [0,1] over any node and what lies below it. */
    bool evaluate_node(uint32_t node, double u, double v, surface_point *out) const;

    limit_tables tables = {};
};

/* Ring level n (1 first) of a corner table at local (a, b), where 1 <= 2^n max(a,b) <= 2, in the
 * vertex's frame. */
surface_point evaluate_ring(const float (*texels)[3], int n, double a, double b);

#endif
