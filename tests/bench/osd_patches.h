/* A cage as users of OpenSubdiv draw it: libosd's default choices, Gregory end caps, and the points
 * that its patches refer to. */
#ifndef SHEEN_TESTS_BENCH_OSD_PATCHES_H
#define SHEEN_TESTS_BENCH_OSD_PATCHES_H

#include <memory>
#include <vector>

#include <opensubdiv/far/patchTable.h>

#include "tests/oracle/osd_refiner.h"

struct osd_patches {
    std::unique_ptr<OpenSubdiv::Far::PatchTable> table;
    std::vector<control_point> points;

    /* `level` is the isolation level of features. Throws as make_refiner() does. */
    osd_patches(const cage &cage, int level);
};

#endif
