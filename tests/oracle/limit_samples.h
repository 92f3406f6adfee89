/* Compares the tables of server/surface with libosd in double precision, at random places of a
 * cage. */
#ifndef SHEEN_TESTS_ORACLE_LIMIT_SAMPLES_H
#define SHEEN_TESTS_ORACLE_LIMIT_SAMPLES_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/tables.h"

struct limit_samples {
    std::vector<double> normal_rad; /* differences where libosd's surface has a normal, rad */
    std::vector<double> position;   /* file units */
    size_t presence = 0;            /* places where only one of the two has a surface */
};

/* Compares n places of random faces, also near corners and on edges, but none where libosd is not
 * exact. */
limit_samples compare_limit(const osd_oracle &oracle, const table_evaluator &tables, size_t n,
                            uint64_t seed);

#endif
