/* The tables of server/surface beside libosd in double, at random places of a cage. */
#ifndef SHEEN_TESTS_ORACLE_LIMIT_SAMPLES_H
#define SHEEN_TESTS_ORACLE_LIMIT_SAMPLES_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/oracle/osd_oracle.h"
#include "tests/oracle/tables.h"

struct limit_samples {
    std::vector<double> normal_rad; /* where libosd's surface has a normal */
    std::vector<double> position;   /* file units */
    size_t presence = 0;            /* places where one has a surface and the other has none */
};

/* n places of random faces, near corners and on edges, too; none where libosd is not exact. */
limit_samples compare_limit(const osd_oracle &oracle, const table_evaluator &tables, size_t n,
                            uint64_t seed);

#endif
