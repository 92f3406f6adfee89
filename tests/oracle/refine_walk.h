/* Our own refinement of every quad of a cage, by its rings, beside libosd's uniform refinement. */
#ifndef SHEEN_TESTS_ORACLE_REFINE_WALK_H
#define SHEEN_TESTS_ORACLE_REFINE_WALK_H

#include <cstddef>
#include <vector>

#include "tests/oracle/vec.h"

extern "C" {
#include "server/surface/subdivision/build.h"
#include "server/surface/subdivision/plan.h"
}

/* By level, from 0 (the cage, where all around a face is quads) to the last. */
struct refine_walk {
    std::vector<double> distance; /* the largest between two points that should be one */
    std::vector<size_t> n_faces;
};

/* Throws std::runtime_error when a side refuses the cage. */
refine_walk walk_levels(const cage &cage, int n_levels);

/* Of the bounding box of the cage's vertices. */
double cage_diagonal(const cage &cage);

#endif
