/* Compares sheen's refinement of every quad of a cage, by its rings, with libosd's uniform
 * refinement. */
#ifndef SHEEN_TESTS_ORACLE_REFINE_WALK_H
#define SHEEN_TESTS_ORACLE_REFINE_WALK_H

#include <cstddef>
#include <vector>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/surface/subdivision/build.h"
#include "server/surface/subdivision/plan.h"
}

/* For each level, from 0 (the cage, for faces surrounded by quads) to the last. */
struct refine_walk {
    std::vector<double> distance; /* largest distance of two points that should be equal */
    std::vector<size_t> n_faces;
};

/* Throws std::runtime_error when a side refuses the cage. */
refine_walk walk_levels(const cage &cage, int n_levels);

/* The diagonal of the box of the cage's vertices. */
double cage_diagonal(const cage &cage);

#endif
